"""Drag of simple-cubic arrays against the depth of the markers: what `Calibration.marker_retraction` was fitted on.

Run as ``python benchmarks/retraction.py``; a minute on two cores.
"""

from __future__ import annotations

from dataclasses import replace

from rdpm.particles.calibration import CALIBRATION
from rdpm.studies.validation.simple_cubic import ARRAYS, drag_factor

DEPTHS = (0.30, 0.33, 0.36)


def main() -> None:
    """Print one row a solid fraction."""
    print("solid fraction  " + "".join(f"{depth:>10.2f}" for depth in DEPTHS))
    for fraction, (reference, cells, _) in ARRAYS.items():
        excess = []
        for depth in DEPTHS:
            factor = drag_factor(fraction, cells, calibration=replace(CALIBRATION, marker_retraction=depth))
            excess.append(100.0 * (factor / reference - 1.0))
        print(f"{fraction:14.3f}  " + "".join(f"{e:+9.2f}%" for e in excess), flush=True)


if __name__ == "__main__":
    main()
