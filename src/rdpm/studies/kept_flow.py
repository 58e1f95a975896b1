"""The flow of a run in one plane, kept instead of its whole fields: some megabytes of some hundreds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rdpm.figures.flow import Slices, load_slices
from rdpm.figures.plane import Plane, viewing_plane
from rdpm.io.files import replacing
from rdpm.results.run import load_run
from rdpm.results.run_folder import RunFolder

__all__ = ["keep_plane", "load_flow"]

_NAME = "plane.npz"


def keep_plane(files: RunFolder) -> None:
    """Write ``plane.npz`` of a run that has fields: velocities in the plane the bodies move in, in half precision.

    Parameters
    ----------
    files : RunFolder
    """
    run = load_run(files.path)
    if run.fields is None:
        return
    plane = viewing_plane(run.tracks, run.box, run.gravity, run.period, run.walls)
    slices = load_slices(run.fields, plane)
    with replacing(files.path / _NAME) as temporary, open(temporary, "wb") as file:
        np.savez_compressed(
            file, plane=np.array([plane.across, plane.up, plane.normal, plane.position]), times=slices.times,
            across=slices.across.astype(np.float16), up=slices.up.astype(np.float16),
            speed=slices.speed.astype(np.float16),
        )  # fmt: skip


def load_flow(folder: Path, start: Path | None) -> tuple[Plane, Slices] | None:
    """The flow in a plane from time zero on.

    Parameters
    ----------
    folder : path
        Of the run.
    start : path, optional
        Of its common start, which counts where it kept the same plane.

    Returns
    -------
    (Plane, Slices) or None
        None where the run kept nothing.
    """
    own = _read(folder)
    before = _read(start) if start is not None else None
    if own is None or before is None or (before[0].across, before[0].normal) != (own[0].across, own[0].normal):
        return own
    plane, late = own
    early = before[1]
    first = early.times < late.times[0]
    return plane, Slices(
        np.concatenate([early.times[first], late.times]),
        np.concatenate([early.across[first], late.across]),
        np.concatenate([early.up[first], late.up]),
        np.concatenate([early.speed[first], late.speed]),
    )


def _read(folder: Path) -> tuple[Plane, Slices] | None:
    path = folder / _NAME
    if not path.is_file():
        return None
    with np.load(path) as kept:
        across, up, normal, position = kept["plane"]
        fields = (kept[name].astype(np.float32) for name in ("across", "up", "speed"))
        return Plane(int(across), int(up), int(normal), float(position)), Slices(kept["times"], *fields)
