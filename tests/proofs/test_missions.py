"""A short version of `make missions`."""

import pytest

from robot_runtime.errors import RefusedError
from robot_runtime.missions.leaf import NODES, Leaf
from tests.board.rig import ROOT, build
from tests.proofs.missions import CALM, HEARTBEAT, LEAVES, NAMES, TICKS, MissionSwim, perform
from tests.runtime.missions.water import DIVE, HOLD, mission

PAIRS = [
    (leaf, cause)
    for row, leaf in enumerate(LEAVES)
    for column, cause in enumerate(NAMES)
    if (row + column) % 4 == 0
]
"""Two causes for each leaf, and two leaves at least for each cause."""


@pytest.fixture(scope="module", autouse=True)
def _built() -> None:
    build(ROOT / "firmware", "host")


def test_the_proof_knows_every_leaf() -> None:
    assert {do for do, cls in NODES.items() if issubclass(cls, Leaf)} == LEAVES.keys()
    assert {leaf for leaf, _ in PAIRS} == LEAVES.keys()
    assert {cause for _, cause in PAIRS} == {*NAMES}


@pytest.mark.parametrize(("leaf", "cause"), PAIRS, ids=["-".join(pair) for pair in PAIRS])
def test_a_leaf_that_is_ended_leaves_nothing_behind(leaf: str, cause: str) -> None:
    assert perform(leaf, cause) == []


def test_without_the_server_it_goes_on_for_its_own_time() -> None:
    text = mission("{ do = 'hold', seconds = 60, within = 9 }").replace("alone = 0", "alone = 15")
    with MissionSwim() as swim:
        swim.begin(text)
        swim.until(lambda: swim.status("1") == "running", CALM)
        swim.server = False
        swim.run(2 * HEARTBEAT)
        assert swim.mission.phase == "running"
        assert swim.until(lambda: not swim.robot.missions.active, 15.0) == pytest.approx(
            15 - 2 * HEARTBEAT, abs=0.3
        )
        assert "stopped for a fault" in swim.mission.text


def test_a_stop_before_its_first_tick_ends_it_for_good() -> None:
    with MissionSwim() as swim:
        swim.begin(mission(DIVE, HOLD))
        assert not swim.missions
        swim.command("stop")
        swim.run(TICKS)
        assert (swim.mission.phase, swim.mission.text) == ("ended", "The robot was stopped.")
        count = len(swim.missions)
        swim.arm()
        swim.run(1.0)
        assert swim.supervisor.armed
        assert len(swim.missions) == count
        swim.command("set_points", default=0.7)


def test_a_take_over_before_its_first_tick_pauses_it() -> None:
    with MissionSwim() as swim:
        swim.begin(mission(DIVE, HOLD))
        swim.sticks = [0.0] * 6
        swim.command("mode", mode="manual")
        swim.run(TICKS)
        assert (swim.mission.phase, swim.mission.elapsed) == ("paused", 0.0)


def test_it_does_not_swim_on_an_arming_of_somebody_elses() -> None:
    with MissionSwim() as swim:
        own = swim.supervisor.begin_arming("automatic", 600.0)
        with pytest.raises(RefusedError, match="is already being armed for automatic"):
            swim.begin(mission(DIVE, HOLD))
        while not own.over:
            swim.run(0.1)
            swim.supervisor.continue_arming()
        swim.run(1.0)
        assert swim.supervisor.mode == "automatic"
        assert not swim.missions
