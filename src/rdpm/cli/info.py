"""``rdpm info``: versions, threads, SIMD, MPI."""

from __future__ import annotations

import importlib
import importlib.util
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from rdpm.parallel.launcher import launched_rank

__all__ = ["info"]

_PACKAGES = ("numpy", "scipy", "pydantic", "h5py", "matplotlib", "pyvista")


def info() -> None:
    """Show versions, threads, SIMD and MPI: what a report of a problem should name.

    Examples
    --------
    >>> info()   # doctest: +ELLIPSIS
    rdpm        0...
    Python      ...
    """
    import rdpm

    rows = {
        "rdpm": rdpm.__version__,
        "Python": f"{platform.python_version()}, {platform.system()} {platform.machine()}",
        **_kernels(),
        "threads": _threads(),
        "MPI": _mpi(),
        "packages": ", ".join(f"{name} {_version(name)}" for name in _PACKAGES),
    }
    if launched_rank() > 0:
        return
    for name, value in rows.items():
        print(f"{name:11} {value}")


def _mpi() -> str:
    """Which MPI there is, and how many ranks a launcher started."""
    if not importlib.util.find_spec("mpi4py"):
        return "mpi4py is not installed"
    from rdpm.parallel.ranks import world

    ranks = world()
    if ranks.size == 1:
        return f"mpi4py {_version('mpi4py')}, one process"
    from mpi4py import MPI

    library = MPI.Get_library_version().split("\n")[0].strip("\0 ")
    shared = f"{ranks.sharers} of them share the processors here"
    return f"mpi4py {_version('mpi4py')}, {library}; {ranks.size} ranks, {shared}"


def _kernels() -> dict[str, str]:
    """How the compiled part was built, as it tells."""
    try:
        core = importlib.import_module("rdpm._core")
    except ImportError as error:
        return {"kernels": f"cannot be loaded: {error}"}
    build = {name: str(value) for name, value in core.build_info().items()}
    others = Path(str(core.__file__)).parent.parent
    built = sorted(folder.name for folder in others.iterdir()) if others.name == "levels" else []
    level = build.pop("level") + (f", chosen of {', '.join(built)}" if built else "")
    return {**build, "simd": f"{build['simd']} (built for {level})"}


def _threads() -> str:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    given = os.environ.get("OMP_NUM_THREADS")
    waiting = os.environ.get("OMP_WAIT_POLICY", "the default")
    return f"{given or cores} ({cores} cores here, OMP_NUM_THREADS {given or 'not set'}, waiting {waiting})"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"
