"""Memory bandwidth of this machine, the measure that speeds are quoted in."""

from __future__ import annotations

from pathlib import Path

from rdpm import _core

__all__ = ["last_level_cache", "triad_bandwidth"]


def last_level_cache() -> int:
    """Size of the largest cache [bytes]; 32 MiB where the system does not tell.

    Examples
    --------
    >>> last_level_cache() > 0
    True
    """
    units = {"K": 1024, "M": 1024**2, "G": 1024**3}
    sizes = []
    for path in Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size"):
        text = path.read_text().strip()
        sizes.append(int(text[:-1]) * units[text[-1]] if text[-1] in units else int(text))
    return max(sizes, default=32 * 1024**2)


def triad_bandwidth(threads: int, sweeps: int = 10) -> float:
    """Bandwidth of a = b + s c with arrays of four times the last-level cache each.

    Parameters
    ----------
    threads, sweeps : int
        >= 1; the fastest sweep counts.

    Returns
    -------
    float, [bytes/s]
        At 24 bytes an element, the write-allocate not counted [1]_.

    References
    ----------
    .. [1] McCalpin, STREAM: sustainable memory bandwidth in high performance computers (1995).
    """
    elements = 4 * last_level_cache() // 8
    return 24.0 * elements / float(_core.triad_seconds(elements, threads, sweeps))
