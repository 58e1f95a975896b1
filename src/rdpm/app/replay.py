"""A run that is over, once more: the scene at any of its times."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import ui

from rdpm.app.frame import button, heading, html
from rdpm.app.live import Frame, LiveRun, turned
from rdpm.app.scene import SphereScene, colour_scale
from rdpm.errors import CaseError
from rdpm.io.vtkhdf import field_times
from rdpm.results.run import Run

__all__ = ["Replay"]

_MOST_VALUES = 20_000_000  # of positions and rotations that are kept
_EVERY = 0.1  # s
_SECONDS = 12.0  # that a replay takes


class Replay:
    """Scene, a slider over the time, and a button that lets it run.

    Parameters
    ----------
    run : Run
        With bodies.
    """

    def __init__(self, run: Run) -> None:
        assert run.tracks is not None
        tracks = run.tracks
        step = max(1, int(np.ceil(tracks.position.size / _MOST_VALUES)))
        self.times = tracks.times[::step]
        self.position = np.where(run.periodic, tracks.position[::step] % run.box, tracks.position[::step])
        self.rotation = _rotations(self.times, tracks.angular_velocity[::step])
        self.live = LiveRun(run.folder)
        self.flow = field_times(run.fields) if run.fields is not None else np.empty(0)
        self.top, self.flow_shown, self.at = 0.0, -1, 0
        up = int(np.argmax(np.abs(run.gravity))) if run.gravity.any() else 2
        heading("Replay")
        self.scene = SphereScene(run.box, run.diameter, up)
        with ui.element("div").classes("rdpm-row"):
            self.play = button("Play", self._toggle, "play_arrow", is_main=True)
            self.scene.look_buttons()
            self.switch = ui.switch("slice of the flow", value=True, on_change=self._switched)
            self.switch.set_visibility(bool(len(self.flow)))
            self.scale = html("")
        self.slider = ui.slider(min=0, max=max(1, len(self.times) - 1), value=0).props(
            'aria-label="Time of the replay"'
        )
        self.slider.on_value_change(lambda e: self.show(int(e.value or 0)))
        self.clock = html("", "rdpm-soft")
        self.scene.help()
        self.timer = ui.timer(_EVERY, self._advance, active=False)
        ui.timer(0.2, lambda: self.show(self.at), once=True)

    def show(self, at: int) -> None:
        """Show the bodies, and the flow stored nearest before, at the time of this number."""
        self.at = min(max(at, 0), len(self.times) - 1)
        time = float(self.times[self.at])
        self.scene.frame(self.position[self.at], self.rotation[self.at])
        self.clock.set_content(f"t = {time:.4g} s")
        if len(self.flow) and self.switch.value:
            self._show_flow(max(0, int(np.searchsorted(self.flow, time, side="right")) - 1))

    def _show_flow(self, step: int) -> None:
        if step == self.flow_shown:
            return
        self.live.frame = Frame(float(self.times[self.at]), self.position[self.at], self.rotation[self.at])
        try:
            if not self.top:
                self.top = max(float(np.quantile(self.live.slice_at(n).speed, 0.999)) for n in _some(len(self.flow)))
            found = self.live.slice_at(step)
        except (CaseError, IndexError, ValueError):
            return
        self.flow_shown = step
        self.scene.slice(found, self.top)
        self.scale.set_content(colour_scale(f"{100.0 * self.top:.3g} cm/s, t = {found.time:.4g} s"))

    def _switched(self) -> None:
        self.flow_shown = -1
        if self.switch.value:
            self.show(self.at)
        else:
            self.scene.hide_slice()

    def _toggle(self) -> None:
        self.timer.active = not self.timer.active
        self.play.set_text("Halt" if self.timer.active else "Play")
        if self.timer.active and self.at >= len(self.times) - 1:
            self.slider.set_value(0)

    def _advance(self) -> None:
        stride = max(1, round(len(self.times) * _EVERY / _SECONDS))
        self.slider.set_value(min(self.at + stride, len(self.times) - 1))
        if self.at >= len(self.times) - 1:
            self._toggle()


def _some(count: int) -> list[int]:
    return sorted({count - 1, count // 2, count // 4})


def _rotations(times: Any, omega: Any) -> Any:
    """Orientations (T, N, 4) from angular velocities, upright at first."""
    found = np.zeros((*omega.shape[:2], 4), np.float32)
    found[0, :, 3] = 1.0
    for n in range(1, len(times)):
        found[n] = turned(found[n - 1].astype(np.float64), 0.5 * (omega[n] + omega[n - 1]) * (times[n] - times[n - 1]))
    return found
