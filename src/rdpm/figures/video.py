"""A video of the run: the flow in a vertical plane and the turning spheres, drawn pixel by pixel."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rdpm.figures.flow import Slices, body_positions, periodic_copies
from rdpm.figures.plane import WALL_COLOUR, Plane
from rdpm.figures.style import FLOW_MAP, PALETTE, length_unit
from rdpm.io.files import replacing
from rdpm.results.tracks import Tracks

__all__ = ["Scene", "make_video", "orientations", "side_by_side"]

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]
_HIGHEST, _WIDEST, _NARROWEST = 880, 880, 400   # pixels of the picture of the box
_MANY = 300   # bodies above which only those that the plane cuts are drawn
_BAR = 46    # pixels below the box for the colour scale
_LINE = 19   # pixels a line of text
_FEW = 7     # bodies drawn each in its colour and never pale
_ENCODING = ["-crf", "22", "-preset", "veryfast", "-movflags", "+faststart"]
_LIGHT = np.array([-0.45, 0.6, 0.66])   # from the upper left, towards the viewer


@dataclass(frozen=True)
class Scene:
    """What the video shows.

    Attributes
    ----------
    title : str
    box : ndarray, (3,), [m]
    period : ndarray, (3,), [m]
        Length of the box along periodic directions, 0 along others.
    plane : Plane
    diameter : ndarray, (N,), [m]
    tracks : Tracks or None
        Bodies; None without.
    slices : Slices or None
        The flow; None without.
    top_speed : float, optional, [m/s]
        Upper end of the colour scale; that of the slices when left out.
    """

    title: str
    box: Floats
    period: Floats
    plane: Plane
    diameter: Floats
    tracks: Tracks | None
    slices: Slices | None
    top_speed: float | None = None

    @property
    def span(self) -> tuple[float, float]:
        """First and last time that bodies or flow are known at, [s]."""
        known = [part.times for part in (self.tracks, self.slices) if part is not None]
        return min(float(t[0]) for t in known), max(float(t[-1]) for t in known)


def make_video(path: str | Path, scene: Scene, frames: int = 100, rate: int = 20) -> Path:
    """Write the video of a scene as MP4 (H.264, yuv420p).

    Parameters
    ----------
    path : path
        Ends in ``.mp4``.
    scene : Scene
        With bodies or flow at two times at least.
    frames : int
        > 1; evenly spread over the scene's span.
    rate : int, [1/s]
        Frames a second.

    Returns
    -------
    pathlib.Path

    Raises
    ------
    OutputError
        The file cannot be written, or there is no working encoder.
    ValueError
        There is nothing that changes in time.
    """
    start, end = scene.span
    if not end > start:
        raise ValueError("a video needs two times at least")
    return _write(Path(path), _pictures(scene, np.linspace(start, end, frames)), rate)


def side_by_side(path: str | Path, scenes: Sequence[Scene], frames: int = 100, rate: int = 20) -> Path:
    """Write the video of several scenes beside each other in step, as `make_video` does.

    Parameters
    ----------
    path : path
        Ends in ``.mp4``.
    scenes : sequence of Scene
        Of boxes of one size, with titles of as many lines.
    frames : int
        > 1; from the earliest time of all to the latest.
    rate : int, [1/s]

    Returns
    -------
    pathlib.Path
    """
    spans = [scene.span for scene in scenes]
    times = np.linspace(min(a for a, _ in spans), max(b for _, b in spans), frames)
    together = zip(*(_pictures(scene, times) for scene in scenes), strict=True)
    return _write(Path(path), (np.concatenate(pictures, axis=1) for pictures in together), rate)


def _write(path: Path, pictures: Iterator[Pixels], rate: int) -> Path:
    import imageio_ffmpeg

    first = next(pictures)
    with replacing(path) as temporary:
        writer = imageio_ffmpeg.write_frames(
            str(temporary), (first.shape[1], first.shape[0]), fps=rate, codec="libx264",
            quality=None, macro_block_size=2, output_params=_ENCODING,
        )
        writer.send(None)
        try:
            writer.send(first)
            for picture in pictures:
                writer.send(picture)
        finally:
            writer.close()
    return path


def _pictures(scene: Scene, times: Floats) -> Iterator[Pixels]:
    canvas = _Canvas(scene)
    turned = orientations(scene.tracks, times)
    for n, time in enumerate(times):
        picture = canvas.background(time)
        if scene.tracks is not None:
            canvas.draw_spheres(picture, body_positions(scene.tracks, time), turned[n])
        yield canvas.framed(picture, time)


def orientations(tracks: Tracks | None, times: Floats) -> Floats:
    """Matrices that turn body axes into box axes at given times: (F, N, 3, 3).

    The angular velocities of the table are integrated from an upright start, by the trapezoidal rule.
    """
    if tracks is None:
        return np.empty((len(times), 0, 3, 3))
    omega = np.nan_to_num(tracks.angular_velocity)
    step = np.diff(tracks.times)[:, None, None]
    turn = np.cumsum(0.5 * (omega[1:] + omega[:-1]) * step, axis=0)
    angle = np.concatenate([np.zeros_like(omega[:1]), turn])
    flat = angle.reshape(len(angle), -1)
    at = np.stack([np.interp(times, tracks.times, column) for column in flat.T], axis=1)
    turns = np.diff(at.reshape(len(times), tracks.count, 3), axis=0)
    turned = np.empty((len(times), tracks.count, 3, 3))
    turned[0] = np.eye(3)
    for n, vector in enumerate(turns):
        turned[n + 1] = _rotation(vector) @ turned[n]
    return turned


def _rotation(vector: Floats) -> Floats:
    """Rodrigues' formula for N rotation vectors: (N, 3, 3)."""
    angle = np.linalg.norm(vector, axis=1)[:, None, None]
    x, y, z = (vector / np.maximum(angle[:, 0], 1e-300)).T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross))


