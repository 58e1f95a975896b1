"""A valid call of each entry of the kernels, for the tests of the border."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rdpm import _core

CELLS = (5, 6, 7)
SHAPE = (CELLS[2] + 2, CELLS[1] + 2, CELLS[0] + 2)
BODIES, MARKERS, THREADS, STAGES = 2, 5, 2, 4
FIRST = [0, 3, MARKERS]
PERIODIC, WALL = 0, 1


def core_grid(cells=CELLS, boundary=(WALL, PERIODIC, PERIODIC), threads: int = THREADS) -> _core.Grid:
    return _core.Grid(list(cells), [1.0, 1.0, 1.0], list(boundary), [0.0] * 18, threads, 0, 0, [False, False])


def slab() -> dict[str, _core.Grid]:
    """The middle one of three slabs."""
    boundary, speed = [WALL, PERIODIC, PERIODIC], [0.0] * 18
    return {"grid": _core.Grid(list(CELLS), [1.0] * 3, boundary, speed, THREADS, CELLS[2], 3 * CELLS[2], [True, True])}


def interfaces() -> dict[str, Any]:
    return slab() | {"planes": [CELLS[2]] * 3, "first": 0, "count": CELLS[0] * CELLS[1]}


def modes(*names: str) -> dict[str, np.ndarray]:
    return {name: values(CELLS[1], CELLS[0]) for name in names}


def values(*shape: int, dtype: type = np.float64) -> np.ndarray:
    return (np.arange(np.prod(shape)) % 3 + 1).reshape(shape).astype(dtype)


def fields(*names: str) -> dict[str, Any]:
    return {"grid": core_grid()} | {name: values(*SHAPE) for name in names}


def bodies_and_markers(**arrays: int) -> dict[str, Any]:
    """`first`, and the arrays with so many columns of each marker."""
    columns = {name: values(MARKERS, n) if n > 1 else values(MARKERS) for name, n in arrays.items()}
    return {"first": np.array(FIRST, np.int32), "threads": THREADS} | columns


def placed() -> _core.Markers:
    markers = _core.Markers(core_grid(), np.array(FIRST, np.int32))
    markers.place(core_grid(), values(MARKERS, 3))
    return markers


def scratch(planes: int) -> np.ndarray:
    return values(planes * SHAPE[1] * SHAPE[2] * THREADS)


@dataclass
class Call:
    """A valid call of one entry, its arguments by name."""

    function: Callable[..., Any]
    arguments: dict[str, Any]
    written: tuple[str, ...] = ()

    def __call__(self, **changed: Any) -> Any:
        return self.function(**self.arguments | changed)

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        return {name: value for name, value in self.arguments.items() if isinstance(value, np.ndarray)}


BOX = np.array([[9.0, 9.0, 9.0], [0.0, 9.0, 0.0], *[[0.0, 0.0, 0.0]] * 6])
ROOM = 8 * BODIES + 65  # of the cell list


def spheres() -> dict[str, np.ndarray]:
    """Two that overlap."""
    return {"box": BOX.copy(), "position": np.array([[4.0, 4.0, 4.0], [4.9, 4.0, 4.0]]), "radius": np.full(BODIES, 0.5)}


def cells() -> dict[str, np.ndarray]:
    return {"cell_start": np.ones(ROOM, np.int32), "cell_order": np.ones(BODIES, np.int32)}


def bytes_of(layout: dict[str, Any], rows: int, value: int = 0) -> np.ndarray:
    return np.full((rows, layout["size"]), value, np.uint8)


def substeps() -> Call:
    """One sub-step of two spheres that overlap and approach."""
    kernel, layouts = _core.soft_sphere_kernel(), _core.contact_layouts()
    of_bodies = ("velocity", "angular_velocity", "rotation", "force", "torque")
    impulses = ("impulse", "angular_impulse", "contact_impulse", "lubrication_angular_impulse")
    parameters = np.ones((2, kernel.parameters["size"] // 8)).view(np.uint8)
    arguments = {
        "kernel": kernel, **spheres(), **{name: values(BODIES, 3) for name in of_bodies + impulses},
        "inverse_mass": np.ones(BODIES), "inverse_moment": np.ones(BODIES),
        "active": np.array([0, 1], np.int32), "pairs": np.array([[0, -1], [0, 1]], np.int32),
        "rows": np.array([0, 1], np.int32), "bands": np.array([[0, 2]], np.int32), "even_bands": 1,
        "kinds": np.array([0, 1], np.int32), "parameters": parameters,
        "lubrication": bytes_of(layouts["lubrication"], 2), "state": bytes_of(layouts["state"], 2),
        "history": bytes_of(kernel.history, 2), "finished": bytes_of(layouts["finished"], 4),
        "body_room": values(32 * BODIES + 7), "pair_room": np.ones(4, np.int32), "closing": 1.0, "threads": THREADS,
        "time": 0.0, "h": 1e-3, "overlap_limit": 0.5, "first": 0, "last": 1,
    }  # fmt: skip
    written = ("position", "velocity", "angular_velocity", "rotation", *impulses, "state", "history", "finished",
               "body_room", "pair_room")  # fmt: skip
    return Call(_core.run_substeps, arguments, written)


def events() -> Call:
    """One interval of two spheres."""
    layouts, hard = _core.contact_layouts(), _core.hard_sphere_layouts()
    given = substeps().arguments
    kept = ("box", "position", "radius", "velocity", "angular_velocity", "rotation", "impulse", "angular_impulse",
            "contact_impulse", "lubrication_angular_impulse", "inverse_mass", "inverse_moment", "active", "pairs",
            "lubrication", "state")  # fmt: skip
    arguments = {name: given[name] for name in kept} | {
        "acceleration": values(BODIES, 3), "angular_acceleration": values(BODIES, 3),
        "parameters": np.zeros((2, 3)).view(np.uint8), "history": bytes_of(hard["history"], 2),
        "finished": bytes_of(layouts["finished"], 8), "events": np.zeros(2, np.int64), "start": 0.0, "length": 1e-3,
        "rest_speed": 0.0, "quiet": 1e-9, "most_events": 5, "is_new": True,
    }  # fmt: skip
    written = ("position", "velocity", "angular_velocity", "rotation", "impulse", "angular_impulse", "contact_impulse",
               "lubrication_angular_impulse", "state", "history", "finished", "events")  # fmt: skip
    return Call(_core.run_events, arguments, written)


FLOW, TENDENCY, RATE = ("u", "v", "w"), ("tendency_u", "tendency_v", "tendency_w"), ("rate_u", "rate_v", "rate_w")
GRID = {"cells": CELLS, "spacing": (1.0,) * 3, "boundary": (0,) * 3, "wall_velocity": (0.0,) * 18, "threads": 1,
        "planes_below": 0, "box_planes": 0, "joined": (False, False)}  # fmt: skip

#: A row an entry; a method is named after its class.
CALLS: dict[str, Callable[[], Call]] = {
    "build_info": lambda: Call(_core.build_info, {}),
    "triad_seconds": lambda: Call(_core.triad_seconds, {"elements": 8, "threads": 1, "sweeps": 1}),
    "Grid": lambda: Call(_core.Grid, dict(GRID)),
    "Projection": lambda: Call(_core.Projection, fields()),
    "Projection.project": lambda: Call(
        _core.Projection(core_grid()).project,
        fields(*FLOW, "p", "increment") | {"dt": 1.0, "rotational": 0.0},
        (*FLOW, "p", "increment"),
    ),
    "Projection.inwards": lambda: Call(
        _core.Projection(slab()["grid"]).inwards,
        fields(*FLOW, "increment") | slab() | {"dt": 1.0} | modes("below", "above"),
        (*FLOW, "increment", "below", "above"),
    ),
    "Projection.outwards": lambda: Call(
        _core.Projection(slab()["grid"]).outwards,
        fields(*FLOW, "p", "increment") | slab() | {"dt": 1.0, "rotational": 0.0} | modes("below", "above"),
        (*FLOW, "p", "increment", "below", "above"),
    ),
    "Projection.finish": lambda: Call(
        _core.Projection(slab()["grid"]).finish,
        fields(*FLOW, "p", "increment") | slab() | {"dt": 1.0},
        (*FLOW, "p", "increment"),
    ),
    "Projection.measures": lambda: Call(_core.Projection(slab()["grid"]).measures, fields(*FLOW) | slab()),
    "Interfaces": lambda: Call(_core.Interfaces, interfaces()),
    "Interfaces.solve": lambda: Call(
        _core.Interfaces(**interfaces()).solve,
        {"ends": values(3, 2, CELLS[0] * CELLS[1]), "threads": THREADS},
        ("ends",),
    ),
    "Projection.solve": lambda: Call(_core.Projection(core_grid()).solve, fields("phi"), ("phi",)),
    "momentum_explicit": lambda: Call(
        _core.momentum_explicit,
        fields(*FLOW, *TENDENCY, "p")
        | {"dt": 1.0, "now": 1.0, "then": 0.0, "nu": 0.1, "force": (0.0,) * 3, "scratch": scratch(9)},
        (*FLOW, *TENDENCY, "scratch"),
    ),
    "momentum_rate": lambda: Call(
        _core.momentum_rate,
        fields(*FLOW, *TENDENCY, *RATE, "p")
        | {"now": 1.0, "then": 0.0, "nu": 0.1, "force": (0.0,) * 3, "scratch": scratch(9)},
        (*TENDENCY, *RATE, "scratch"),
    ),
    "diffuse_stabilised": lambda: Call(
        _core.diffuse_stabilised,
        fields("velocity", "rate")
        | slab()
        | {"component": 0, "dt": 1.0, "nu": 0.1, "stages": STAGES, "scratch": scratch(3 * (STAGES - 2))}
        | {side: values(STAGES - 1, *SHAPE[1:]) for side in ("below", "above")},
        ("velocity", "rate", "scratch", "below", "above"),
    ),
    "fill_halo": lambda: Call(_core.fill_halo, fields("field") | {"location": 3}, ("field",)),
    "largest_divergence": lambda: Call(_core.largest_divergence, fields(*FLOW)),
    "cell_values": lambda: Call(
        _core.cell_values,
        fields(*FLOW, "p")
        | {
            "density": 1.0,
            "velocity": values(*CELLS[::-1], 3, dtype=np.float32),
            "pressure": values(*CELLS[::-1], dtype=np.float32),
        },
        ("velocity", "pressure"),
    ),
    "Markers": lambda: Call(_core.Markers, fields() | {"first": np.array(FIRST, np.int32)}),
    "Markers.place": lambda: Call(placed().place, fields() | {"position": values(MARKERS, 3)}),
    "Markers.interpolate": lambda: Call(
        placed().interpolate, fields(*FLOW) | {"velocity": values(MARKERS, 3)}, ("velocity",)
    ),
    "Markers.spread": lambda: Call(
        placed().spread,
        fields(*FLOW) | {"value": values(MARKERS, 3), "volume": values(MARKERS), "factor": 1.0},
        FLOW,
    ),
    "Markers.inner_sums": lambda: Call(
        placed().inner_sums,
        fields(*FLOW) | {"position": values(BODIES, 3), "radius": values(BODIES), "sums": values(BODIES, 12)},
        ("sums",),
    ),
    "sum_over_markers": lambda: Call(
        _core.sum_over_markers,
        bodies_and_markers(arm=3, volume=1, value=3) | {"sums": values(BODIES, 6)},
        ("sums",),
    ),
    "move_markers": lambda: Call(
        _core.move_markers,
        bodies_and_markers(body_arm=3, body_force=3, arm=3, position=3, force=3)
        | {"orientation": values(BODIES, 4), "centre": values(BODIES, 3)},
        ("arm", "position", "force"),
    ),
    "store_forces": lambda: Call(
        _core.store_forces,
        bodies_and_markers(force=3, body_force=3) | {"orientation": values(BODIES, 4), "share": 0.5},
        ("force", "body_force"),
    ),
    "rigid_change": lambda: Call(
        _core.rigid_change,
        bodies_and_markers(arm=3, volume=1, change=3, force=3)
        | {"velocity": values(BODIES, 3), "angular_velocity": values(BODIES, 3)}
        | {"inverse_dt": 1.0, "sums": values(BODIES, 7)},
        ("change", "force", "sums"),
    ),
    "marker_moments": lambda: Call(
        _core.marker_moments,
        bodies_and_markers(arm=3, volume=1) | {"moments": values(BODIES, 10)},
        ("moments",),
    ),
    "find_pairs": lambda: Call(
        _core.find_pairs,
        spheres() | cells() | {"velocity": values(BODIES, 3), "force": values(BODIES, 3)}
        | {"inverse_mass": np.ones(BODIES), "dt": 1e-3, "margin": 0.1, "pairs": np.ones((4, 2), np.int32)},
        ("cell_start", "cell_order", "pairs"),
    ),
    "list_demand": lambda: Call(
        _core.list_demand,
        {name: array for name, array in spheres().items() if name != "radius"}
        | {name: values(BODIES, 3) for name in ("velocity", "force", "old")}
        | {"inverse_mass": np.ones(BODIES), "dt": 1e-3},
    ),
    "list_pairs": lambda: Call(
        _core.list_pairs,
        spheres() | {"cell_start": np.ones(ROOM, np.int32), "inverse_mass": np.ones(BODIES), "range": 0.1}
        | {name: np.ones(BODIES, np.int32) for name in ("order", "rank")}
        | {"pairs": np.ones((4, 2), np.int32), "layer": np.ones(4, np.int32)},
        ("cell_start", "order", "rank", "pairs", "layer"),
    ),
    "select_pairs": lambda: Call(
        _core.select_pairs,
        spheres() | {"range": 0.1, "order": np.array([0, 1], np.int32), "pairs": np.array([[0, -1], [0, 1]], np.int32)}
        | {"layer": np.zeros(2, np.int32), "times": np.ones(2), "rows": np.ones(2, np.int32)}
        | {"state": bytes_of(_core.contact_layouts()["state"], 2)}
        | {name: np.ones((2, 2), np.int32) for name in ("local", "bands")}
        | {name: np.ones(BODIES, np.int32) for name in ("active", "place")},
        ("rows", "local", "bands", "active", "place"),
    ),
    "contacts_under_way": lambda: Call(
        _core.contacts_under_way,
        {"box": BOX.copy(), "pairs": np.array([[0, -1], [0, 1]], np.int32), "impact_speed": np.zeros(BODIES)}
        | {"state": np.ones((2, _core.contact_layouts()["state"]["size"] // 8)).view(np.uint8)},
        ("impact_speed",),
    ),
    "nearest_surfaces": lambda: Call(
        _core.nearest_surfaces,
        spheres() | cells() | {"gap": values(BODIES), "neighbour": values(BODIES, dtype=np.int64)},
        ("cell_start", "cell_order", "gap", "neighbour"),
    ),
    "contact_layouts": lambda: Call(_core.contact_layouts, {}),
    "soft_sphere_kernel": lambda: Call(_core.soft_sphere_kernel, {}),
    "adaptive_kernel": lambda: Call(_core.adaptive_kernel, {}),
    "hertz_kernel": lambda: Call(_core.hertz_kernel, {}),
    "repulsive_kernel": lambda: Call(_core.repulsive_kernel, {}),
    "extended_kernel": lambda: Call(_core.extended_kernel, {"is_hertz": True, "is_cohesive": False}),
    "run_substeps": substeps,
    "hard_sphere_layouts": lambda: Call(_core.hard_sphere_layouts, {}),
    "run_events": events,
    "separate": lambda: Call(
        _core.separate,
        spheres() | {"inverse_mass": np.ones(BODIES), "pairs": np.array([[0, -1], [0, 1]], np.int32)},
        ("position",),
    ),
    "end_step": lambda: Call(
        _core.end_step,
        {name: array for name, array in spheres().items() if name != "radius"}
        | {name: values(BODIES, 3) for name in ("velocity", "angular_velocity", "rotation", "force", "torque")}
        | {"orientation": values(BODIES, 4), "crossings": values(BODIES, 3, dtype=np.int64)}
        | {"inverse_mass": np.ones(BODIES), "inverse_moment": np.ones(BODIES)}
        | {"is_active": np.zeros(BODIES, np.bool_), "dt": 1e-3, "threads": THREADS},
        ("position", "velocity", "angular_velocity", "rotation", "orientation", "crossings"),
    ),
    "lubrication_resistance": lambda: Call(
        _core.lubrication_resistance,
        {"gap": values(3), "resistance": values(3, 3)}
        | {"lubrication": bytes_of(_core.contact_layouts()["lubrication"], 1)},
        ("resistance",),
    ),
    "exclude_markers": lambda: Call(
        _core.exclude_markers,
        bodies_and_markers(position=3, full_volume=1, volume=1)
        | {"size": CELLS, "is_periodic": (True,) * 3, "is_solid": (False,) * 3, "exclusion": (0.5, 2.0, 0.2, 1.0)}
        | {"pairs": np.array([[0, 1], [1, -1]], np.int32), "centre": values(BODIES, 3), "radius": values(BODIES)},
        ("volume",),
    ),
}
