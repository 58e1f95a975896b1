"""The page that designs a contact: what is known on the left, what follows on the right, at once."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from html import escape
from typing import Any
from urllib.parse import urlencode

from nicegui import ui

from rdpm.app.design_charts import CHARTS, draw
from rdpm.app.design_inputs import EMPTY, INPUTS, WAYS, Input, carried_over, designed, query_of, shown, state_of
from rdpm.app.frame import button, chart, code, frame, heading, html, problem, state, table, written
from rdpm.app.materials import FLUIDS, MATERIALS
from rdpm.config.units import parse_quantity
from rdpm.design import Design
from rdpm.design.export import PROGRAMS, export
from rdpm.design.programs import PROGRAMS as KNOWN
from rdpm.design.programs import steps_there
from rdpm.design.report import rows
from rdpm.errors import CaseError

__all__ = ["DesignPage"]

_SPHERE = ("diameter", "density", "youngs_modulus", "poisson_ratio")
_SCHEMES = {
    "explicit-euler": "explicit Euler", "semi-implicit-euler": "semi-implicit Euler",
    "velocity-verlet": "velocity Verlet",
}  # fmt: skip
_WORDS = {"ok": "ok", "note": "note", "fail": "limit broken"}


def case_fragment(design: Design) -> str:
    """Write the contact of a design as a table of a case file.

    Examples
    --------
    >>> from rdpm.design import soft_sphere
    >>> print(case_fragment(soft_sphere(mass=1e-3, restitution=0.8, stiffness=1e2)))
    [contact]
    stiffness = 100.0
    restitution = 0.8
    ending = "zero-force"
    <BLANKLINE>
    """
    spring = {"stiffness": design.stiffness_N_m}
    if design.restitution:
        spring["restitution"] = design.restitution
    else:
        spring["damping"] = design.damping_N_s_m
    if design.tangential.friction is not None:
        spring["friction"] = design.tangential.friction
    lines = [f"{key} = {float(f'{value:.9g}')!r}" for key, value in spring.items()]
    return "\n".join(["[contact]", *lines, f'ending = "{design.ending}"', ""])


class DesignPage:
    """One visitor's design; its state is the address.

    Parameters
    ----------
    query : mapping of str to str
        Of the address.
    """

    def __init__(self, query: dict[str, str]) -> None:
        self.state = state_of(query)
        self.fields: dict[str, ui.input] = {}
        self.sliders: dict[str, ui.slider] = {}
        self.rows: dict[str, ui.element] = {}
        self.notes: dict[str, ui.html] = {}
        self._is_setting = False
        self.shown_chart, self.shown_export = "damping", "case"
        self.design: Design | None = None
        with frame("Design of a contact", "design"), ui.element("div").classes("rdpm-two"):
            with ui.element("section").props('aria-label="What is known"'):
                self._inputs()
            with ui.element("section").props('aria-label="What follows"'):
                self._outputs()
        self.update()

    def _inputs(self) -> None:
        heading("Sphere")
        self._choice("material", "material", {"": "own numbers", **{m: m for m in MATERIALS}})
        self.notes["material"] = html("", "rdpm-soft")
        for name in _SPHERE:
            self._quantity(INPUTS[name])
        self._choice("partner", "meets", {"pair": "an equal sphere", "other": "another sphere", "wall": "a wall"})
        for name in ("diameter2", "density2"):
            self._quantity(INPUTS[name])
        heading("Fluid and impact")
        self._choice("fluid", "fluid", {"": "own numbers", "none": "none (dry)", **{f: f for f in FLUIDS}})
        self.notes["fluid"] = html("", "rdpm-soft")
        for name in ("fluid_density", "viscosity", "impact_speed"):
            self._quantity(INPUTS[name])
        heading("Contact")
        self._choice("way", "known of the contact", {key: text for key, (text, _) in WAYS.items()})
        for name in dict.fromkeys(name for _, names in WAYS.values() for name in names):
            self._quantity(INPUTS[name])
        self._quantity(INPUTS["friction"])
        self._choice("ending", "a contact ends at", {"zero-force": "zero force", "zero-overlap": "zero overlap"})

    def _choice(self, name: str, label: str, options: dict[str, str]) -> None:
        picked = ui.select(
            options, label=label, value=self.state[name], on_change=lambda e: self._chosen(name, e.value)
        )
        picked.classes("rdpm-field").props(f'dense outlined data-name="{name}"')

    def _quantity(self, item: Input) -> None:
        with ui.element("div").classes("rdpm-field") as row:
            unit = f" [{item.unit}]" if item.unit else ""
            field = ui.input(item.label + unit, value=self.state.get(item.name, ""))
            field.props(f'dense outlined debounce=60 hide-hint hint="{escape(item.help)}" data-name="{item.name}"')
            if item.name in EMPTY:
                field.props(f'stack-label placeholder="{EMPTY[item.name]}"')
            field.without_auto_validation()
            field.classes("rdpm-field").on_value_change(lambda e: self._typed(item, e.value))
            low, high = (math.log10(v) if item.is_log else v for v in (item.low, item.high))
            slider = ui.slider(min=low, max=high, step=(high - low) / 400.0, value=low)
            slider.props(f'dense aria-label="{escape(item.label)}" data-name="{item.name}"')
            slider.on("update:model-value", lambda e: self._slid(item, e.args), throttle=0.05)
        self.fields[item.name], self.sliders[item.name], self.rows[item.name] = field, slider, row

    def _outputs(self) -> None:
        with ui.element("div").classes("rdpm-row"):
            button("Copy link", self._copy_link, "link")
        self.problem = html("")
        self.summary = html("").props("aria-live=polite")
        self.verdicts = html("")
        self._tabs({name: text for name, (text, _) in CHARTS.items()}, self._show_chart)
        self.chart = chart(draw(self.shown_chart, None), "Chart of the design")
        with ui.element("div").classes("rdpm-even"):
            self.table = html("")
            self.others = html("")
        heading("Take it along")
        names = {"case": "Case file", **{name: title for name, title in _titles().items()}}
        self._tabs(names, self._show_export)
        button("Copy", self._copy_export, "content_copy")
        self.exported = html("")

    def _tabs(self, names: dict[str, str], show: Callable[[str], None]) -> None:
        with ui.tabs().props("dense align=left no-caps") as tabs:
            made = [ui.tab(name, text) for name, text in names.items()]
        tabs.set_value(made[0])
        tabs.on_value_change(lambda e: show(str(e.value)))

    def _chosen(self, name: str, value: Any) -> None:
        if not self._is_setting and str(value or "") != self.state[name]:
            self.state = carried_over(self.state, name, str(value or ""), self.design)
            self.update()

    def _typed(self, item: Input, value: Any) -> None:
        if not self._is_setting:
            self.state[item.name] = str(value or "")
            self.update()

    def _slid(self, item: Input, value: Any) -> None:
        number = value if isinstance(value, int | float) and not isinstance(value, bool) else 0.0
        low, high = (math.log10(v) if item.is_log else v for v in (item.low, item.high))
        number = min(max(float(number), low), high)
        self.state[item.name] = shown(10.0**number if item.is_log else number, item.unit)
        self.update(slid=item.name)

    def update(self, slid: str = "") -> None:
        """Design anew, and show what changed."""
        try:
            self.design, wrong = designed(self.state), None
        except CaseError as error:
            self.design, wrong = None, error
        self._show_inputs(wrong, slid)
        self.problem.set_content(problem("" if wrong is None else str(wrong)))
        found = self.design
        self.summary.set_content("" if found is None else _summary(found))
        self.verdicts.set_content("" if found is None else _verdicts(found))
        self.table.set_content("" if found is None else _numbers(found))
        self.others.set_content("" if found is None else _programs(found))
        self._show_chart(self.shown_chart)
        self._show_export(self.shown_export)
        link = json.dumps("/design?" + urlencode(query_of(self.state)))
        if ui.context.client.has_socket_connection:
            ui.run_javascript(f'history.replaceState(history.state, "", {link})')

    def _show_inputs(self, wrong: CaseError | None, slid: str) -> None:
        used = set(query_of(self.state | {name: "1" for name in INPUTS}))
        self._is_setting = True
        for name, field in self.fields.items():
            self.rows[name].set_visibility(name in used)
            field.set_value(self.state.get(name, ""))
            self.sliders[name].classes(
                **{"remove" if self.state.get(name, "").strip() else "add": "rdpm-unset"}  # no value: no place on it
            )
            is_wrong = wrong is not None and wrong.place == name
            field.error = f"{wrong.rule}. {wrong.cure}" if is_wrong and wrong is not None else None
            if name != slid:
                self._set_slider(INPUTS[name])
        self._is_setting = False

        solid, fluid = MATERIALS.get(self.state["material"]), FLUIDS.get(self.state["fluid"])
        self.notes["material"].set_content(
            f"{shown(solid.density, 'kg/m^3')}, {shown(solid.youngs_modulus, 'Pa')}, Poisson's ratio "
            f"{solid.poisson_ratio} ({escape(solid.source)})" if solid else ""
        )  # fmt: skip
        self.notes["fluid"].set_content(
            f"{shown(fluid.density, 'kg/m^3')}, {shown(fluid.viscosity, 'Pa s')} ({escape(fluid.source)})"
            if fluid
            else ""
        )

    def _set_slider(self, item: Input) -> None:
        try:
            number = parse_quantity(self.state.get(item.name, ""), item.unit)
        except ValueError:
            return
        at = math.log10(max(number, item.low)) if item.is_log else number
        self.sliders[item.name].set_value(at)

    def _show_chart(self, name: str) -> None:
        self.shown_chart = name if name in CHARTS else "damping"
        options = draw(self.shown_chart, self.design)
        self.chart.options.clear()
        self.chart.options.update(options)
        self.chart.update()

    def _show_export(self, name: str) -> None:
        self.shown_export = name if name in PROGRAMS else "case"
        self.exported.set_content(code(self._text(), f"Input for {self.shown_export}") if self.design else "")

    def _text(self) -> str:
        if self.design is None:
            return ""
        try:
            return case_fragment(self.design) if self.shown_export == "case" else export(self.design, self.shown_export)
        except CaseError as error:
            return str(error)

    def _copy_export(self) -> None:
        ui.clipboard.write(self._text())
        ui.notify("copied")

    def _copy_link(self) -> None:
        link = json.dumps("/design?" + urlencode(query_of(self.state)))
        ui.run_javascript(f"navigator.clipboard?.writeText(location.origin + {link})")
        ui.notify("The link holds all that is set here; whoever opens it needs the token too.")


def _titles() -> dict[str, str]:
    return {name: KNOWN[name].title for name in PROGRAMS}


def _summary(design: Design) -> str:
    overlap = design.max_overlap_fraction
    found = {
        "k_n": written(design.stiffness_N_m, "N/m"), "eta_n": written(design.damping_N_s_m, "N s/m"),
        "t_c": "-" if design.contact_time_s is None else shown(design.contact_time_s, "s"),
        "N_c": written(design.contact_steps), "e_n": written(design.restitution),
        "overlap": "-" if overlap is None else f"{100 * overlap:.3g} % d",
    }  # fmt: skip
    items = "".join(f"<div><dt>{name}</dt><dd>{escape(value)}</dd></div>" for name, value in found.items())
    return f'<dl class="rdpm-key">{items}</dl>'


def _verdicts(design: Design) -> str:
    items = "".join(
        f'<li>{state(v.severity, _WORDS[v.severity])} {escape(v.text)}<br><span class="rdpm-soft">{escape(v.reason)} '
        f"({escape(v.source)})</span></li>"
        for v in sorted(design.verdicts, key=lambda v: ("fail", "note", "ok").index(v.severity))
    )
    return f'<ul class="rdpm-list">{items}</ul><p class="rdpm-note">{escape(design.advice.text)}</p>'


def _numbers(design: Design) -> str:
    found = [
        (name, written(value, unit, 5), note) for name, value, unit, note in rows(design.to_dict()) if value is not None
    ]
    return table(found, caption="The contact")


def _programs(design: Design) -> str:
    cells = []
    for name, there in steps_there(design).items():
        if there is not None:
            e = there["achieved_restitution"]
            cells.append((_titles()[name], shown(there["time_step_s"], "s"), str(there["contact_steps"]), _range(e)))
    heads = ("program", "dt", "N_c", "e_n it gives")
    parts = [table(cells, heads, "This spring in other programs, with the time step it needs there")] if cells else []
    schemes = [
        (_SCHEMES.get(p.integrator, p.integrator), f"{p.mean:.3f}", f"{p.least:.3f} to {p.greatest:.3f}")
        for p in design.predictions
    ]
    if schemes:
        parts.append(
            table(schemes, ("integrator", "e_n", "by moment of touch"), "At these contact steps, without sub-steps")
        )
    return "".join(parts)


def _range(there: dict[str, Any]) -> str:
    values = [there.get(key) for key in ("mean", "least", "greatest")]
    if any(not isinstance(value, float) for value in values):
        return "-"
    mean, least, greatest = values
    return f"{mean:.3f} ({least:.3f} to {greatest:.3f})"
