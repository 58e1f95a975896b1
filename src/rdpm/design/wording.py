"""Quantities as a reader says them: three digits and the prefix that keeps the number short."""

from __future__ import annotations

__all__ = ["percent_text", "said", "speed_text", "time_text"]

_TIMES = ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns"))
_SPEEDS = ((1.0, "m/s"), (1e-2, "cm/s"), (1e-3, "mm/s"), (1e-6, "um/s"))


def _scaled(value: float, units: tuple[tuple[float, str], ...]) -> str:
    size, unit = next((u for u in units if abs(value) >= u[0] * (1.0 - 1e-9)), units[-1] if value else units[0])
    return f"{value / size:.3g} {unit}"


def time_text(seconds: float) -> str:
    """Say a time [s].

    Examples
    --------
    >>> time_text(7.63e-4), time_text(2.5)
    ('763 us', '2.5 s')
    """
    return _scaled(seconds, _TIMES)


def speed_text(speed: float) -> str:
    """Say a speed [m/s].

    Examples
    --------
    >>> speed_text(0.041), speed_text(0.58), speed_text(2.0)
    ('4.1 cm/s', '58 cm/s', '2 m/s')
    """
    return _scaled(speed, _SPEEDS)


def percent_text(fraction: float) -> str:
    """Say a fraction of a diameter.

    Examples
    --------
    >>> percent_text(0.0131), percent_text(0.005)
    ('1.31 % d', '0.5 % d')
    """
    return f"{100.0 * fraction:.3g} % d"


def said(severity: str, text: str) -> str:
    """Say a verdict as every table, page and terminal does.

    Examples
    --------
    >>> said("fail", "contact resolved by 3 steps < 4")
    'FAIL contact resolved by 3 steps < 4'
    """
    return {"ok": "ok   ", "note": "note: ", "fail": "FAIL "}[severity] + text
