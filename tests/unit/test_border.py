"""The border to the kernels: every array of a wrong kind is refused with its name, and nothing is changed."""

import inspect
from typing import Any

import numpy as np
import pytest

from border_calls import BODIES, CALLS, FIRST, GRID, MARKERS, PERIODIC, core_grid, interfaces, slab
from rdpm import _core

#: Of any length: it sets that of the others.
FREE_LENGTH = {"first", "active", "gap"}

#: A driver compiled elsewhere, taken by its address (tests/contact_laws).
BY_ADDRESS = {"ContactKernel", "ContactKernel.at"}

OTHER_DTYPES = (np.float32, np.float64, np.int32, np.int64, np.uint32, np.complex128, np.bool_)
ARRAYS = [(entry, name) for entry, call in CALLS.items() for name in call().arrays]


def entries() -> set[str]:
    """Of `_core`: functions, classes for their constructors, and their methods."""
    found = set()
    for name, value in inspect.getmembers(_core):
        if not name.startswith("_") and callable(value):
            found.add(name)
        if inspect.isclass(value) and not name.startswith("_"):
            methods = inspect.getmembers(value, callable)
            found |= {f"{name}.{method}" for method, _ in methods if not method.startswith("_")}
    return found


def misaligned(array: np.ndarray) -> np.ndarray:
    data = np.zeros(array.nbytes + 1, np.uint8)[1:].view(array.dtype).reshape(array.shape)
    data[...] = array
    return data


def strided(array: np.ndarray) -> np.ndarray:
    wide = np.repeat(array, 2, axis=-1)[..., ::2]
    assert not wide.flags.c_contiguous
    return wide


def read_only(array: np.ndarray) -> np.ndarray:
    copy = array.copy()
    copy.setflags(write=False)
    return copy


def wrong_kinds(name: str, array: np.ndarray, is_written: bool) -> dict[str, Any]:
    """The same values in every way that a kernel cannot take."""
    kinds: dict[str, Any] = {np.dtype(d).name: array.astype(d) for d in OTHER_DTYPES if d != array.dtype}
    kinds |= {
        "strides": strided(array),
        "dimension more": array[None].copy(),
        "dimension less": array.ravel() if array.ndim > 1 else array[0],
        "list": array.tolist(),
        "object": object(),
        "text": "u",
    }
    if array.dtype != np.bool_:  # rows of structs come as bytes
        kinds["not aligned"] = misaligned(array)
    if array.itemsize > 1:
        kinds["bytes swapped"] = array.astype(array.dtype.newbyteorder())
    if len(array) > 1:
        kinds["reversed"] = array[::-1]
    if array.ndim > 1 and len(array) > 1:
        kinds["Fortran order"] = np.asfortranarray(array)
    if name not in FREE_LENGTH:
        kinds["shape"] = array[..., :-1].copy()
    if is_written:
        kinds["read-only"] = read_only(array)
    return kinds


def test_every_entry_has_a_row() -> None:
    assert entries() == set(CALLS) | BY_ADDRESS


@pytest.mark.parametrize("entry", CALLS)
def test_arguments_have_names_and_inputs_may_be_read_only(entry: str) -> None:
    call = CALLS[entry]()
    call(**{name: read_only(array) for name, array in call.arrays.items() if name not in call.written})


@pytest.mark.parametrize("entry", CALLS)
def test_a_kernel_changes_what_it_is_said_to(entry: str) -> None:
    call = CALLS[entry]()
    before = {name: array.copy() for name, array in call.arrays.items()}
    call()
    changed = {name for name, array in call.arrays.items() if not np.array_equal(array, before[name], equal_nan=True)}
    assert changed <= set(call.written)
    assert changed or not call.written


@pytest.mark.parametrize(("entry", "name"), ARRAYS)
def test_an_array_of_a_wrong_kind_is_refused_by_name(entry: str, name: str) -> None:
    call = CALLS[entry]()
    before = {key: array.copy() for key, array in call.arrays.items()}
    for kind, wrong in wrong_kinds(name, call.arrays[name], name in call.written).items():
        given = wrong.tobytes() if isinstance(wrong, np.ndarray) else None
        with pytest.raises((TypeError, ValueError)) as refusal:
            call(**{name: wrong})
        assert str(refusal.value).startswith(f"{name}: "), f"{kind}: {refusal.value}"
        for key, array in call.arrays.items():
            assert array.tobytes() == before[key].tobytes(), (kind, key)
        if isinstance(wrong, np.ndarray):
            assert wrong.tobytes() == given, kind
    with pytest.raises(TypeError, match=name):
        call(**{name: None})


def test_the_refusal_says_what_is_asked_and_what_came() -> None:
    call = CALLS["fill_halo"]()
    field = call.arguments["field"]
    asked = r"field: must be a C-contiguous, writable float64 array of shape \(9, 8, 7\), got "
    with pytest.raises(TypeError, match=asked + "dtype float32"):
        call(field=field.astype(np.float32))
    with pytest.raises(ValueError, match=asked + r"shape \(9, 8\)"):
        call(field=field[..., 0].copy())
    with pytest.raises(ValueError, match=asked + "a read-only array"):
        call(field=read_only(field))
    with pytest.raises(TypeError, match=asked + "list"):
        call(field=field.tolist())


