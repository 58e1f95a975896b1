"""``rdpm bench``: speed here against memory bandwidth."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import Parameter

from rdpm.errors import CaseError

__all__ = ["bench"]


def bench(
    *names: str,
    quick: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Measure the full coupled step, or dry contacts in a bed of spheres, and the memory bandwidth in one run.

    Parameters
    ----------
    names : str
        Cases to measure; those of the coupled step when left out. ``dry-bed``: 64,000 spheres, beside LAMMPS where it
        is installed, at equal sub-step and at equal error of the restitution, and beds up to a million spheres.
        ``ranks`` before cases: on two MPI ranks, and on one with all threads, in turns. Under ``mpiexec`` the ranks
        share each case.
    quick : bool
        Of ``dry-bed``: 8000 spheres, and nothing of larger beds.
    json : bool
        Print JSON.
    """
    from rdpm.cli.progress import say
    from rdpm.parallel.agreement import guarding
    from rdpm.parallel.launcher import single
    from rdpm.parallel.ranks import world
    from rdpm.studies.bench import CASES
    from rdpm.studies.bench import bench as run
    from rdpm.studies.dry_bed import BEDS

    is_of_ranks, names = names[:1] == ("ranks",), names[1:] if names[:1] == ("ranks",) else names
    for name in names:
        if name not in CASES and (name not in BEDS or is_of_ranks):
            known = [*CASES] if is_of_ranks else [*CASES, *BEDS, "ranks"]
            raise CaseError("bench", name, f"must be one of {', '.join(known)}")
    if quick and not set(names) & set(BEDS):
        raise CaseError("bench --quick", True, f"is of {', '.join(BEDS)} alone", cure="Name it, or leave --quick out.")
    if is_of_ranks or any(name in BEDS for name in names):
        single("rdpm bench " + ("ranks" if is_of_ranks else "dry-bed"))
    if is_of_ranks:
        from rdpm.studies.bench_ranks import bench_ranks

        _show({"ranks": bench_ranks(names, say)}, json)
        return
    ranks = world()
    with guarding(ranks):
        found = run(names, say if ranks.rank == 0 else None, ranks, quick)
    if ranks.rank == 0:
        _show(found, json)


def _show(found: dict[str, Any], is_json: bool) -> None:
    if is_json:
        import json as writer

        print(writer.dumps(found, indent=2))
    elif "cases" not in found:
        _print_ranks(found["ranks"])
    else:
        _print_all(found)


def _print_all(found: dict[str, Any]) -> None:
    print(
        f"triad {found['triad_GB_s']:.1f} GB/s on {found['threads']} threads, "
        f"{found['triad_one_thread_GB_s']:.1f} GB/s on one"
    )
    if found["cases"]:
        _print_cases(found["cases"])
    for bed in found["beds"]:
        _print_bed(bed)


def _print_ranks(cases: list[dict[str, Any]]) -> None:
    print(f"{'case':20} {'ranks x threads':>15} {'ns/cell':>8} {'messages':>9} {'sent':>9} {'in messages':>11}  speed")
    for case in cases:
        one, ranks = case["one"], case["ranks"]
        way = f"{one['ranks']} x {one['threads']}"
        print(f"{case['name']:20} {way:>15} {one['ns_per_cell_step']:>8.1f}")
        way = f"{ranks['ranks']} x {ranks['threads']}"
        share = ranks["message_ns_per_cell_step"] / ranks["ns_per_cell_step"]
        print(
            f"{'':20} {way:>15} {ranks['ns_per_cell_step']:>8.1f} {ranks['messages']:>9} "
            f"{1e-6 * ranks['sent_bytes']:>6.2f} MB {100.0 * share:>9.1f} %  {case['speed']:.2f} of one rank's"
            + ("" if ranks["sent_as_told"] else "; sent is not what rdpm check --ranks tells")
        )


def _print_bed(bed: dict[str, Any]) -> None:
    print(
        f"{bed['name']}; us of a body: wall time, processor time\n\nat equal sub-step\n{'program':8} {'bodies':>8} "
        f"{'cores':>5} {'sub-steps/contact':>17} {'a sub-step':>10} {'processor':>9}"
    )
    for row in bed["rows"]:
        print(f"{_begin(row)} {row['us']:>10.4f} {row['cpu_us']:>9.4f}")
    print(f"\nerror of the restitution\n{'program':8} {'sub-steps/contact':>17} {'worst':>8} {'rms':>8}")
    for row in bed["errors"]:
        print(f"{row['program']:8} {row['substeps_per_contact']:>17} {row['worst']:>8.1e} {row['rms']:>8.1e}")
    print(
        f"\nat equal error of the restitution\n{'program':8} {'bodies':>8} {'cores':>5} {'sub-steps/contact':>17} "
        f"{'a contact':>10} {'processor':>9}  error below"
    )
    for row in bed["equal_error"]:
        times = f"{row['us_per_contact_time']:>10.2f} {row['cpu_us_per_contact_time']:>9.2f}"
        print(f"{_begin(row)} {times}  {row['error']:g}")
    if not bed["growth"]:
        return
    print(
        f"\nwith the number of bodies\n{'program':8} {'bodies':>8} {'cores':>5} {'sub-steps/contact':>17} "
        f"{'a sub-step':>10} {'processor':>9} {'B/body':>7}"
    )
    for row in bed["growth"]:
        print(f"{_begin(row)} {row['us']:>10.4f} {row['cpu_us']:>9.4f} {row['bytes_per_body']:>7.0f}")


def _begin(row: dict[str, Any]) -> str:
    return f"{row['program']:8} {row['bodies']:>8} {row['threads']:>5} {row['substeps_per_contact']:>17}"


def _print_cases(cases: list[dict[str, Any]]) -> None:
    print(f"{'case':20} {'cells':>15} {'threads':>7} {'ns/cell':>8} {'B/cell':>7} {'memory':>7}  parts [ns/cell]")
    for case in cases:
        parts = ", ".join(f"{name} {ns:.1f}" for name, ns in case["parts"].items() if ns >= 0.05)
        marker = ""
        if "us_per_marker_pass" in case:
            marker = f"; us a marker: {case['us_per_marker_pass']:.3f} a pass, {case['us_per_marker_step']:.3f} a step"
        print(
            f"{case['name']:20} {'x'.join(map(str, case['cells'])):>15} {case['threads']:>7} "
            f"{case['ns_per_cell_step']:>8.1f} {case['bytes_per_cell_step']:>7.0f} "
            f"{case['memory_bytes_per_cell']:>7.0f}  {parts}{marker}"
        )
