"""A still of the bodies in their box in three dimensions, drawn off screen in a process of its own.

Rendering needs a graphics library that may be missing, or crash: nothing of that reaches the run.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.style import PALETTE
from rdpm.io.files import replacing
from rdpm.io.sphere_surface import sphere_surface
from rdpm.io.wall_surface import wall_surface
from rdpm.results.run import Run, load_run

__all__ = ["finish_rendering", "start_rendering"]

Floats = NDArray[np.float64]
_FEW = 7
_SECONDS = 60.0   # a software renderer takes three


def start_rendering(folder: str | Path, path: str | Path) -> subprocess.Popen[str]:
    """Begin to draw the bodies of a run's folder into a PNG file, in another process.

    Parameters
    ----------
    folder : path
        Of a run with bodies.
    path : path
        Ends in ``.png``; its folder exists.

    Returns
    -------
    subprocess.Popen
        For `finish_rendering`.
    """
    command = [sys.executable, "-m", "rdpm.figures.bodies_3d", str(folder), str(path)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def finish_rendering(process: subprocess.Popen[str], timeout: float = _SECONDS) -> str:
    """Wait for the picture.

    Parameters
    ----------
    process : subprocess.Popen
        From `start_rendering`.
    timeout : float, [s]
        It is given up after this time.

    Returns
    -------
    str
        Why there is none, in one line; empty when it was drawn.
    """
    try:
        _, said = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return f"the renderer did not answer within {timeout:g} s"
    if process.returncode == 0:
        return ""
    lines = [line for line in said.splitlines() if line.strip()]
    return lines[-1] if lines else f"the renderer ended with code {process.returncode}"


def _render(run: Run, path: Path) -> None:
    import pyvista
    from PIL import Image

    if run.tracks is None:
        raise ValueError("there are no bodies")
    position, count = run.tracks.position, run.tracks.count
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[1600, 1600])
    plotter.set_background("white")
    edges = pyvista.Box((0, run.box[0], 0, run.box[1], 0, run.box[2])).outline()
    plotter.add_mesh(edges, color="#777777", line_width=2)
    for wall in run.walls:
        points, triangles = wall_surface(wall, run.box)
        if len(triangles):
            surface = pyvista.PolyData.from_regular_faces(points, triangles.astype(int))
            plotter.add_mesh(surface, color="#999999", opacity=0.25)
    if count <= _FEW:
        moments = np.unique(np.linspace(0, len(position) - 1, 6).astype(int))
        for n in range(count):
            colour = PALETTE[n % len(PALETTE)]
            if len(position) > 1:
                plotter.add_mesh(pyvista.lines_from_points(position[:, n]), color=colour, line_width=4)
            for number, moment in enumerate(moments, start=1):
                ball = _balls(position[moment, n : n + 1], run.diameter[n : n + 1])
                opacity = 0.25 + 0.75 * (number / len(moments)) ** 2
                plotter.add_mesh(ball, color=colour, opacity=opacity, smooth_shading=True, specular=0.3)
    else:
        inside = position[-1] - run.period * np.floor(position[-1] / np.where(run.periodic, run.box, np.inf))
        balls = _balls(inside, run.diameter)
        plotter.add_mesh(balls, color=PALETTE[0], smooth_shading=True, specular=0.3)
    if run.gravity.any():
        down = run.gravity / np.linalg.norm(run.gravity)
        size = 0.12 * float(run.box.max())
        arrow = pyvista.Arrow(tuple(-0.6 * size * np.ones(3) - 0.5 * size * down), down, scale=size)
        plotter.add_mesh(arrow, color="#262626")
    plotter.camera_position = [(1.0, -1.9, 0.55), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    picture = plotter.screenshot(return_img=True)
    drawn = (picture < 255).any(axis=2)
    rows, columns = (np.flatnonzero(drawn.any(axis=n)) for n in (1, 0))
    cut = Image.fromarray(picture[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])
    with replacing(path) as temporary:
        cut.reduce(2).save(temporary)   # drawn at twice the size: smooth edges with any renderer


def _balls(centres: Floats, diameter: Floats) -> Any:
    """All spheres as one mesh."""
    import pyvista

    unit, triangles = sphere_surface(3 if len(centres) <= 200 else 1)
    points = (centres[:, None] + 0.5 * diameter[:, None, None] * unit).reshape(-1, 3)
    faces = (triangles[None] + len(unit) * np.arange(len(centres))[:, None, None]).reshape(-1, 3)
    return pyvista.PolyData.from_regular_faces(points, faces.astype(int))


if __name__ == "__main__":
    try:
        _render(load_run(sys.argv[1]), Path(sys.argv[2]))
    except Exception as error:   # whatever the renderer raises, one line tells it
        sys.exit(f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}")
