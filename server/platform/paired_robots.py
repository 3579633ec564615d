"""The robots that have joined a lab: a file that survives the lab's end, and is there without the archive."""

import json
import threading
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from robot_runtime.durable_files import write_whole
from server.platform.errors import ConflictError, NotFoundError
from server.platform.settings import DataFolder

ROBOTS_MAX = 100


class UnpairedRobotError(NotFoundError):
    """No robot of this name has joined the lab"""

    def __init__(self, name: str) -> None:
        super().__init__(f"No robot {name!r} has joined this lab. GET /api/robots lists those that have.")


class RobotPairedError(ConflictError):
    """A robot of this name has joined the lab already"""

    def __init__(self, name: str) -> None:
        super().__init__(
            f"A robot {name!r} has joined this lab already. Remove it first, if it is the same one; else "
            "give this one another name: robot.name in its robot.toml."
        )


class TooManyRobotsError(ConflictError):
    """Too many robots have joined the lab"""

    def __init__(self) -> None:
        super().__init__(f"{ROBOTS_MAX} robots have joined this lab. Remove one that is not used any more.")


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedRobot:
    """A robot that has joined; `joined` in s since 1970.

    `address` is that of its own page, as it said last. `fingerprint` is that of its certificate, empty
    without TLS, and where public authorities vouch for it. `token` lets the lab read it, stop it, and fetch
    its sessions.
    """

    name: str
    address: str
    fingerprint: str
    token: str
    joined: float


class PairedRobots:
    """All robots that have joined, by name. Raises OSError where the file cannot be read or written."""

    def __init__(self, folder: DataFolder) -> None:
        self._file: Path = folder.paired_robots
        self._robots: dict[str, PairedRobot] = {}
        self._changing = threading.Lock()
        self._listeners: list[Callable[[], object]] = []
        if self._file.exists():
            entries = json.loads(self._file.read_bytes())
            self._robots = {entry["name"]: PairedRobot(**entry) for entry in entries}

    def listen(self, changed: Callable[[], object]) -> None:
        """Have a function called after each change, in the thread of the change."""
        self._listeners.append(changed)

    def all(self) -> list[PairedRobot]:
        """Return the robots, by name."""
        return [robot for _, robot in sorted(self._robots.items())]

    def get(self, name: str) -> PairedRobot:
        """Return the robot of this name. Raise UnpairedRobotError."""
        try:
            return self._robots[name]
        except KeyError:
            raise UnpairedRobotError(name) from None

    def check_room(self, name: str) -> None:
        """Raise RobotPairedError, or TooManyRobotsError, where no robot of this name can be added."""
        if name in self._robots:
            raise RobotPairedError(name)
        if len(self._robots) >= ROBOTS_MAX:
            raise TooManyRobotsError

    def add(self, robot: PairedRobot) -> None:
        """Add a robot, durably. Raise as `check_room`."""
        with self._changing:
            self.check_room(robot.name)
            self._write(self._robots | {robot.name: robot})

    def remove(self, name: str) -> PairedRobot:
        """Remove a robot, durably, and return it. Raise UnpairedRobotError."""
        with self._changing:
            robot = self.get(name)
            self._write({other: robot for other, robot in self._robots.items() if other != name})
        return robot

    def move(self, name: str, address: str, fingerprint: str) -> None:
        """Note a robot's present address and certificate, durably where they have changed."""
        with self._changing:
            robot = self._robots.get(name)
            if robot is not None and (robot.address, robot.fingerprint) != (address, fingerprint):
                moved = replace(robot, address=address, fingerprint=fingerprint)
                self._write(self._robots | {name: moved})

    def _write(self, robots: dict[str, PairedRobot]) -> None:
        text = json.dumps([asdict(robot) for robot in robots.values()], ensure_ascii=False, indent=1)
        write_whole(self._file, text.encode(), 0o600)
        self._robots = robots
        for changed in self._listeners:
            changed()
