"""Vision settings are stored beside the control loop, and only those that an operator chose."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_runtime.commands import Commands
from robot_runtime.config import Config
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.missions.document import read_mission
from robot_runtime.missions.node import LoadedMission
from robot_runtime.robot import RobotRuntime
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.settings_file import VisionSettingsFile
from tests.runtime.missions.water import mission
from tests.waiting import SECONDS


class WatchedFile(VisionSettingsFile):
    """Runs a control tick in another thread while it stores, as the control loop does."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.robot: RobotRuntime | None = None
        self.stored: list[VisionSettings | None] = []
        self.ticks: list[bool] = []

    def write(self, settings: VisionSettings) -> None:
        """Store the settings, and note if the tick came through."""
        self._look(settings)
        super().write(settings)

    def forget(self) -> None:
        """Remove them, and note the same."""
        self._look(None)
        super().forget()

    def _look(self, settings: VisionSettings | None) -> None:
        assert self.robot is not None
        tick = threading.Thread(target=self.robot.control_tick, daemon=True)
        tick.start()
        tick.join(SECONDS)
        self.ticks.append(not tick.is_alive())
        self.stored.append(settings)


@pytest.fixture
def file(tmp_path: Path) -> WatchedFile:
    return WatchedFile(tmp_path / "vision.json")


@pytest.fixture
def robot(tmp_path: Path, file: WatchedFile) -> Iterator[RobotRuntime]:
    with ZenohTransport("turtle", listen=[f"unixsock-stream/{tmp_path}/zenoh"]) as messages:
        file.robot = RobotRuntime(Config(), str(tmp_path / "port"), messages, vision_file=file)
        yield file.robot


def test_storing_holds_up_no_control_tick(robot: RobotRuntime, file: WatchedFile) -> None:
    Commands(robot).do["parameters"]({"values": {"vision.rate": 4, "vision.colour": "red"}})
    assert [(settings.rate, settings.colour) for settings in file.stored if settings] == [(4, "red")]
    Commands(robot).do["vision_settings"](robot.config.vision.settings.table())
    assert file.stored[1:] == [None]
    assert file.ticks == [True, True]


def test_what_a_mission_sets_and_puts_back_is_not_stored(robot: RobotRuntime, file: WatchedFile) -> None:
    colour = robot.vision.settings.colour
    sets = "{ do = 'set', parameter = 'vision.colour', value = 'red' }"
    text = mission(sets, "{ do = 'set', parameter = 'vision.rate', value = 4 }")
    robot.missions.prepare(LoadedMission(read_mission(text), text))
    while robot.missions.active:
        robot.missions.tick("automatic")
    robot.store_settings()
    assert robot.vision.settings.colour == colour
    assert file.stored == []
