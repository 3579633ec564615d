"""The runner of missions, tick by tick, without a board."""

from tests.runtime.missions.mission_rig import MissionRig
from tests.runtime.missions.water import HOLD, mission


def test_a_stop_between_two_ticks_ends_it_though_the_robot_is_armed_again() -> None:
    rig = MissionRig()
    rig.prepare(mission(HOLD))
    rig.tick(0.5)
    assert rig.last.phase == "running"
    rig.runner.change_mode("disarmed")
    rig.runner.change_mode("automatic")
    rig.tick()
    assert (rig.last.phase, rig.last.text) == ("ended", "The robot was stopped.")
    assert not rig.runner.active
    assert rig.stops == []
    rig.prepare(mission(HOLD))
    rig.tick()
    assert (rig.last.number, rig.last.phase) == (2, "running")
