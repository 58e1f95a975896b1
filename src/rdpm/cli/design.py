"""``rdpm design``: collision parameters from what is known, with reasons."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from rdpm.cli.design_models import check_model, only_printed, option, print_model, refuse_input
from rdpm.errors import CaseError

if TYPE_CHECKING:
    from rdpm.design.result import Design

__all__ = ["design"]

# quantity: SI unit; the names are those of rdpm.design.soft_sphere
_UNITS = {
    "mass": "kg",
    "diameter": "m",
    "density": "kg/m^3",
    "diameter2": "m",
    "density2": "kg/m^3",
    "stiffness": "N/m",
    "damping": "N s/m",
    "restitution": "",
    "contact_time": "s",
    "contact_steps": "",
    "time_step": "s",
    "max_overlap": "",
    "static_overlap": "",
    "impact_speed": "m/s",
    "youngs_modulus": "Pa",
    "poisson_ratio": "",
    "fluid_density": "kg/m^3",
    "viscosity": "Pa s",
    "gravity": "m/s^2",
    "tangential_ratio": "",
    "friction": "",
    "overlap_limit": "",
    "repulsion_range": "m",
    "repulsion_stiffness": "N",
    "gap": "m",
}
_SUFFIX = {"": "", "kg": "_kg", "m": "_m", "s": "_s", "m/s": "_m_s", "kg/m^3": "_kg_m3", "N/m": "_N_m",
           "N s/m": "_N_s_m", "N": "_N", "Pa": "_Pa", "Pa s": "_Pa_s", "m/s^2": "_m_s2"}  # fmt: skip
_MOST_ROWS = 1_000_000

_Quantity = Annotated[str | None, Parameter(allow_leading_hyphen=True)]
_Model = Literal["soft-sphere", "hertz", "repulsive", "hard-sphere"]
_Program = Literal["lammps", "liggghts", "mfix", "yade", "mercurydpm"]


def design(
    *,
    model: _Model = "soft-sphere",
    mass: _Quantity = None,
    diameter: _Quantity = None,
    density: _Quantity = None,
    diameter2: _Quantity = None,
    density2: _Quantity = None,
    wall: Annotated[bool, Parameter(negative="")] = False,
    stiffness: _Quantity = None,
    damping: _Quantity = None,
    restitution: _Quantity = None,
    contact_time: _Quantity = None,
    contact_steps: _Quantity = None,
    time_step: _Quantity = None,
    max_overlap: _Quantity = None,
    static_overlap: _Quantity = None,
    impact_speed: _Quantity = None,
    youngs_modulus: _Quantity = None,
    poisson_ratio: _Quantity = None,
    fluid_density: _Quantity = None,
    viscosity: _Quantity = None,
    gravity: _Quantity = None,
    tangential_ratio: _Quantity = None,
    friction: _Quantity = None,
    overlap_limit: _Quantity = None,
    repulsion_range: _Quantity = None,
    repulsion_stiffness: _Quantity = None,
    gap: _Quantity = None,
    ending: Literal["zero-force", "zero-overlap"] = "zero-force",
    approach: Literal["graphical", "trial", "contact-steps"] | None = None,
    units: Literal["si", "cgs"] = "si",
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    csv: Path | None = None,
    figures: Path | None = None,
    figure_format: Literal["png", "pdf", "svg"] = "png",
    export: _Program | None = None,
) -> int:
    """Design collision parameters from what is known, and judge them.

    A quantity is a number in SI or a number with a unit ("15 mm", "1e5 dyn/cm"). One of them may be a sweep,
    FROM:TO:COUNT or FROM:TO:COUNT:log, which gives a table.

    Give a mass, and two of stiffness, damping, restitution, contact time (or contact steps with a time step)
    and overlap at an impact speed; or three without the mass.

    With --model hertz: --diameter, --density, --youngs-modulus, --poisson-ratio, --restitution and an impact
    speed (or the fluid) give contact time, overlap and time step. With --model repulsive: --diameter, --density,
    --repulsion-range and either the closest --gap wanted or --repulsion-stiffness. With --model hard-sphere:
    --diameter, --density, --restitution, --time-step and an impact speed give the error that a soft sphere of
    --contact-steps would have.

    Parameters
    ----------
    model
        Contact model to design.
    mass
        Reduced mass [kg]; or --diameter with --density.
    diameter
        Of the sphere [m].
    density
        Of the sphere [kg/m^3].
    diameter2
        Of the other sphere [m]; equal without it.
    density2
        Of the other sphere [kg/m^3]; equal without it.
    wall
        The partner is a wall.
    stiffness
        Normal stiffness k_n [N/m].
    damping
        Normal damping eta_n [N s/m].
    restitution
        Dry normal restitution e_n.
    contact_time
        From touch to end [s].
    contact_steps
        N_c, time steps a contact lasts.
    time_step
        dt [s].
    max_overlap
        Peak overlap at the impact speed, of the smaller diameter ("0.5 %").
    static_overlap
        Overlap under the submerged weight, of the smaller diameter.
    impact_speed
        [m/s]; in a known fluid the terminal velocity without it.
    youngs_modulus
        Of the material [Pa], for the limits of Hertz and Rayleigh.
    poisson_ratio
        Of the material; gives the tangential ratio as well.
    fluid_density
        [kg/m^3].
    viscosity
        Dynamic [Pa s].
    gravity
        [m/s^2]; 9.81 without it.
    tangential_ratio
        k_t/k_n; 2/7 without it.
    friction
        Coulomb's coefficient.
    overlap_limit
        Bound of the overlap verdicts, of the smaller diameter; 0.5 % without it.
    repulsion_range
        Gap below which the repulsive force acts [m].
    repulsion_stiffness
        Repulsive force at touch [N].
    gap
        Closest wanted, at the impact speed and under the submerged weight [m].
    ending
        When the contact is over: the force turns attractive, or the overlap is gone.
    approach
        The table of one approach: graphical and trial sweep --stiffness, the third --contact-steps.
    units
        Of the printed table; JSON and CSV are in SI and say so in their names.
    as_json
        Print JSON, null where undefined.
    csv
        Write the table of a sweep or approach to this file instead of printing it.
    figures
        Write charts into this folder.
    figure_format
        Of the charts.
    export
        Print an input of this program: the contact, and a run of two spheres and a wall that shows it.
    """
    texts = {name: value for name, value in locals().items() if name in _UNITS and value is not None}
    single, swept = _read_inputs(texts)
    if model != "soft-sphere":
        only_printed(model, approach=approach, csv=csv, figures=figures, export=export)
        check_model(model, {**single, **swept}, swept)
        return print_model(model, single, wall, ending, as_json)
    if others := [name for name in ("repulsion_range", "repulsion_stiffness", "gap") if name in texts]:
        refuse_input(others[0], "repulsive", model)
    if approach is not None:
        _one_output(swept, figures=figures, export=export, json=as_json)
        _write_table(_approach_table(approach, single, swept, wall, ending), csv)
        return 0
    if swept:
        _one_output(swept, figures=figures, export=export)
        _print_sweep(swept, single, wall, ending, as_json, csv)
        return 0
    from rdpm.design import soft_sphere

    one = soft_sphere(**single, wall=wall, ending=ending)
    _print_one(one, units, as_json, export)
    _write_files(one, csv, figures, figure_format)
    return 0


def _number(name: str, text: str) -> float:
    """Read a quantity in SI, or with a unit; plain numbers are read without loading the library of units."""
    try:
        return float(text)
    except ValueError:
        from rdpm.config.units import parse_quantity
    try:
        return float(parse_quantity(text, _UNITS[name]))
    except ValueError as error:
        parts = (getattr(error, key, "") for key in ("rule", "reason", "cure"))
        rule, reason, cure = parts
        raise CaseError(option(name), f'"{text}"', rule or str(error), reason, cure) from None


def _range(name: str, text: str) -> list[float]:
    """Read FROM:TO:COUNT, evenly spaced, or FROM:TO:COUNT:log."""
    import numpy as np

    parts = [p.strip() for p in text.split(":")]
    rule, cure = "must be FROM:TO:COUNT or FROM:TO:COUNT:log", "For example 0.1:0.9:9."
    if len(parts) not in (3, 4) or not parts[2].isdigit() or parts[3:] not in ([], ["log"]):
        raise CaseError(option(name), f'"{text}"', rule, "a sweep has two ends and a count", cure)
    first, last, count = _number(name, parts[0]), _number(name, parts[1]), int(parts[2])
    if not 2 <= count <= _MOST_ROWS:
        raise CaseError(option(name), f'"{text}"', f"must have a count of 2 to {_MOST_ROWS}", cure=cure)
    if parts[3:] and not (first > 0.0 and last > 0.0):
        raise CaseError(
            option(name), f'"{text}"', "must have ends above 0", "they are spaced by a factor", cure
        )
    return [float(v) for v in (np.geomspace if parts[3:] else np.linspace)(first, last, count)]


def _one_output(swept: dict[str, Any], **others: Any) -> None:
    """Refuse what a table cannot go with."""
    for name, value in others.items():
        if value:
            what = "a sweep" if swept else "--approach"
            raise CaseError(
                option(name), None, f"cannot go with {what}", "it is for one design", "Take one away."
            )


def _print_sweep(
    swept: dict[str, Any], single: dict[str, float], wall: bool, ending: Any, as_json: bool, csv: Path | None
) -> None:
    """Design at each value of the one input that is swept."""
    from rdpm.design import soft_sphere

    name, values = next(iter(swept.items()))
    designs = [soft_sphere(**{**single, name: v}, wall=wall, ending=ending) for v in values]
    if as_json:
        print(json.dumps([d.to_dict() for d in designs], indent=2))
    if csv is not None or not as_json:
        _write_table([_row(name, v, d) for v, d in zip(values, designs, strict=True)], csv)


def _read_inputs(texts: dict[str, str]) -> tuple[dict[str, float], dict[str, list[float]]]:
    """Give the single values and the one that is swept, in SI."""
    single = {name: _number(name, text) for name, text in texts.items() if ":" not in text}
    swept = {name: _range(name, text) for name, text in texts.items() if ":" in text}
    if len(swept) > 1:
        raise CaseError("rdpm design", ", ".join(option(n) for n in swept), "only one input can be a sweep")
    return single, swept


def _write_files(
    one: Design, csv: Path | None, figures: Path | None, kind: Literal["png", "pdf", "svg"]
) -> None:
    """Write the table and the charts that are asked for."""
    if csv is not None:
        _write_table([_row("", 0.0, one)], csv)
    if figures is not None:
        _draw(one, figures, kind)


def _print_one(one: Design, units: Literal["si", "cgs"], as_json: bool, export: _Program | None) -> None:
    """Print a design as a table, JSON, or a fragment for another program."""
    if as_json and export is not None:
        raise CaseError(
            "--export", export, "cannot go with --json", "both go to the terminal", "Take one away."
        )
    if export is not None:
        from rdpm.design.export import export as fragment

        print(fragment(one, export), end="")
        return
    from rdpm.design.programs import step_lines, steps_there

    if as_json:
        print(json.dumps({**one.to_dict(), "programs": steps_there(one)}, indent=2))
    else:
        from rdpm.design.report import render

        print(render(one.to_dict(), units))
        print("\nThis spring in other programs (--export NAME writes the input)")
        print("\n".join(f"  {line}" for line in step_lines(one)))


def _row(name: str, value: float, one: Design) -> dict[str, Any]:
    """Flatten a design into one row of a table, the swept input first."""
    from rdpm.design.verdicts import failed_names

    swept = {f"{name}{_SUFFIX[_UNITS[name]]}": value} if name else {}
    plain = one.to_dict()
    flat = {k: v for k, v in plain.items() if not isinstance(v, dict | list)}
    side = {f"tangential_{k}": v for k, v in plain["tangential"].items()}
    best = {"best_contact_steps": one.advice.best_contact_steps}
    return {**swept, **flat, **side, **best, "failed_verdicts": " ".join(failed_names(one.verdicts))}


def _write_table(table: list[dict[str, Any]], path: Path | None) -> None:
    """Write rows as CSV, undefined values empty."""
    import csv
    import io

    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(table[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    if path is None:
        sys.stdout.write(text.getvalue())
        return
    from rdpm.io.files import replacing

    with replacing(path) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8")


def _approach_table(
    approach: str, single: dict[str, float], swept: dict[str, list[float]], wall: bool, ending: Any
) -> list[dict[str, Any]]:
    """Give the rows of one of the three approaches, columns with units."""
    from rdpm.design.approaches import approach_rows

    wanted = "contact_steps" if approach == "contact-steps" else "stiffness"
    if list(swept) != [wanted]:
        example = "4:20:17" if wanted == "contact_steps" else "1:1e4:9:log"
        raise CaseError(option(wanted), None, "must be a sweep", f"--approach {approach} lists it",
                        f"For example {option(wanted)} {example}.")  # fmt: skip
    return approach_rows(approach, swept[wanted], single, wall=wall, ending=ending)


def _draw(one: Design, folder: Path, kind: Literal["png", "pdf", "svg"]) -> None:
    """Write the charts of one design and name the files."""
    if not one.restitution or one.time_step_s is None:
        rule, why = (
            "needs a design with a restitution above 0 and a time step",
            "the charts are drawn for these",
        )
        raise CaseError("--figures", None, rule, why, "Add --time-step, or lower the damping.")
    from rdpm.figures.design_charts import save_charts

    files = save_charts(
        folder, reduced_mass=one.reduced_mass_kg, restitution=one.restitution, stiffness=one.stiffness_N_m,
        damping=one.damping_N_s_m, time_step=one.time_step_s, ending=one.ending, diameter=one.diameter_m,
        impact_speed=one.impact_speed_m_s, overlap_limit=one.overlap_limit_fraction,
        hertz_time=one.hertz_contact_time_s, kind=kind,
    )  # fmt: skip
    print(f"{len(files)} figures in {folder}", file=sys.stderr)
