"""What a run samples of the flow on slabs is what it samples of the whole box."""

import shutil

import numpy as np
import pytest

import rdpm
from builders import oil_case
from rdpm.results.run import Run
from rdpm.runs.runner import run_case
from thread_ranks import on_ranks

#: Of the largest value.
TOLERANCE = 1e-9

OUTPUT = {
    "report": False, "table_every": 4e-3, "fields_every": 8e-3, "fields_tolerance": 0, "checkpoint_every": 8e-3,
    "checkpoints_kept": 9,
    "points": [[0.03, 0.02, 0.0448], [0.0, 0.01, 0.01], [0.03, 0.03, 0.0899], [0.01, 0.03, 0.0001]],
    "lines": [{"start": [0.02, 0.03, 0.0], "end": [0.025, 0.03, 0.09], "count": 19}],
    "planes": [{"normal": "x", "position": 0.031}, {"normal": "z", "position": 0.045},
               {"normal": "z", "position": 0.0895}],
    "sample_every": 3e-3, "planes_every": 8e-3, "average_from": 2e-3, "average_every": 3e-3, "vorticity": True,
    "q_criterion": True,
}  # fmt: skip
BALL = [{"diameter": 0.015, "density": 4000.0, "centers": [[0.027, 0.034, 0.05]], "velocity": [0.1, -0.1, -0.3]}]
TUBE = {"shape": "cylinder", "point": [0.03, 0.03, 0.0], "axis": [0.0, 0.0, 1.0], "diameter": 0.052}
BOXES = {
    "walls": {"domain__boundary": {"x": "wall", "y": "wall", "z": "wall"}},
    "tube": {"domain__boundary": {"x": "wall", "y": "free-slip", "z": "periodic"}, "walls": [TUBE]},
}


def agree(found, expected, name: str) -> None:
    scale = np.nanmax(np.abs(expected), initial=1e-12)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=TOLERANCE * scale, err_msg=name)


def compared(found: Run, expected: Run) -> None:
    for name in ("points", "lines"):
        table, other = getattr(found, name), getattr(expected, name)
        for columns in (["u_m_s", "v_m_s", "w_m_s"], ["pressure_Pa"]):
            agree(table[columns].to_numpy(), other[columns].to_numpy(), name)
    pairs = [(found.averages, expected.averages), (found.fields, expected.fields)]
    for here, there in [*pairs, *zip(found.planes, expected.planes, strict=True)]:
        assert set(here) == set(there)
        for quantity in there:
            # Stored in single precision.
            values = there[quantity].to_numpy()
            np.testing.assert_allclose(
                here[quantity].to_numpy(), values, rtol=0.0, atol=2e-7 * np.abs(values).max(), err_msg=str(quantity)
            )


@pytest.mark.parametrize("box", BOXES.values(), ids=BOXES.keys())
def test_samples_on_slabs_are_those_of_the_whole_box_and_go_on_anywhere(box, tmp_path) -> None:
    made = oil_case(
        bodies=BALL, resolution__cells_per_diameter=4, time__end=0.024, time__step=1e-3, output=OUTPUT, **box
    )  # fmt: skip
    case = rdpm.load_case(made)

    def run(name: str, count: int, **how):
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        if count == 1:
            run_case(case, folder, threads=1, **how)
        else:
            on_ranks(count, lambda ranks: run_case(case, folder, threads=1, ranks=ranks, **how))
        return rdpm.results.open(folder)

    one, two = run("one", 1), run("two", 2)
    compared(two, one)
    for name, count in (("same", 2), ("three", 3), ("alone", 1)):
        shutil.copytree(tmp_path / "two", tmp_path / name)
        for last in sorted((tmp_path / name / "checkpoints").iterdir())[2:]:
            last.unlink()
        (tmp_path / name / "summary.json").unlink()
        compared(run(name, count, resume=True), one)
    for file in ("points.csv", "lines.csv", "averages.vtkhdf", "fields.vtkhdf"):
        assert (tmp_path / "same" / file).read_bytes() == (tmp_path / "two" / file).read_bytes(), file
