"""Charts as plain options for the browser: axes with units, lines told apart by colour and dash, zoom."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from rdpm.figures.style import PALETTE

__all__ = ["chart_of", "line", "mark", "points", "thinned"]

_DASHES: tuple[Any, ...] = ("solid", [8, 4], [2, 3], [8, 3, 2, 3], [14, 4], [4, 2])
_SYMBOLS = ("circle", "rect", "triangle", "diamond", "pin", "arrow")
_DIAMOND = "path://M1,0L2,1L1,2L0,1Z"  # that a legend does not stretch
_GREY = "#5f5f64"
_TITLE = {"fontSize": 14, "fontWeight": 600, "color": "#1d1d1f"}


def chart_of(
    title: str,
    x: str,
    y: str,
    series: Iterable[dict[str, Any]],
    log: str = "",
    x_range: Sequence[float] = (),
    y_range: Sequence[float] = (),
    is_equal: bool = False,
) -> dict[str, Any]:
    """Put lines into a chart.

    Parameters
    ----------
    title, x, y : str
        Of the chart and its axes, with units.
    series : iterable of dict
        From `line`, `points` and `mark`.
    log : str
        "x", "y" or "xy": logarithmic axes.
    x_range, y_range : sequence of float, (2,)
        Ends of an axis; chosen from the data when left out.
    is_equal : bool
        Both axes begin and end at round numbers of their own data, zero not included.

    Examples
    --------
    >>> chart_of("Gap", "time [s]", "gap [mm]", [line("a", [0, 1], [1, 2])])["xAxis"]["name"]
    'time [s]'
    """
    drawn = list(series)
    return {
        "animation": False,
        "aria": {"enabled": True, "label": {"description": f"{title}: {y} over {x}."}},
        "title": {"text": title, "left": 4, "top": 0, "textStyle": _TITLE},
        "legend": {
            "type": "scroll", "top": 24, "left": 0, "right": 10, "itemGap": 10, "itemWidth": 28,
            "textStyle": {"color": "#333333"}, "pageTextStyle": {"color": _GREY}, "data": _names(drawn),
        },
        "grid": {"left": 6, "right": 18, "top": 56, "bottom": 6, "outerBoundsMode": "same",
                 "outerBoundsContain": "all"},
        "toolbox": {
            "right": 0, "top": 0, "itemSize": 13, "padding": 1, "showTitle": False, "iconStyle": {"borderColor": _GREY},
            "feature": {"dataZoom": {"title": {"zoom": "zoom", "back": "back"}}, "restore": {"title": "whole"},
                        "saveAsImage": {"title": "save as picture", "name": title}},
        },
        "tooltip": {"trigger": "axis", "confine": True},
        "dataZoom": [{"type": "inside", "filterMode": "none", "zoomOnMouseWheel": "ctrl"}],
        "xAxis": _axis(x, "x" in log, x_range, 28, is_equal),
        "yAxis": _axis(y, "y" in log, y_range, 46, is_equal),
        "series": drawn,
    }  # fmt: skip


def _axis(name: str, is_log: bool, ends: Sequence[float], gap: int, is_scaled: bool) -> dict[str, Any]:
    axis: dict[str, Any] = {
        "type": "log" if is_log else "value", "name": name, "nameLocation": "middle", "nameGap": gap,
        "nameTextStyle": {"color": "#333333"}, "axisLabel": {"color": "#333333", "hideOverlap": True},
        "axisLine": {"show": True, "onZero": False, "lineStyle": {"color": _GREY}},
        "splitLine": {"lineStyle": {"color": "#e3e3e3"}}, "scale": is_scaled or gap == 28,
    }  # fmt: skip
    return axis | ({"min": ends[0], "max": ends[1]} if ends else {})


def _names(series: list[dict[str, Any]]) -> list[str]:
    return list(dict.fromkeys(one["name"] for one in series if one["name"]))


def line(name: str, x: Iterable[float], y: Iterable[float], number: int = 0, **style: Any) -> dict[str, Any]:
    """A curve; what is not finite is a hole in it."""
    look = {"color": PALETTE[number % len(PALETTE)], "width": 2, "type": _DASHES[number % len(_DASHES)], **style}
    data = [[_plain(a), _plain(b)] for a, b in zip(x, y, strict=True)]
    return {"type": "line", "name": name, "data": data, "showSymbol": len(data) == 1, "lineStyle": look,
            "itemStyle": {"color": look["color"]}, "symbol": "circle"}  # fmt: skip


def points(
    name: str, x: Iterable[float], y: Iterable[float], number: int = 0, is_hollow: bool = False
) -> dict[str, Any]:
    """Single points."""
    data = [[_plain(a), _plain(b)] for a, b in zip(x, y, strict=True)]
    symbol = _SYMBOLS[number % len(_SYMBOLS)]
    symbol = f"empty{symbol.capitalize()}" if is_hollow else symbol
    return {"type": "scatter", "name": name, "data": data, "symbol": symbol, "symbolSize": 9,
            "itemStyle": {"color": PALETTE[number % len(PALETTE)], "opacity": 0.8}}  # fmt: skip


def mark(x: float | None, y: float | None, name: str = "this design") -> dict[str, Any]:
    """The point of the user; none where a coordinate is not known."""
    known = x is not None and y is not None and math.isfinite(x) and math.isfinite(y)
    return {"type": "scatter", "name": name, "data": [[x, y]] if known else [], "symbol": _DIAMOND, "symbolSize": 17,
            "symbolKeepAspect": True, "z": 5,
            "itemStyle": {"color": "#F0E442", "borderColor": "#262626", "borderWidth": 2}}  # fmt: skip


def thinned(count: int, most: int = 3000) -> slice:
    """Every how many of so many points are drawn.

    Examples
    --------
    >>> thinned(10), thinned(10, 5)
    (slice(None, None, 1), slice(None, None, 2))
    """
    return slice(None, None, max(1, math.ceil(count / most)))


def _plain(value: float) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None
