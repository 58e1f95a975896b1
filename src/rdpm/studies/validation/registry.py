"""The cases by name, and how they are run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

from rdpm.studies.validation.basset import basset
from rdpm.studies.validation.falls import bouncing_sphere, sliding_ball, stacked_spheres
from rdpm.studies.validation.impacts import glass_spheres, normal_impact, oblique_impact
from rdpm.studies.validation.mordant_pinton import mordant_pinton
from rdpm.studies.validation.near_contact import near_contact
from rdpm.studies.validation.near_contact_shear import near_contact_shear
from rdpm.studies.validation.rebound import rebound
from rdpm.studies.validation.result import Chart, Found, Row, Tell
from rdpm.studies.validation.rotation import rotation
from rdpm.studies.validation.simple_cubic import simple_cubic
from rdpm.studies.validation.stream import stream
from rdpm.studies.validation.ten_cate import E1, E3, ten_cate
from rdpm.studies.validation.time_order import time_order
from rdpm.studies.validation.wet_impacts import wet_impacts

__all__ = ["CASES", "validate"]

#: Name -> (case, whether it runs with --quick).
CASES: dict[str, tuple[Callable[[bool, Tell], Found], bool]] = {
    "simple-cubic": (simple_cubic, True),
    "ten-cate-e3": (partial(ten_cate, E3), True),
    "ten-cate-e1": (partial(ten_cate, E1), False),
    "basset": (basset, True),
    "rotation": (rotation, True),
    "mordant-pinton": (mordant_pinton, False),
    "stream": (stream, True),
    "near-contact": (near_contact, True),
    "near-contact-shear": (near_contact_shear, True),
    "rebound": (rebound, True),
    "wet-impacts": (wet_impacts, False),
    "time-order": (time_order, True),
    "bouncing-sphere": (bouncing_sphere, True),
    "stacked-spheres": (stacked_spheres, True),
    "sliding-ball": (sliding_ball, True),
    "normal-impact": (normal_impact, True),
    "oblique-impact": (oblique_impact, True),
    "glass-spheres": (glass_spheres, True),
}


def validate(
    names: Iterable[str] = (), quick: bool = False, tell: Tell | None = None
) -> Iterator[dict[str, Any] | Chart]:
    """Run published cases against this build.

    Parameters
    ----------
    names : iterable of str
        Keys of `CASES`; all when empty (with `quick` those that are quick).
    quick : bool
        Coarser grids, fewer positions.
    tell : callable, optional
        Gets a line before each run.

    Yields
    ------
    dict or Chart
        A row as soon as it is known: ``case, quantity, value, unit, reference, difference`` (relative), ``band, ok``
        (None where it is not judged), ``source, seconds``; or a chart.
    """
    say = tell or (lambda text: None)
    chosen = list(names) or [name for name, (_, is_quick) in CASES.items() if is_quick or not quick]
    for name in chosen:
        begin = time.perf_counter()
        for item in CASES[name][0](quick, partial(_told, say, name)):
            if isinstance(item, Row):
                now = time.perf_counter()
                yield {"case": name, **item.to_dict(), "seconds": now - begin}
                begin = now
            else:
                yield item


def _told(say: Tell, name: str, text: str) -> None:
    say(f"{name}: {text}")
