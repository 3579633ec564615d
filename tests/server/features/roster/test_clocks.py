"""Measuring the clocks of a lab's robots."""

from pathlib import Path
from typing import cast

from robot_runtime.clock import SimulatedClock
from robot_runtime.errors import NoAnswerError
from server.features.roster.fleet_session import FleetSession
from server.features.roster.roster import CLOCK_SECONDS, Roster
from server.features.roster.router_process import RouterProcess
from server.interchange.presence import Presence
from server.platform.notices import Notices
from server.platform.paired_robots import PairedRobot, PairedRobots
from server.platform.settings import DataFolder, Settings, make_folders

PRESENCE = Presence(
    mode="disarmed",
    armed=False,
    connected=True,
    depth=0.0,
    battery=8.1,
    battery_left=None,
    mission=None,
    recording=None,
    disk_free=1,
    disk_total=2,
    alarms=[],
    software="0.3.0",
    address="",
    fingerprint="",
)


class SlowSession:
    """A session that at first does not reach the robot, whose presence is heard already."""

    def __init__(self) -> None:
        self.asked = 0

    def measure_clock(self, robot: str) -> float:
        self.asked += 1
        if self.asked == 1:
            raise NoAnswerError(robot)
        return 0.25


async def test_a_clock_that_is_not_known_is_measured_again_soon(tmp_path: Path) -> None:
    folder = DataFolder(tmp_path)
    make_folders(folder)
    settings = Settings(data=folder, config=tmp_path / "robot.toml")
    clock, robots, session = SimulatedClock(), PairedRobots(folder), SlowSession()
    robots.add(PairedRobot(name="turtle", address="", fingerprint="", token="", joined=0.0))
    roster = Roster(settings, clock, robots, RouterProcess(settings), Notices(clock, lambda _: None))
    roster._session = cast(FleetSession, session)

    async def pass_seconds(seconds: float) -> float | None:
        clock.forward(seconds)
        roster.see("turtle", PRESENCE.model_dump_json().encode())
        await roster.measure_due_clocks()
        (robot,) = roster.listed().robots
        return robot.clock_offset

    assert await pass_seconds(0) is None
    assert await pass_seconds(1) == 0.25
    assert await pass_seconds(CLOCK_SECONDS - 1) == 0.25
    assert session.asked == 2
    await pass_seconds(1)
    assert session.asked == 3
