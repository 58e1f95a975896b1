"""The fractions of an impulse that the body equation takes for known are those the grid shows."""

import pytest
from interior_fraction import OFFSETS, fractions

from rdpm.particles.calibration import CALIBRATION

#: Largest difference of the fits from what is measured between 6 and 24 cells a diameter, with another place in a cell.
BAND = 0.006

FITS = (
    CALIBRATION.interior_fraction_predicted,
    CALIBRATION.interior_fraction,
    CALIBRATION.interior_fraction_rotation,
)


@pytest.mark.parametrize("across", [6, 8, 12, 16, 24])
@pytest.mark.parametrize("offset", OFFSETS)
def test_impulse_on_the_markers_is_found_inside(across: int, offset: tuple[float, float, float]) -> None:
    for n, (found, (a, b)) in enumerate(zip(fractions(across, offset), FITS, strict=True)):
        # On 6 cells rotation depends on the place in a cell by 0.015.
        assert found == pytest.approx(a + b / across, abs=BAND if (across, n) != (6, 2) else 0.02)