@pytest.mark.parametrize(
    ("entry", "name", "wrong"),
    [
        ("fill_halo", "location", -1),
        ("fill_halo", "location", 4),
        ("diffuse_stabilised", "component", -1),
        ("diffuse_stabilised", "component", 3),
        ("diffuse_stabilised", "stages", 1),
        ("diffuse_stabilised", "stages", 1 << 30),
        ("triad_seconds", "elements", 0),
        ("triad_seconds", "threads", 0),
        ("triad_seconds", "sweeps", 0),
        *((entry, "threads", 0) for entry, call in CALLS.items() if {"first", "threads"} <= set(call().arguments)),
    ],
)  # fmt: skip
def test_a_number_out_of_its_range_is_refused_by_name(entry: str, name: str, wrong: int) -> None:
    with pytest.raises(ValueError, match=f"^{name}: "):
        CALLS[entry]()(**{name: wrong})


@pytest.mark.parametrize("first", [[], [1, 3, 5], [0, 6, 5], [0, -1, 5], [0, 3, 800_000_000]])
def test_owners_that_would_be_read_out_of_bounds_are_refused(first: list[int]) -> None:
    for entry in ("Markers", "sum_over_markers", "exclude_markers"):
        with pytest.raises(ValueError, match=r"^first: "):
            CALLS[entry]()(first=np.array(first, np.int32))


@pytest.mark.parametrize("pair", [(-1, 0), (BODIES, 0), (0, BODIES), (0, -7)])
def test_pairs_of_unknown_bodies_are_refused(pair: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match=r"^pairs: "):
        CALLS["exclude_markers"]()(pairs=np.array([pair], np.int32))


@pytest.mark.parametrize("pair", [(-1, 0), (BODIES, 0), (0, BODIES), (0, -7)])
def test_contacts_of_unknown_bodies_are_refused(pair: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match=r"^pairs: id"):
        CALLS["run_substeps"]()(pairs=np.array([pair, pair], np.int32))
    with pytest.raises(ValueError, match=r"^active: id"):
        CALLS["run_substeps"]()(active=np.array([0, BODIES], np.int32))


@pytest.mark.parametrize("place", [np.nan, np.inf, -1e300, 1e5])
def test_bodies_far_from_the_box_are_refused(place: float) -> None:
    periodic = core_grid(boundary=(PERIODIC,) * 3)
    markers = _core.Markers(periodic, np.array(FIRST, np.int32))
    with pytest.raises(ValueError, match=r"^position: "):
        markers.place(periodic, np.full((MARKERS, 3), place))
    with pytest.raises(ValueError, match=r"^position, radius: "):
        CALLS["Markers.inner_sums"]()(position=np.full((BODIES, 3), place))


def test_stencils_that_were_not_placed_are_refused() -> None:
    markers = _core.Markers(core_grid(), np.array(FIRST, np.int32))
    with pytest.raises(ValueError, match="call place first"):
        markers.interpolate(**CALLS["Markers.interpolate"]().arguments)


@pytest.mark.parametrize("entry", ["Projection.project", "Projection.solve", "Markers.place", "Markers.spread"])
def test_another_grid_than_that_of_the_object_is_refused(entry: str) -> None:
    for other in (core_grid(cells=(5, 6, 8)), core_grid(boundary=(PERIODIC,) * 3)):
        with pytest.raises(ValueError, match=r"^grid: "):
            CALLS[entry]()(grid=other)


def test_markers_refuse_a_field_beyond_their_offsets() -> None:
    """Offsets are 32-bit: 1290^3 values with the halo are the largest cube."""
    first = np.array([0, 1], np.int32)
    assert _core.Markers(core_grid(cells=(1288,) * 3), first).count == 1
    with pytest.raises(ValueError, match=r"cells 1289 x 1289 x 1289 .* 32-bit offsets, at most 2147483647"):
        _core.Markers(core_grid(cells=(1289,) * 3), first)


@pytest.mark.parametrize(
    "wrong",
    [
        {"planes_below": 1}, {"joined": (True, False)}, {"box_planes": 7, "joined": (False, False)},
        {"box_planes": 6, "joined": (True, True)}, {"planes_below": 15, "box_planes": 21, "joined": (True, True)},
    ],
)  # fmt: skip
def test_a_slab_that_is_none_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"^grid: a slab"):
        _core.Grid(**(GRID | wrong))


@pytest.mark.parametrize("wrong", [{"planes": [21]}, {"planes": [21, 0]}, {"first": -1}, {"count": 31}])
def test_interfaces_of_no_slabs_or_modes_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"^(planes|first, count): "):
        _core.Interfaces(**(interfaces() | wrong))


def test_a_whole_box_and_a_slab_are_projected_each_its_way() -> None:
    whole, part = CALLS["Projection.project"](), slab()["grid"]
    with pytest.raises(ValueError, match=r"^grid: must not be a slab"):
        _core.Projection(part).project(**whole.arguments | {"grid": part})
    call = CALLS["Projection.inwards"]()
    with pytest.raises(ValueError, match=r"^grid: must be a slab"):
        _core.Projection(core_grid()).inwards(**call.arguments | {"grid": core_grid()})


@pytest.mark.parametrize("cells", [(1 << 30, 4, 4), (1 << 29,) * 3])
def test_a_grid_whose_size_is_no_number_is_refused(cells: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match=r"^grid: "):
        core_grid(cells=cells)
