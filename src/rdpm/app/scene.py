"""The spheres of a run in three dimensions, as an element of a page."""

from __future__ import annotations

import base64
import io
from functools import partial
from typing import Any

import numpy as np
from nicegui.element import Element
from nicegui.elements.scene import Scene
from nicegui.elements.scene.scene_object3d import Object3D
from numpy.typing import ArrayLike, NDArray

from rdpm.app.frame import button, html
from rdpm.app.live import Slice
from rdpm.figures.style import FLOW_MAP

__all__ = ["SphereScene", "colour_scale", "picture"]

# Their import makes three.js known to the browser under the name that static/spheres.js takes it by.
_THREE: Any = (Scene, Object3D)


class SphereScene(Element, component="static/spheres.js"):
    """A box with spheres in it, to be turned and come closer to by mouse, fingers and keys.

    Parameters
    ----------
    box : array_like, (3,), [m]
    diameter : array_like, (N,), [m]
    up : int
        Axis that points upwards.
    """

    def __init__(self, box: ArrayLike, diameter: ArrayLike, up: int) -> None:
        super().__init__()
        self._props["box"] = np.asarray(box, np.float64).tolist()
        self._props["diameters"] = np.asarray(diameter, np.float64).tolist()
        self._props["up"] = int(up)
        self._props["label"] = "Spheres in their box"

    def frame(self, position: ArrayLike, rotation: ArrayLike) -> None:
        """Move the spheres: centres (N, 3) [m], unit quaternions (N, 4)."""
        self.run_method("frame", packed(position), packed(rotation))

    def slice(self, found: Slice, top: float) -> None:
        """Show the speed of the fluid in a plane, the colours ending at `top` [m/s]."""
        self.run_method("slice", picture(found.speed, top), found.normal, found.position)

    def hide_slice(self) -> None:
        """Take the plane away."""
        self.run_method("hide_slice")

    def look(self, way: str) -> None:
        """Look from the "front", a "corner", or "above"."""
        self.run_method("look", way)

    def look_buttons(self) -> None:
        """Put buttons on the page that choose from where to look."""
        for way, text in (("front", "From the front"), ("corner", "From a corner"), ("above", "From above")):
            button(text, partial(self.look, way))

    @staticmethod
    def help() -> None:
        """Tell how the scene is turned."""
        html(
            '<p class="rdpm-soft">Drag to turn, ctrl and wheel or two fingers to come closer. Keys: arrows move, shift '
            "and arrows turn, + and - come closer.</p>"
        )

    def say(self, text: str) -> None:
        """Tell those who do not see it what there is."""
        self._props["label"] = text
        self.update()


def packed(values: ArrayLike) -> str:
    """Write numbers as the browser reads them fastest.

    Examples
    --------
    >>> packed([1.0])
    'AACAPw=='
    """
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode("ascii")


def picture(values: NDArray[Any], top: float) -> str:
    """Paint an array, its last row on top, as the address of a PNG picture.

    Examples
    --------
    >>> picture(np.zeros((2, 3)), 1.0)[:22]
    'data:image/png;base64,'
    """
    from matplotlib import colormaps
    from PIL import Image

    paint = colormaps[FLOW_MAP](np.clip(values[::-1] / max(top, 1e-12), 0.0, 1.0), bytes=True)
    file = io.BytesIO()
    Image.fromarray(paint[..., :3]).save(file, "PNG", compress_level=1)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode("ascii")


def colour_scale(top: str) -> str:
    """Write the scale that goes with a slice.

    Examples
    --------
    >>> colour_scale("1 m/s").count("#")
    9
    """
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    stops = ", ".join(to_hex(colormaps[FLOW_MAP](x)) for x in np.linspace(0.0, 1.0, 9))
    ramp = f'<span class="rdpm-scale" style="background: linear-gradient(to right, {stops})"></span>'
    return f'<span class="rdpm-soft">speed of the fluid: 0 {ramp} {top}</span>'
