"""Instruction sets of x86-64 processors: which build of the kernels a wheel with several of them loads."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from rdpm.errors import CaseError

__all__ = ["choose_level", "kernel_folder", "processor_flags"]

#: What each level asks beyond the one before it, by the names of ``/proc/cpuinfo`` (x86-64 psABI, table 3.1).
ASKED = {
    "x86-64": frozenset[str](),
    "x86-64-v2": frozenset({"cx16", "lahf_lm", "popcnt", "pni", "sse4_1", "sse4_2", "ssse3"}),
    "x86-64-v3": frozenset({"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe", "xsave"}),
    "x86-64-v4": frozenset({"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}),
}

#: The environment variable that asks for one level.
VARIABLE = "RDPM_SIMD"


def processor_flags(cpuinfo: Path = Path("/proc/cpuinfo")) -> frozenset[str]:
    """Features of the processor that the system lets programs use.

    Parameters
    ----------
    cpuinfo : Path
        Where Linux lists them.

    Returns
    -------
    frozenset of str
        Empty where the system has no such list: the lowest level is taken there.

    Examples
    --------
    >>> processor_flags(Path("no such file"))
    frozenset()
    """
    try:
        lines = cpuinfo.read_text(errors="replace").splitlines()
    except OSError:
        return frozenset()
    return next((frozenset(line.partition(":")[2].split()) for line in lines if line.startswith("flags")), frozenset())


def choose_level(built: Collection[str], flags: Collection[str], wanted: str = "") -> str:
    """Highest level that was built and that the processor has, or the one wanted.

    Parameters
    ----------
    built : collection of str
        Levels in the package, names of `ASKED`.
    flags : collection of str
        Features of the processor.
    wanted : str
        Level the user wants; empty: the highest.

    Returns
    -------
    str

    Raises
    ------
    CaseError
        The level wanted is not in the package, or the processor has none of its levels.

    Examples
    --------
    >>> every = {flag for flags in ASKED.values() for flag in flags}
    >>> choose_level(["x86-64", "x86-64-v3"], every)
    'x86-64-v3'
    >>> choose_level(["x86-64", "x86-64-v3"], [])
    'x86-64'
    """
    had: list[str] = []
    for level, features in ASKED.items():
        if not features <= set(flags):
            break
        had.append(level)
    usable = [level for level in had if level in built]
    here = ", ".join(usable) or "none"
    if wanted and wanted not in usable:
        rule = f"must be one of {here}"
        why = "the processor lacks it" if wanted in built else "this package was not built for it"
        raise CaseError(VARIABLE, wanted, rule, why, "Unset it to have the highest.")
    if not usable:
        rule, why = f"has kernels for {', '.join(built)} only", "the processor has none of these"
        raise CaseError("rdpm", None, rule, why, "Build it on this machine: pip install . in its sources.")
    return wanted or usable[-1]


def kernel_folder(package: Path) -> Path | None:
    """Folder of the kernels to load, where the package has several.

    Parameters
    ----------
    package : Path
        Folder of the installed package.

    Returns
    -------
    Path or None
        None: there is one build, beside the Python files.

    Raises
    ------
    CaseError
        ``RDPM_SIMD`` asks for a level that cannot be had.

    Examples
    --------
    >>> import tempfile
    >>> kernel_folder(Path(tempfile.mkdtemp())) is None
    True
    """
    folder, wanted = package / "levels", os.environ.get(VARIABLE, "")
    if not folder.is_dir():
        if wanted:
            rule = "cannot be chosen here"
            raise CaseError(VARIABLE, wanted, rule, "the kernels were built once, for one processor", "Unset it.")
        return None
    built = [level for level in ASKED if (folder / level).is_dir()]
    return folder / choose_level(built, processor_flags(), wanted)
