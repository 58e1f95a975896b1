"""Write a study that was run as a page of the documentation: ``python docs/results_of_study.py FOLDER FILE IMAGES``.

The runs are measured, drawn and judged anew; nothing is run. Figures go to IMAGES as ``NAME_PART_FIGURE.png``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from rdpm.studies.collect import collect
from rdpm.studies.finish import finished
from rdpm.studies.folder import StudyFolder
from rdpm.studies.page import content, write_markdown


def main(folder: str, file: str, images: str) -> None:
    """Write the file and its images."""
    results = collect(StudyFolder(Path(folder)))
    judged, pictures = finished(results, print)
    write_markdown(content(results, judged, pictures), Path(file), Path(images), results.name)


if __name__ == "__main__":
    main(*sys.argv[1:])