class _Canvas:
    """Everything about a picture that stays the same from frame to frame."""

    def __init__(self, scene: Scene) -> None:
        from matplotlib import colormaps, font_manager
        from PIL import ImageFont

        plane = scene.plane
        width, height = scene.box[plane.across], scene.box[plane.up]
        self.scene = scene
        self.scale = min(_HIGHEST / height, _WIDEST / width)   # pixels a metre
        self.size = (2 * round(0.5 * self.scale * width), 2 * round(0.5 * self.scale * height))
        self.colours = (255 * colormaps[FLOW_MAP](np.linspace(0.0, 1.0, 256))[:, :3]).astype(np.uint8)
        self.top = scene.slices.top_speed if scene.slices is not None else 0.0
        if scene.top_speed is not None:
            self.top = scene.top_speed
        if scene.slices is not None:
            rows, columns = scene.slices.speed.shape[1:]
            self.spread = _spread(rows, self.size[1]), _spread(columns, self.size[0])
        columns, rows = ((np.arange(n) + 0.5) / self.scale for n in self.size)
        self.beyond = plane.beyond_walls(columns, rows)[::-1] > 0.0
        face = font_manager.findfont("DejaVu Sans")
        self.fonts = ImageFont.truetype(face, 14), ImageFont.truetype(face, 12)
        self.body_colours = self._body_colours()
        self.frame = self._frame()

    def _body_colours(self) -> Floats:
        count = len(self.scene.diameter)
        names = [PALETTE[n % len(PALETTE) if count <= _FEW else 0] for n in range(count)]
        colours = [[int(name[i : i + 2], 16) for i in (1, 3, 5)] for name in names]
        return np.array(colours, float).reshape(-1, 3)

    def _frame(self) -> Pixels:
        """Title and colour scale around the empty place of the box."""
        from PIL import Image, ImageDraw

        width = max(self.size[0], _NARROWEST)
        lines = textwrap.wrap(self.scene.title, max(20, (width - 20) // 8))[:3]
        self.corner = ((width - self.size[0]) // 2, _LINE * (len(lines) + 1) + 12)
        bar = _BAR if self.top > 0.0 else 10
        bar += (self.corner[1] + bar) % 2   # the encoder wants an even height
        image = Image.new("RGB", (width, self.corner[1] + self.size[1] + bar), "white")
        pen = ImageDraw.Draw(image)
        for n, line in enumerate(lines):
            pen.text((10, 6 + _LINE * n), line, fill="#222222", font=self.fonts[0])
        left, top = self.corner
        pen.rectangle((left - 1, top - 1, left + self.size[0], top + self.size[1]), outline="#888888")
        if self.top > 0.0:
            self._colour_scale(image, pen, width)
        return np.asarray(image, np.uint8)

    def _colour_scale(self, image: Any, pen: Any, width: int) -> None:
        from PIL import Image

        factor, unit = length_unit(self.top)
        upper = self.corner[1] + self.size[1] + 8
        length = min(width - 40, 300)
        left = (width - length) // 2
        strip = self.colours[np.linspace(0, 255, length).astype(int)]
        image.paste(Image.fromarray(np.repeat(strip[None], 10, axis=0)), (left, upper))
        below = {"fill": "#333333", "font": self.fonts[1]}
        pen.text((left, upper + 12), "0", anchor="la", **below)
        pen.text((left + length, upper + 12), f"{factor * self.top:.3g}", anchor="ra", **below)
        pen.text((width // 2, upper + 12), f"speed of the fluid [{unit}/s]", anchor="ma", **below)

    def background(self, time: float) -> Pixels:
        """The flow at a time, rows from the top: (height, width, 3)."""
        slices = self.scene.slices
        if slices is None:
            return self._with_walls(np.full((self.size[1], self.size[0], 3), 244, np.uint8))
        after = int(np.clip(np.searchsorted(slices.times, time), 0, len(slices.times) - 1))
        speed = slices.speed[after]
        if after > 0 and time < slices.times[after]:
            part = (time - slices.times[after - 1]) / (slices.times[after] - slices.times[after - 1])
            speed = np.float32(1.0 - part) * slices.speed[after - 1] + np.float32(part) * speed
        rows, columns = self.spread
        pixels = rows @ speed @ columns.T
        level = np.clip(pixels * (255.0 / max(self.top, 1e-12)), 0.0, 255.0).astype(np.uint8)
        return self._with_walls(np.asarray(self.colours[level[::-1]]))

    def _with_walls(self, picture: Pixels) -> Pixels:
        picture[self.beyond] = [int(WALL_COLOUR[i : i + 2], 16) for i in (1, 3, 5)]
        return picture

    def draw_spheres(self, picture: Pixels, centres: Floats, turned: Floats) -> None:
        """Draw the spheres, far ones first; those the plane does not cut are pale in a crowd, left out in a mass."""
        scene, plane = self.scene, self.scene.plane
        across, up = np.eye(3)[plane.across], np.eye(3)[plane.up]
        view = np.stack([across, up, np.cross(across, up)])   # box axes to right, up, towards the viewer
        depth = centres[:, plane.normal] - plane.position
        if scene.period[plane.normal] > 0.0:
            depth = depth - scene.period[plane.normal] * np.rint(depth / scene.period[plane.normal])
        near = depth * view[2, plane.normal]
        axis = [plane.across, plane.up]
        for copy in periodic_copies(centres[:, axis], scene.period[axis]):
            order = np.argsort(near)
            if len(near) > _MANY:   # the rest would hide the plane, and take minutes to draw
                order = order[np.abs(depth[order]) <= 0.5 * np.asarray(scene.diameter)[order]]
            for n in order:
                pale = len(near) > _FEW and abs(depth[n]) > 0.5 * scene.diameter[n]
                radius = 0.5 * self.scale * scene.diameter[n]
                self._draw_sphere(picture, self.scale * copy[n], radius, view @ turned[n], n, pale)

    def _draw_sphere(
        self, picture: Pixels, at: Floats, radius: float, turned: Floats, number: int, pale: bool
    ) -> None:
        """A shaded ball of two tones, whose border turns with it."""
        column, row = at[0], self.size[1] - at[1]
        x0, x1 = max(0, int(column - radius - 1)), min(self.size[0], int(column + radius + 2))
        y0, y1 = max(0, int(row - radius - 1)), min(self.size[1], int(row + radius + 2))
        if x0 >= x1 or y0 >= y1:
            return
        x = (np.arange(x0, x1) + 0.5 - column)[None, :] / radius
        y = (row - np.arange(y0, y1) - 0.5)[:, None] / radius
        distance = np.sqrt(x**2 + y**2)
        cover = np.clip((1.0 - distance) * radius + 0.5, 0.0, 1.0)   # one pixel of soft edge
        z = np.sqrt(np.maximum(1.0 - distance**2, 0.0))
        along = turned[0, 0] * x + turned[1, 0] * y + turned[2, 0] * z   # the body's first axis
        tone = np.clip(0.5 + 0.5 * radius * along, 0.0, 1.0)[..., None]
        base = self.body_colours[number]
        shade = (0.55 + 0.5 * np.maximum(_LIGHT[0] * x + _LIGHT[1] * y + _LIGHT[2] * z, 0.0))[..., None]
        ball = np.minimum(shade * (tone * base + (1.0 - tone) * (0.4 * base + 150.0)), 255.0)
        weight = (cover * (0.3 if pale else 1.0))[..., None]
        part = picture[y0:y1, x0:x1]
        part[:] = (weight * ball + (1.0 - weight) * part).astype(np.uint8)

    def framed(self, picture: Pixels, time: float) -> Pixels:
        """The picture in its frame, with the time."""
        from PIL import Image, ImageDraw

        frame = self.frame.copy()
        left, top = self.corner
        frame[top : top + self.size[1], left : left + self.size[0]] = picture
        image = Image.fromarray(frame)
        pen = ImageDraw.Draw(image)
        pen.text((10, top - _LINE - 4), f"t = {time:.3f} s", fill="#222222", font=self.fonts[0])
        return np.asarray(image, np.uint8)


def _spread(cells: int, pixels: int) -> NDArray[np.float32]:
    """Linear interpolation from cell centres to pixels as a matrix: (pixels, cells)."""
    at = np.clip((np.arange(pixels) + 0.5) * cells / pixels - 0.5, 0.0, cells - 1.0)
    low = np.minimum(at.astype(int), max(cells - 2, 0))
    matrix = np.zeros((pixels, cells), np.float32)
    row = np.arange(pixels)
    matrix[row, np.minimum(low + 1, cells - 1)] = at - low
    matrix[row, low] += 1.0 - (at - low)
    return matrix
