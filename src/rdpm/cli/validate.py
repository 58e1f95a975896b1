"""``rdpm validate``: published cases against this build."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from rdpm.errors import CaseError

__all__ = ["validate"]

OUTSIDE = 1  # exit code


def validate(
    *names: str,
    quick: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
    markdown: Annotated[bool, Parameter(negative="")] = False,
    figures: Path | None = None,
) -> int:
    """Run published cases against this build, as a table.

    Parameters
    ----------
    names : str
        Cases to run; all when left out.
    quick : bool
        Coarser grids and fewer cases: some minutes on two cores.
    json : bool
        Print JSON.
    markdown : bool
        Print the table as it stands in the documentation.
    figures : Path, optional
        Draw the curves into this folder.

    Returns
    -------
    int
        0, or 1 when a case is outside its band.
    """
    import rdpm
    from rdpm.parallel.launcher import single

    single("rdpm validate")
    from rdpm.cli.progress import say
    from rdpm.parallel.threads import available_threads
    from rdpm.studies.validation import CASES, Chart
    from rdpm.studies.validation import validate as run

    for name in names:
        if name not in CASES:
            raise CaseError("validate", name, f"must be one of {', '.join(CASES)}", cure="Correct the name.")
    if figures is not None:
        from rdpm.figures.validation import draw
    rows: list[dict[str, Any]] = []
    if not json:
        print(_MARKDOWN_HEAD if markdown else _HEAD)
    for item in run(names, quick, say):
        if isinstance(item, Chart):
            if figures is not None:
                draw(item, figures)
            continue
        rows.append(item)
        if not json:
            print(_markdown_line(item) if markdown else _line(item), flush=True)
    outside = [row for row in rows if row["ok"] is False]
    if json:
        import json as writer

        machine = {"rdpm_version": rdpm.__version__, "quick": quick, "threads": available_threads(), "rows": rows}
        print(writer.dumps(machine, indent=2))
    elif not markdown:
        judged = sum(row["ok"] is not None for row in rows)
        print(f"{judged - len(outside)} of {judged} within their bands")
    return OUTSIDE if outside else 0


_HEAD = (
    f"{'case':16} {'quantity':68} {'value':>10} {'reference':>10} {'diff %':>7} {'band %':>7} {'ok':>3} {'s':>6}"
    "  source"
)


_MARKDOWN_HEAD = "| case | quantity | value | reference | difference | band | ok |\n|---|---|---|---|---|---|---|"


def _cells(row: dict[str, Any], percent: str, bound: str) -> list[str]:
    """Quantity, value, reference, difference, band and verdict of a row, as they are printed."""
    difference, band = row["difference"], row["band"]
    # Where the value itself is bounded, the band is not relative to anything.
    is_bound = row["reference"] is None and band is not None
    shown_band = "" if band is None else f"{bound}{band:.4g}" if is_bound else f"{100.0 * band:.2f}{percent}"
    sign = "+" if percent else ""
    return [
        row["quantity"] + (f" [{row['unit']}]" if row["unit"] else ""),
        "nan" if row["value"] is None else f"{row['value']:.4g}",
        "" if row["reference"] is None else f"{row['reference']:.4g}",
        "" if difference is None else f"{100.0 * difference:{sign}.2f}{percent}",
        shown_band,
        {True: "yes", False: "NO", None: "-"}[row["ok"]],
    ]


def _markdown_line(row: dict[str, Any]) -> str:
    return f"| {row['case']} | " + " | ".join(_cells(row, " %", "at most ")) + " |"


def _line(row: dict[str, Any]) -> str:
    quantity, value, reference, difference, band, ok = _cells(row, "", "<")
    return (
        f"{row['case']:16} {quantity:68} {value:>10} {reference:>10} {difference:>7} {band:>7} {ok:>3} "
        f"{row['seconds']:>6.1f}  {row['source']}"
    )
