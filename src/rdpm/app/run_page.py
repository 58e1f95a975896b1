"""The page of one run: how it stands and its buttons, the live scene and curves, then what it found."""

from __future__ import annotations

import math
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from nicegui import run, ui

from rdpm.app.frame import button, chart, files_link, frame, heading, html, problem, state
from rdpm.app.live import Frame, LiveRun
from rdpm.app.run_figures import live_curves
from rdpm.app.run_results import show_results
from rdpm.app.scene import SphereScene, colour_scale
from rdpm.app.settings import current
from rdpm.app.status import RunStatus, status_of
from rdpm.app.words import STATES, span
from rdpm.errors import CaseError, RdpmError
from rdpm.results.run import Run, load_run

__all__ = ["RunPage"]

_SCENE_EVERY, _CURVES_EVERY = 0.08, 1.0  # s
_MOST_BODIES = 20_000  # that a browser draws


class RunPage:
    """One visitor's view of a run.

    Parameters
    ----------
    name : str
        Of its folder.
    """

    def __init__(self, name: str) -> None:
        self.name, self.work, self.launcher = name, current().work, current().launcher
        try:
            self.files = self.work.run(name)
        except CaseError as error:
            with frame("No such run", "runs"):
                html(problem(str(error)))
            return
        self.live = LiveRun(self.files)
        self.scene: SphereScene | None = None
        self.top, self.slice_shown, self._is_reading = 0.0, True, False
        self._drawn: Frame | None = None  # the newest that the curves hold
        with frame(name, "runs"):
            self._head()
            self.view = ui.element("section").props('aria-label="Scene and curves"')
            self.results = ui.element("section").props('aria-label="Results"')
        self.status = self._status()
        self._show_status()
        self._build_view()
        ui.timer(0.05, self._build_results, once=True)
        ui.timer(_CURVES_EVERY, self._tick)
        ui.timer(_SCENE_EVERY, self._tick_scene)

    def _status(self) -> RunStatus:
        return status_of(self.name, self.files)

    def _head(self) -> None:
        self.title = html("")
        self.progress = html("").props("role=status")
        with ui.element("div").classes("rdpm-row"):
            self.buttons = {
                "pause": button("Pause", self._act(self.launcher.pause), "pause"),
                "resume": button("Resume", self._act(self.launcher.resume), "play_arrow"),
                "withdraw": button("Take from the queue", self._withdraw, "playlist_remove"),
                "stop": button("Stop", self._ask_to_stop, "stop"),
            }
            html(f'<a href="/cases?run={escape(self.name)}">Case</a>')
            self.log = html("")
        self.said = html("").props("aria-live=polite")

    def _act(self, act: Callable[[str], Any]) -> Callable[[], None]:
        def acted() -> None:
            try:
                act(self.name)
                self.said.set_content("")
            except RdpmError as error:
                self.said.set_content(problem(str(error)))
            self.status = self._status()
            self._show_status()

        return acted

    def _withdraw(self) -> None:
        self.launcher.withdraw(self.name)
        ui.navigate.to("/runs")

    def _ask_to_stop(self) -> None:
        with ui.dialog() as dialog, ui.card():
            html("<h2>Stop this run now?</h2><p>What it did since its last checkpoint is lost. Pause keeps all.</p>")
            with ui.element("div").classes("rdpm-row"):
                button("Stop now", lambda: (dialog.close(), self._act(self.launcher.stop)()))
                button("Let it run", dialog.close, is_main=True)
        dialog.open()

    def _show_status(self) -> None:
        now = self.status
        text, meaning = STATES.get(now.state, (now.state, ""))
        self.title.set_content(f"<p>{escape(now.title)}</p>")
        message = (
            f'<p class="rdpm-{"bad" if now.state in ("failed", "guard") else "warn"}">{escape(now.message)}</p>'
            if now.message
            else ""
        )
        self.progress.set_content(
            f"<p>{state(now.state, text)} {escape(_where(now) or meaning)}</p>{_bar(now)}{message}"
        )
        shown = {
            "pause": now.state == "running", "stop": now.state in ("running", "reporting"),
            "resume": now.can_go_on or now.state == "guard", "withdraw": now.state == "queued",
        }  # fmt: skip
        for name, made in self.buttons.items():
            made.set_visibility(shown[name])
        log = self.work.name(self.files.log)
        self.log.set_content(files_link(log, "run.log") if self.files.log.is_file() else "")

    def _build_view(self) -> None:
        """Scene and curves; the scene waits for the first row, which says how many bodies there are."""
        self.view.clear()
        with self.view:
            self.stage = ui.element("div")
            with ui.element("div").classes("rdpm-even"):
                drawn = live_curves(self.live)
                self.curves = {name: chart(options, options["title"]["text"]) for name, options in drawn.items()}
                self._show_curves(drawn)
        self.view.set_visibility(self.status.state != "done")

    def _show_curves(self, drawn: dict[str, Any]) -> None:
        """Show what has changed; a chart without a point is not shown."""
        for name, options in drawn.items():
            has_points = any(one["data"] for one in options["series"])
            self.curves[name].set_visibility(has_points)
            if has_points and options["series"] != self.curves[name].options["series"]:
                self.curves[name].options.update(options)
                self.curves[name].update()

    def _start_scene(self, diameter: Any) -> None:
        if not 0 < self.live.count <= _MOST_BODIES or diameter is None:
            return
        up = int(np.argmax(np.abs(self.live.gravity))) if self.live.gravity.any() else 2
        with self.stage:
            heading("Scene")
            self.scene = SphereScene(self.live.box, diameter, up)
            with ui.element("div").classes("rdpm-row"):
                self.scene.look_buttons()
                switch = ui.switch("slice of the flow", value=True)
                switch.on_value_change(lambda e: self._show_slice(bool(e.value)))
                self.scale = html("")
                self.clock = html("", "rdpm-soft")
            self.scene.help()

    def _show_slice(self, is_shown: bool) -> None:
        self.slice_shown = is_shown
        if self.scene and not is_shown:
            self.scene.hide_slice()
        self.live.look_again()

    async def _tick_scene(self) -> None:
        if (not self.status.is_active and self.scene is not None) or self._is_reading:
            return
        if self.status.state == "done":
            return
        self._is_reading = True
        try:
            is_new = await run.io_bound(self.live.read)
            frame_now = self.live.frame
            if not is_new or frame_now is None:
                return
            if self.scene is None:
                self._start_scene(await run.io_bound(_diameters, self.files.case, self.live.count))
            if self.scene is not None:
                self.scene.frame(frame_now.position, frame_now.rotation)
                self.clock.set_content(f"t = {frame_now.time:.4g} s")
        finally:
            self._is_reading = False

    async def _tick(self) -> None:
        before = self.status
        now = await run.io_bound(self._status)
        if now is None:
            return
        self.status = now
        if now != before:
            self._show_status()
        if now.state != before.state:
            await self._build_results()
            self.view.set_visibility(now.state != "done")
        is_still = not now.is_active and before.state == now.state and self.scene is not None
        if is_still and self._drawn is self.live.frame:
            return
        self._drawn = self.live.frame
        self._show_curves(live_curves(self.live))
        await self._tick_slice()

    async def _tick_slice(self) -> None:
        if self.scene is None or not self.slice_shown:
            return
        found = await run.io_bound(self.live.new_slice)
        if found is not None:
            self.top = max(self.top, float(np.quantile(found.speed, 0.999)))
            self.scene.slice(found, self.top)
            self.scale.set_content(colour_scale(f"{100.0 * self.top:.3g} cm/s, t = {found.time:.4g} s"))
            self.scene.say(_spoken(self.live))

    async def _build_results(self) -> None:
        self.results.clear()
        if self.status.summary is None or self.status.state in ("running", "queued"):
            return
        loaded = await run.io_bound(_loaded, self.files.path)
        with self.results:
            if isinstance(loaded, Run):
                show_results(loaded, self.work, has_replay=self.status.state == "done")
            else:
                html(problem(f"The results cannot be read yet: {loaded}"))


