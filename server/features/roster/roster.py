"""The roster: a lab's robots, as they said last, and STOP to all of them."""

import asyncio
import logging
import shutil
import tempfile
import time
from collections import deque
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from robot_runtime.clock import Clock
from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY
from server.features.roster.fleet_session import FleetSession
from server.features.roster.router_process import AGAIN_SECONDS, RouterProcess
from server.features.roster.schemas import RosterDetails, RosterRobot, StoppedRobot
from server.health.monitor import Condition
from server.http.pinned_requests import OtherServerRefusedError, UnreachableError, known_by, send
from server.interchange.presence import Presence
from server.platform.authority import Authority
from server.platform.errors import UnavailableError
from server.platform.lab_network import ROBOTS
from server.platform.notices import Notices
from server.platform.paired_robots import (
    ROBOTS_MAX,
    PairedRobot,
    PairedRobots,
    UnpairedRobotError,
)
from server.platform.settings import Settings, SetupError

log = logging.getLogger(__name__)

PRESENT_SECONDS = 3.5
"""A robot says how it is once a second."""
DEPTHS = 60
STOP_SECONDS = 2.0
STOPS_AT_ONCE = 2 * ROBOTS_MAX
"""Two ways for each robot, none of which waits for another."""
SIGN_OUT_SECONDS = 5.0
CLOCK_SECONDS = 60.0
"""Interval of the clocks' measurement."""
LOOK_SECONDS = 1.0
SILENT_DAYS = 7
"""After which a robot that is not heard is named."""


class CertificateNotMadeError(UnavailableError):
    """The robot's certificate cannot be made"""


@dataclass(slots=True)
class _Seen:
    """The last of a robot; times in s, steady clock."""

    presence: Presence | None = None
    heard: float = -inf
    alive: bool = False
    depths: deque[float | None] = field(default_factory=lambda: deque(maxlen=DEPTHS))
    clock_offset: float | None = None
    clock_measured: float = -inf


