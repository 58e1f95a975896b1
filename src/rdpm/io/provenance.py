"""Where numbers come from: machine, versions, memory; and JSON that any program reads."""

from __future__ import annotations

import json
import math
import platform
import sys
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import rdpm
from rdpm import _core
from rdpm.errors import CaseError
from rdpm.io.files import replacing

__all__ = ["environment", "peak_memory_bytes", "read_json", "write_json"]


def environment() -> dict[str, Any]:
    """What a result depends on besides its case.

    Returns
    -------
    dict
        ``rdpm_version``, ``simd`` (of the kernels), ``python``, ``numpy``, ``platform``, ``cpu``, ``date_utc`` (ISO
        8601).

    Examples
    --------
    >>> sorted(environment())
    ['cpu', 'date_utc', 'numpy', 'platform', 'python', 'rdpm_version', 'simd']
    """
    return {
        "rdpm_version": rdpm.__version__,
        "simd": _core.build_info()["simd"],
        "python": platform.python_version(),
        "numpy": np.__version__,
        "platform": platform.platform(),
        "cpu": _cpu(),
        "date_utc": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, "") or platform.processor() or platform.machine()


def peak_memory_bytes() -> int:
    """Largest memory this process held so far, in bytes; 0 where the system does not say.

    Examples
    --------
    >>> peak_memory_bytes() > 1_000_000
    True
    """
    with suppress(OSError, ValueError, IndexError):
        # Of this program alone; getrusage begins with what the program that started this one held.
        for line in Path("/proc/self/status").read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * int(line.split()[1])
    try:
        import resource
    except ImportError:
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(peak) if sys.platform == "darwin" else int(peak) * 1024


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, Path) else value


def write_json(path: str | Path, content: dict[str, Any]) -> None:
    """Write a dict as JSON, whole or not at all; what is not finite becomes null.

    Parameters
    ----------
    path : path
        The file, replaced if it exists.
    content : dict
        Numbers, texts, lists, dicts, paths, NumPy scalars and arrays.

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "summary.json"
    >>> write_json(path, {"cells": np.array([4, 8]), "gap_m": float("nan")})
    >>> read_json(path)
    {'cells': [4, 8], 'gap_m': None}
    """
    text = json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False)
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


def read_json(path: str | Path) -> dict[str, Any]:
    """Read what `write_json` wrote.

    Raises
    ------
    CaseError
        The file is missing, or is not a JSON object.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise CaseError(str(path), None, "must be a readable JSON file", str(error)) from error
    if not isinstance(content, dict):
        raise CaseError(str(path), None, "must be a JSON object", f"found a {type(content).__name__}")
    return content
