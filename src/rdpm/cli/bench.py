"""``rdpm bench``: speed here against memory bandwidth."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from rdpm.errors import CaseError

__all__ = ["bench"]


def bench(*names: str, json: Annotated[bool, Parameter(negative="")] = False) -> None:
    """Measure the full coupled step and the memory bandwidth in one run.

    Parameters
    ----------
    names : str
        Cases to measure; all when left out.
    json : bool
        Print JSON.
    """
    from rdpm.parallel.ranks import single

    single("rdpm bench")
    from rdpm.cli.progress import say
    from rdpm.studies.bench import CASES
    from rdpm.studies.bench import bench as run

    for name in names:
        if name not in CASES:
            raise CaseError("bench", name, f"must be one of {', '.join(CASES)}")
    found = run(names, say)
    if json:
        import json as writer

        print(writer.dumps(found, indent=2))
        return
    print(
        f"triad {found['triad_GB_s']:.1f} GB/s on {found['threads']} threads, "
        f"{found['triad_one_thread_GB_s']:.1f} GB/s on one"
    )
    print(f"{'case':20} {'cells':>15} {'threads':>7} {'ns/cell':>8} {'B/cell':>7} {'memory':>7}  parts [ns/cell]")
    for case in found["cases"]:
        parts = ", ".join(f"{name} {ns:.1f}" for name, ns in case["parts"].items() if ns >= 0.05)
        marker = ""
        if "us_per_marker_pass" in case:
            marker = f"; us a marker: {case['us_per_marker_pass']:.3f} a pass, {case['us_per_marker_step']:.3f} a step"
        print(
            f"{case['name']:20} {'x'.join(map(str, case['cells'])):>15} {case['threads']:>7} "
            f"{case['ns_per_cell_step']:>8.1f} {case['bytes_per_cell_step']:>7.0f} "
            f"{case['memory_bytes_per_cell']:>7.0f}  {parts}{marker}"
        )
