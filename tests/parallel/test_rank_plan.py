"""What `rdpm check --ranks` tells is what ranks then do."""

import json

import pytest

import rdpm
from builders import oil_case
from rdpm.cli.main import main
from rdpm.errors import CaseError
from rdpm.setup import plan
from rdpm.setup.rank_plan import plan_ranks
from thread_ranks import on_ranks

ACROSS = {"diameter": 0.015, "density": 1120.0, "centers": [[0.03, 0.03, 0.045], [0.03, 0.03, 0.024]],
          "velocity": [0.0, 0.0, -0.1]}  # fmt: skip
PERIODIC = {"x": "wall", "y": "periodic", "z": "periodic"}
CASES = {
    "explicit": dict(time__diffusion="explicit"),
    "stabilised, periodic": dict(time__diffusion="stabilised", time__step=4e-3, domain__boundary=PERIODIC),
    "tube": dict(
        domain__boundary=PERIODIC,
        walls=[{"shape": "cylinder", "point": [0.03, 0.03, 0.0], "axis": [0.0, 0.0, 1.0], "diameter": 0.052}],
    ),
    "no bodies": dict(bodies=[], contact=None, time__diffusion="explicit", resolution={"cells": [24, 24, 36]}),
}


def told_to_send(case, count: int):

    def sent(ranks):
        sim = rdpm.Simulation(case, threads=1, ranks=ranks)
        sim.advance()
        before = ranks.messages, ranks.sent_bytes
        sim.advance()
        return sim.fluid.grid.slab.planes, ranks.messages - before[0], ranks.sent_bytes - before[1]

    told = plan_ranks(plan(case), count)
    found = [(share.planes, share.sent.messages, share.sent.sent_bytes) for share in told.shares]
    return found, on_ranks(count, sent), told


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("changes", CASES.values(), ids=CASES.keys())
def test_ranks_send_what_was_told(changes, count: int) -> None:
    told, found, whole = told_to_send(rdpm.load_case(oil_case(**{"bodies": [ACROSS], **changes})), count)
    assert told == found
    if changes.get("bodies") is None:
        assert all(share.bodies for share in whole.shares)
        assert sum(share.bodies for share in whole.shares) > 2  # one lies across an interface
    assert 0.0 < whole.efficiency < 1.0


def test_ranks_send_what_was_told_in_a_stream() -> None:
    told, found, _ = told_to_send(rdpm.load_case("stream", {"resolution.cells_per_diameter": 4}), 2)
    assert told == found


def test_check_tells_what_each_rank_has(capsys) -> None:
    assert main(["check", "stream", "--ranks", "2", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    shares = told["on_ranks"]["shares"]
    assert sum(share["planes"] for share in shares) == told["cells"][2]
    assert all(share["memory_bytes"] < told["memory_bytes"] + 1e8 for share in shares)
    assert main(["check", "stream", "--ranks", "2"]) == 0
    text = capsys.readouterr().out
    for said in ("2 MPI ranks", "sent a rank, step", "efficiency"):
        assert said in text


def test_too_many_ranks_and_dry_cases_are_refused() -> None:
    with pytest.raises(CaseError, match="9 MPI ranks: must be at most 4"):
        plan_ranks(plan(rdpm.load_case(oil_case())), 9)
    ball = ACROSS | {"centers": [[0.05] * 3]}
    dry = {"domain": {"size": [0.1] * 3}, "bodies": [ball], "time": {"end": 0.1, "step": 1e-4}}
    with pytest.raises(CaseError, match=r"--ranks = 2: must share a flow \(a dry case"):
        plan_ranks(plan(rdpm.load_case(dry)), 2)
