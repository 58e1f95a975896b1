"""Write a study that was run as a page of the documentation: ``python docs/results_of_study.py FOLDER FILE IMAGES``.

The runs are measured, drawn and judged anew; nothing is run. Figures go to IMAGES as ``NAME_PART_FIGURE.png``, without
PART in a study that includes no others.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from rdpm.studies.collect import collect
from rdpm.studies.finish import finished
from rdpm.studies.folder import StudyFolder
from rdpm.studies.page import Block, content, write_markdown


def main() -> None:
    """Write the file and its images."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="of the study")
    parser.add_argument("file", type=Path, help="the page")
    parser.add_argument("images", type=Path, help="the folder of its figures")
    parser.add_argument("--figures", nargs="+", help="names without their ending; all when left out")
    parser.add_argument("--note", default="", help="a sentence at the end, such as on the machine and the time it took")
    given = parser.parse_args()
    results = collect(StudyFolder(given.folder))
    judged, pictures = finished(results, print)
    if given.figures:
        pictures = {
            part: [one for one in made if one.path.stem in given.figures or one.path.suffix == ".mp4"]
            for part, made in pictures.items()
        }
    blocks = content(results, judged, pictures)
    if given.note:
        blocks.append(Block("text", given.note))
    write_markdown(blocks, given.file, given.images, results.name)


if __name__ == "__main__":
    main()
