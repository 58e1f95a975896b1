"""Drag of a fixed sphere in a stream: the quick row of the validation."""

from rdpm.studies.validation.stream import QUICK_BAND, stream


def test_drag_at_re_100_on_the_coarse_grid() -> None:
    (row,) = stream(True, lambda text: None)
    assert row.quantity == "drag coefficient, Re 100, 8 cells/d"
    assert row.reference == 1.09
    assert row.band == QUICK_BAND
    assert row.ok, row.value