def _loaded(path: Path) -> Run | RdpmError:
    try:
        return load_run(path)
    except RdpmError as error:
        return error


def _where(now: RunStatus) -> str:
    if now.time is None or not now.end:
        return ""
    parts = [f"t = {now.time:.4g} of {now.end:.4g} s", f"step {now.steps}", f"{span(now.wall or 0.0)} of wall time"]
    return ", ".join(parts + ([f"{span(now.left)} left"] if now.left is not None else []))


def _bar(now: RunStatus) -> str:
    if now.state not in ("running", "reporting", "paused", "stopped"):
        return ""
    percent = math.floor(100 * now.progress)
    return f'<progress max="100" value="{percent}" aria-label="Simulated time done">{percent} %</progress>'


def _spoken(live: LiveRun) -> str:
    if live.frame is None:
        return "Spheres in their box"
    fall = live.settling[-1][0] if live.settling else math.nan
    spheres = f"{live.count} spheres" if live.count > 1 else "One sphere"
    return f"{spheres} at t = {live.frame.time:.3g} s, settling at {100 * fall:.3g} cm/s"


def _diameters(case: Any, count: int) -> Any:
    """Of all bodies, from the case of the run."""
    from rdpm.config.load import load_case

    try:
        found = load_case(case).expanded_bodies().diameter
    except RdpmError:
        return None
    return found if len(found) == count else None
