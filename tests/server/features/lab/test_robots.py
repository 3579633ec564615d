"""The robots that a lab pulls from, on SQLite and on PostgreSQL."""

import pytest

from server.features.lab import robots as robots_module
from server.features.lab.robots import LabRobots, RobotKnownError
from server.features.lab.schemas import NewLabRobot
from server.platform.paired_robots import TooManyRobotsError
from server.platform.store import Store

BOTH_DATABASES = True


def turtle(number: int) -> NewLabRobot:
    return NewLabRobot(name=f"turtle-{number}", url="http://turtle.local:8000", token="token")


async def test_a_lab_knows_each_name_once_and_robots_up_to_a_limit(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robots_module, "ROBOTS_MAX", 2)
    robots = LabRobots(store)
    await robots.add(turtle(1))
    with pytest.raises(RobotKnownError, match="turtle-1"):
        await robots.add(turtle(1))
    second = await robots.add(turtle(2))
    with pytest.raises(TooManyRobotsError):
        await robots.add(turtle(3))
    await robots.remove(second)
    await robots.add(turtle(3))
    assert [robot.name for robot in robots.listed()] == ["turtle-1", "turtle-3"]
