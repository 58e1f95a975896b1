"""Final speed of the bead at Re 41, and the time to 95 % of it, in columns of several widths and on several grids.

What the case ``mordant-pinton`` of ``rdpm validate`` depends on. Run as ``python benchmarks/bead_column.py``; a
quarter of an hour on two cores, less for some of the widths::

    python benchmarks/bead_column.py 8 12    # columns of 8 and 12 diameters
"""

from __future__ import annotations

import sys

from rdpm.studies.validation.mordant_pinton import fall
from rdpm.studies.validation.points import crossing

#: Cells a diameter at which a column of so many diameters is run.
GRIDS = {8: (8, 12, 16), 12: (8, 12), 16: (8, 12)}


def main() -> None:
    """Print one line a run."""
    print(f"{'width [d]':>9} {'cells/d':>8} {'speed / sqrt(g d)':>18} {'t95 / sqrt(d/g)':>16}")
    for width in [int(word) for word in sys.argv[1:]] or GRIDS:
        for across in GRIDS[width]:
            t, u = fall(across, width)
            t95 = crossing(t, u, 0.95 * u[-1])
            print(f"{width:>9} {across:>8} {u[-1]:>18.4f} {t95:>16.3f}", flush=True)


if __name__ == "__main__":
    main()
