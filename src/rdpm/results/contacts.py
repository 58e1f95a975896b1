"""What a contact was: an impact or pressed, within what its design promises or not, and why."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rdpm.design.verdicts import LEAST_CONTACT_STEPS
from rdpm.results.summary import ContactDesign, PairDesign

__all__ = [
    "LEAST_STOKES", "MOST_CONTACT_TIMES", "NOT_OUTSIDE", "RESTITUTION_TOLERANCE", "count_reasons", "is_pressed",
    "outside_range",
]  # fmt: skip

#: Stokes number of an impact below which the fluid sets both speeds.
LEAST_STOKES = 1.0

#: Designed contact times beyond which a force holds the bodies together.
MOST_CONTACT_TIMES = 3.0

#: Restitution achieved may differ from the designed one by so much: the weight of a body in a slow impact.
RESTITUTION_TOLERANCE = 0.02

#: Overlap over that of an undisturbed impact at the same speed, above which something else pressed.
_PUSHED = 1.1

#: What ``contacts.csv`` says of a contact within the promised range.
NOT_OUTSIDE = "no"


def is_pressed(
    kind: ArrayLike, stokes_number: ArrayLike, duration: ArrayLike, contact_times: Mapping[str, float]
) -> NDArray[np.bool_]:
    """Tell contacts in which something presses the bodies together from impacts; they have no restitution.

    Pressed are those whose Stokes number is below 1, and those that lasted more than three contact times of the design:
    both speeds are then those of the flow or of a load, not of an impact.

    Parameters
    ----------
    kind : array_like of str, (K,)
        "sphere-sphere" or "sphere-wall".
    stokes_number : array_like, (K,), [-]
        Of the impact; nan when dry.
    duration : array_like, (K,), [s]
    contact_times : mapping of str to float, [s]
        Of the design, by kind; the longest where there are several of a kind. One that is missing judges nothing.

    Returns
    -------
    ndarray of bool, (K,)

    Examples
    --------
    >>> is_pressed(["sphere-wall"] * 3, [0.5, 20.0, 20.0], [0.01, 0.01, 0.05], {"sphere-wall": 0.012}).tolist()
    [True, False, True]
    """
    stokes, span = np.asarray(stokes_number, np.float64), np.asarray(duration, np.float64)
    designed = np.array([contact_times.get(str(name), np.inf) for name in np.asarray(kind)])
    return np.asarray((stokes < LEAST_STOKES) | (span > MOST_CONTACT_TIMES * designed))


def outside_range(
    rows: Mapping[str, NDArray[Any]] | NDArray[np.void], pressed: NDArray[np.bool_], design: ContactDesign
) -> NDArray[np.str_]:
    """Say of each contact what left the range that the design promises, and why.

    A design promises, for each kind of pair, an overlap below the limit of the case, a contact resolved by 4 steps,
    and its restitution to 0.02 (in a fluid: no more than that; of a repulsive force instead that surfaces do not
    touch). The reasons are: *pressed*; *fast impact*, which alone does that at its speed; *pushed*, where another force
    acted during an impact (the weight in a slow one, another body, the flow); *at rest*, of a hard sphere below its
    rest speed; *cut*, of a contact that the end of the run broke off.

    Parameters
    ----------
    rows : mapping of ndarray, or structured array, (K,)
        Columns of ``contacts.csv``.
    pressed : ndarray of bool, (K,)
        From `is_pressed`.
    design : ContactDesign

    Returns
    -------
    ndarray of str, (K,)
        Such as "overlap (fast impact)"; several joined by "; "; "no" of a contact within.

    Examples
    --------
    >>> soft = PairDesign("sphere-wall", restitution=0.9, impact_speed_m_s=0.1, max_overlap_fraction=0.004)
    >>> rows = {"kind": ["sphere-wall"] * 2, "max_overlap_fraction": [0.008, 0.008], "impact_speed_m_s": [0.2, 0.1],
    ...         "steps": [8.0, 3.0], "restitution": [0.9, 0.9], "stokes_number": [np.nan] * 2,
    ...         "rebound_speed_m_s": [0.18, 0.09]}
    >>> design = ContactDesign("soft-sphere", pairs=(soft,), overlap_warning=0.005)
    >>> outside_range({k: np.array(v) for k, v in rows.items()}, np.zeros(2, bool), design).tolist()
    ['overlap (fast impact)', 'overlap (pushed); steps (pushed)']
    """
    said = np.full(len(pressed), "", "U64")
    kind = np.asarray(rows["kind"])
    for name in np.unique(kind):
        of_kind = kind == name
        pairs = [pair for pair in design.pairs if pair.kind.split(" ")[0] == name]
        columns = {column: np.asarray(rows[column], np.float64)[of_kind] for column in _JUDGED}
        texts = said[of_kind]
        for what, is_outside, why in _judged(columns, pressed[of_kind], design, pairs):
            reason = np.char.add(np.char.add(f"{what} (", why[is_outside]), ")")
            before = texts[is_outside]
            texts[is_outside] = np.char.add(np.where(before == "", "", np.char.add(before, "; ")), reason)
        said[of_kind] = texts
    said[said == ""] = NOT_OUTSIDE
    return said


_JUDGED = ("impact_speed_m_s", "rebound_speed_m_s", "max_overlap_fraction", "steps", "restitution", "stokes_number")


def _judged(
    rows: Mapping[str, NDArray[Any]], pressed: NDArray[np.bool_], design: ContactDesign, pairs: list[PairDesign]
) -> Iterator[tuple[str, NDArray[np.bool_], NDArray[np.str_]]]:
    """What may leave its range, of the contacts of one kind; where it did, and why it would."""
    speed, overlap, e = rows["impact_speed_m_s"], rows["max_overlap_fraction"], rows["restitution"]
    is_fast = speed > max((pair.impact_speed_m_s or np.inf for pair in pairs), default=np.inf)
    if design.model == "repulsive":
        yield "touch", overlap > 0.0, _reasons(("pressed", pressed), ("fast impact", ~pressed))
        return
    if design.overlap_warning is not None:
        is_alone = overlap <= _PUSHED * np.array([_overlap_of_an_impact(design.model, pairs, v) for v in speed])
        why = _reasons(("pressed", pressed), ("fast impact", is_alone))
        yield "overlap", overlap > design.overlap_warning, why
    if design.model in ("soft-sphere", "hertz"):
        is_cut = np.isnan(rows["rebound_speed_m_s"])
        why = _reasons(("cut", is_cut), ("fast impact", is_fast & (design.model == "hertz")))
        yield "steps", ~pressed & (rows["steps"] < LEAST_CONTACT_STEPS * (1.0 - 1e-6)), why
    targets = [pair.restitution for pair in pairs if pair.restitution is not None]
    targets += [design.restitution] if not targets and design.restitution is not None else []
    if targets:
        is_dry = np.isnan(rows["stokes_number"])
        is_less = is_dry & (e < min(targets) - RESTITUTION_TOLERANCE)
        why = _reasons(("at rest", (e == 0.0) & (design.model == "hard-sphere")))
        yield "restitution", ~pressed & (is_less | (e > max(targets) + RESTITUTION_TOLERANCE)), why


def _reasons(*known: tuple[str, NDArray[np.bool_]]) -> NDArray[np.str_]:
    """The first reason that applies; that another force acted where none does."""
    return np.select([where for _, where in known], [np.str_(name) for name, _ in known], np.str_("pushed"))


def _overlap_of_an_impact(model: str | None, pairs: list[PairDesign], speed: float) -> float:
    """Overlap of an undisturbed impact at a speed, the largest of a kind; nan where the design has none."""
    power, known = 0.8 if model == "hertz" else 1.0, [np.nan]
    for pair in pairs if speed > 0.0 else []:
        if pair.max_overlap_fraction and pair.impact_speed_m_s:
            known.append(pair.max_overlap_fraction * (speed / pair.impact_speed_m_s) ** power)
        elif pair.stiffness_N_m and pair.reduced_mass_kg and pair.diameter_m:   # without the little that damping takes
            known.append(speed * math.sqrt(pair.reduced_mass_kg / pair.stiffness_N_m) / pair.diameter_m)
    return float(np.nanmax(known)) if len(known) > 1 else math.nan


def count_reasons(outside: Iterable[str]) -> dict[str, int]:
    """Count what `outside_range` said, the most frequent first.

    Examples
    --------
    >>> count_reasons(["no", "overlap (pressed)", "overlap (pressed); restitution (pushed)"])
    {'overlap (pressed)': 2, 'restitution (pushed)': 1}
    """
    said = Counter(reason for text in outside if text != NOT_OUTSIDE for reason in text.split("; "))
    return dict(said.most_common())
