"""Drag of simple-cubic arrays against the depth of the markers: what `RETRACTION` was fitted on.

Run as ``python benchmarks/retraction.py``; a minute on two cores.
"""

from __future__ import annotations

from rdpm.particles.markers import MarkerSet
from rdpm.studies.validation.simple_cubic import ARRAYS, drag_factor

DEPTHS = (0.30, 0.33, 0.36)


def main() -> None:
    """Print one row a solid fraction."""
    print("solid fraction  " + "".join(f"{depth:>10.2f}" for depth in DEPTHS))
    for fraction, (reference, cells, _) in ARRAYS.items():
        excess = []
        for depth in DEPTHS:
            MarkerSet.__init__.__defaults__ = (depth,)
            excess.append(100.0 * (drag_factor(fraction, cells) / reference - 1.0))
        print(f"{fraction:14.3f}  " + "".join(f"{e:+9.2f}%" for e in excess), flush=True)


if __name__ == "__main__":
    main()