class Roster:
    """The robots that have joined, and the way to them. All calls come from the event loop."""

    def __init__(
        self,
        settings: Settings,
        clock: Clock,
        robots: PairedRobots,
        router: RouterProcess,
        notices: Notices,
    ) -> None:
        self._settings = settings
        self._clock = clock
        self._robots = robots
        self._router = router
        self._notices = notices
        self._began = clock.now()
        self._seen: dict[str, _Seen] = {}
        self._session: FleetSession | None = None
        self._stops = ThreadPoolExecutor(STOPS_AT_ONCE, "stop")
        self._afterwards: set[asyncio.Task[None]] = set()

    async def connect(self) -> None:
        """Open the way to the robots, as soon as the router runs."""
        loop = asyncio.get_running_loop()

        def see(robot: str, data: bytes) -> None:
            loop.call_soon_threadsafe(self.see, robot, data)

        def see_alive(robot: str, alive: bool) -> None:
            loop.call_soon_threadsafe(self.see_alive, robot, alive)

        endpoint = f"unixsock-stream/{self._settings.data.router_socket}"
        while self._session is None:
            await self._router.wait()
            try:
                self._session = await asyncio.to_thread(FleetSession, endpoint, see, see_alive)
            except OSError as problem:
                log.warning("the lab's router cannot be reached: %s", problem)
                await asyncio.sleep(AGAIN_SECONDS)

    async def measure_clocks(self) -> None:
        """Measure the clock of each robot that is there, once a minute, for ever."""
        while True:
            await self.measure_due_clocks()
            await asyncio.sleep(LOOK_SECONDS)

    async def measure_due_clocks(self) -> None:
        """Measure those that were measured a minute ago; sooner those that are not known yet."""
        now = self._clock.now()
        for name, seen in list(self._seen.items()):
            period = AGAIN_SECONDS if seen.clock_offset is None else CLOCK_SECONDS
            if self._is_present(seen) and now - seen.clock_measured >= period:
                seen.clock_measured = now
                await self._measure_clock(name, seen)

    def see(self, robot: str, data: bytes) -> None:
        """Take in a robot's presence."""
        try:
            paired = self._robots.get(robot)
            presence = Presence.model_validate_json(data)
        except UnpairedRobotError:
            return
        except ValidationError as problem:
            log.warning("a presence of %s cannot be read: %d mistakes", robot, problem.error_count())
            return
        if presence.left:
            self._begin(self.remove(robot, "has left the lab"))
            return
        seen = self._seen.setdefault(robot, _Seen())
        seen.presence, seen.heard, seen.alive = presence, self._clock.now(), True
        seen.depths.append(presence.depth)
        if (paired.address, paired.fingerprint) != (presence.address, presence.fingerprint):
            self._begin(asyncio.to_thread(self._robots.move, robot, presence.address, presence.fingerprint))

    def see_alive(self, robot: str, alive: bool) -> None:
        """Take in that a robot has come or gone."""
        self._seen.setdefault(robot, _Seen()).alive = alive

    def listed(self) -> RosterDetails:
        """Return all robots, by name."""
        return RosterDetails(
            robots=[self._describe(robot) for robot in self._robots.all()], problem=self._router.problem
        )

    def condition(self) -> Condition:
        """Return which robots are heard, for the health of the lab."""
        robots, now = self._robots.all(), self._clock.now()
        seen = [self._seen.get(robot.name, _Seen()) for robot in robots]
        if not robots:
            return "ok", "No robot has joined yet: mucat lab pair."
        text = f"{sum(map(self._is_present, seen))} of {len(robots)} are heard now."
        long_ago = now - SILENT_DAYS * 86_400
        silent = [
            robot.name
            for robot, last in zip(robots, seen, strict=True)
            if max(last.heard, self._began) < long_ago
        ]
        if silent:
            return "absent", f"{text} Not heard for {SILENT_DAYS} days: {', '.join(silent)}."
        return "ok", text

    async def join(self, name: str, address: str, fingerprint: str, token: str) -> dict[str, str]:
        """Add a robot; return the files of its certificate, by their names.

        Raise RobotPairedError, TooManyRobotsError, CertificateNotMadeError.
        """
        self._robots.check_room(name)
        robot = PairedRobot(
            name=name, address=address, fingerprint=fingerprint, token=token, joined=time.time()
        )
        try:
            files = await asyncio.to_thread(self._issue, name)
            await asyncio.to_thread(self._robots.add, robot)
        except (SetupError, OSError) as problem:
            raise CertificateNotMadeError(str(problem)) from problem
        self._seen.pop(name, None)
        self._router.renew()
        self._notices.notify("lab", "info", f"The robot {name} has joined the lab.")
        return files

    async def remove(self, name: str, how: str = "was removed from the lab") -> None:
        """Remove a robot: it is let in no more. Raise UnpairedRobotError, CertificateNotMadeError."""
        self._robots.get(name)
        try:
            # First of all: what follows may fail, and a robot that is listed can be removed once more.
            await asyncio.to_thread(self._revoke, name)
            robot = await asyncio.to_thread(self._robots.remove, name)
        except OSError as problem:
            raise CertificateNotMadeError(str(problem)) from problem
        self._seen.pop(name, None)
        self._router.renew()
        self._notices.notify("lab", "caution", f"The robot {name} {how}.")
        self._begin(asyncio.to_thread(_sign_out, robot))

    async def stop_all(self) -> list[StoppedRobot]:
        """Send STOP to every robot, by Zenoh and by HTTPS at once; return what each has answered."""
        return list(await asyncio.gather(*map(self._stop, self._robots.all())))

    async def close(self) -> None:
        """Close the way to the robots."""
        self._stops.shutdown(wait=False, cancel_futures=True)
        if self._session is not None:
            await asyncio.to_thread(self._session.close)

    async def _stop(self, robot: PairedRobot) -> StoppedRobot:
        loop = asyncio.get_running_loop()
        zenoh, https = await asyncio.gather(
            loop.run_in_executor(self._stops, self._stop_by_zenoh, robot.name),
            loop.run_in_executor(self._stops, _stop_by_https, robot),
        )
        return StoppedRobot(name=robot.name, stopped="" in (zenoh, https), zenoh=zenoh, https=https)

    def _stop_by_zenoh(self, name: str) -> str:
        """Return why a robot was not stopped this way; empty where it was."""
        if self._session is None:
            return self._router.problem
        try:
            self._session.stop(name, STOP_SECONDS)
        except (NoAnswerError, RefusedError, OSError, ValueError) as problem:
            return f"{str(problem).rstrip('.')}."
        return ""

    async def _measure_clock(self, name: str, seen: _Seen) -> None:
        if self._session is None:
            return
        try:
            seen.clock_offset = await asyncio.to_thread(self._session.measure_clock, name)
        except (NoAnswerError, RefusedError, OSError, ValueError, LookupError) as problem:
            log.info("the clock of %s is not known: %s", name, problem)

    def _issue(self, name: str) -> dict[str, str]:
        authority = Authority(self._settings, ROBOTS)
        if any(certificate.name == name for certificate in authority.issued()):
            authority.revoke(name)  # left by an earlier try that was cut off
        folder = Path(tempfile.mkdtemp(prefix="robot-", dir=self._settings.data.path))
        try:
            authority.issue(name, folder / name)
            return {
                file: (folder / name / file).read_text(encoding="ascii")
                for file in (AUTHORITY, CERTIFICATE, KEY)
            }
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _revoke(self, name: str) -> None:
        authority = Authority(self._settings, ROBOTS)
        if any(certificate.name == name for certificate in authority.issued()):
            authority.revoke(name)

    def _describe(self, robot: PairedRobot) -> RosterRobot:
        seen = self._seen.get(robot.name, _Seen())
        return RosterRobot(
            name=robot.name,
            joined=robot.joined,
            present=self._is_present(seen),
            seen=None if seen.presence is None else self._clock.now() - seen.heard,
            presence=seen.presence,
            depths=list(seen.depths),
            clock_offset=seen.clock_offset,
            address=robot.address,
        )

    def _is_present(self, seen: _Seen) -> bool:
        return seen.alive and self._clock.now() - seen.heard < PRESENT_SECONDS

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._afterwards.add(task)
        task.add_done_callback(self._see_done)

    def _see_done(self, task: asyncio.Task[None]) -> None:
        self._afterwards.discard(task)
        if not task.cancelled() and (problem := task.exception()) is not None:
            log.warning("the list of robots has not followed: %s", problem)


def _stop_by_https(robot: PairedRobot) -> str:
    """Return why a robot was not stopped this way; empty where it was."""
    if not robot.address:
        return "Its page is open to no other computer."
    try:
        _ask(robot, "/robot/stop", STOP_SECONDS)
    except (UnreachableError, OtherServerRefusedError) as problem:
        return str(problem)
    return ""


def _sign_out(robot: PairedRobot) -> None:
    """Have a robot forget the lab's token, where it can be reached."""
    if not robot.address:
        return
    try:
        _ask(robot, "/access/sign-out", SIGN_OUT_SECONDS)
    except (UnreachableError, OtherServerRefusedError) as problem:
        log.info("%s still has the lab's token: %s", robot.name, problem)


def _ask(robot: PairedRobot, path: str, seconds: float) -> None:
    send(
        robot.address,
        "POST",
        path,
        is_meant=known_by(robot.fingerprint),
        token=robot.token,
        seconds=seconds,
    )
