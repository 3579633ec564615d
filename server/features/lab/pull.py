"""The pull: a lab fetches from its robots the sessions that its archive lacks.

Each is made an archive of on the robot, downloaded (continued where it broke off), compared with its
checksum, checked and stored as an import, and only then reported to the robot. A session is known by its
identifier, so that none is there twice. Whatever fails is tried again at the next look; an archive that
cannot be read, such as one of a newer version, after the lab's next start.
"""

import asyncio
import logging
from collections import defaultdict
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial
from shutil import rmtree
from time import time

from sqlalchemy import func
from sqlmodel import col, select

from robot_runtime.durable_files import PART, make_folder
from robot_runtime.errors import RefusedError
from server.features.lab.edits import UNKNOWN, follow, note_here, note_pulled
from server.features.lab.robot_client import (
    PullStoppedError,
    RobotAnswerError,
    RobotClient,
    RobotsExport,
)
from server.features.lab.schemas import Phase, RobotPull
from server.library.intake import ArchiveIntake
from server.library.schemas import ARCHIVED_MAX, SessionEdits
from server.platform.database_copies import sum_file
from server.platform.disk_space import FileWriteError, require_free
from server.platform.errors import InvalidError
from server.platform.models import PulledSessionRow, SessionRow
from server.platform.paired_robots import PairedRobot, PairedRobots
from server.platform.settings import DataFolder
from server.platform.store import Store, StoreError
from server.recording.session import HIDDEN

log = logging.getLogger(__name__)

PERIOD = 30.0
"""s between two looks at a robot."""
LOOKS_AT_ONCE = 8
"""A robot that is away takes 20 s of one."""
EXPORT_PAUSE = 0.5
"""s between two looks at an archive that a robot makes."""
COPIES = 3
"""A session is there as the archive, as the merged archive and in the database."""
PROBLEMS_SHOWN = 10
IDENTIFIERS_AT_ONCE = 500


@dataclass(slots=True)
class _Progress:
    phase: Phase = "waiting"
    text: str = "It was not looked at yet."
    progress: float = 0.0
    lacking: int = 0
    absent: bool = False
    """It did not answer the last look."""
    seen: float | None = None
    sessions: int = 0
    pulled: float | None = None
    problems: dict[str, str] = field(default_factory=dict)
    """By the identifiers of sessions that cannot be read."""


class SessionPull:
    """The pull from all robots of a lab.

    Several robots are looked at at once, those that were away beside the others, so that none waits for them.
    Sessions are fetched one at a time.
    """

    def __init__(self, store: Store, robots: PairedRobots, intake: ArchiveIntake, folder: DataFolder) -> None:
        self._store = store
        self._robots = robots
        self._intake = intake
        self._folder = folder.pulls
        self._progress: defaultdict[str, _Progress] = defaultdict(_Progress)
        self._looks = ThreadPoolExecutor(LOOKS_AT_ONCE, "look")
        self._looks_for_absent = ThreadPoolExecutor(LOOKS_AT_ONCE, "look for absent")
        self._fetching = asyncio.Lock()
        self._over = False
        self._wake = asyncio.Event()

    def listed(self) -> list[RobotPull]:
        """Return, by the robots' names, what comes of pulling from them."""
        return [_describe(robot.name, self._progress[robot.name]) for robot in self._robots.all()]

    def wake(self) -> None:
        """Look at the robots soon."""
        self._wake.set()
        # A new one, so that a pull which goes on just now is followed by another.
        self._wake = asyncio.Event()

    def stop(self) -> None:
        """End a download: what has arrived stays."""
        self._over = True
        for looks in (self._looks, self._looks_for_absent):
            looks.shutdown(wait=False, cancel_futures=True)

    async def run(self) -> None:
        """Pull for ever."""
        loop = asyncio.get_running_loop()
        self._robots.listen(lambda: loop.call_soon_threadsafe(self._follow))
        known: set[tuple[str, str]] = set()
        async with asyncio.TaskGroup() as group:
            while True:
                wake, robots = self._wake, self._robots.all()
                for robot in robots:
                    if (robot.name, robot.token) not in known:
                        group.create_task(self._repeat(robot.name, robot.token))
                known = {(robot.name, robot.token) for robot in robots}
                await wake.wait()

    async def _repeat(self, name: str, token: str) -> None:
        """Pull from a robot, wherever it has moved, until it is removed."""
        while (robot := self._find(name, token)) is not None:
            wake = self._wake
            await self.pull(robot)
            with suppress(TimeoutError):
                async with asyncio.timeout(PERIOD):
                    await wake.wait()

    async def pull(self, robot: PairedRobot) -> None:
        """Pull what is lacking from one robot now."""
        progress = self._progress[robot.name]
        # A robot that was removed and has joined again has another token.
        client = RobotClient(robot, lambda: self._over or self._find(robot.name, robot.token) is None)
        try:
            await asyncio.to_thread(self._count, robot.name, progress)
            sessions = await self._look(client, progress)
            async with self._fetching:
                await self._pull(client, robot, sessions, progress)
        except RobotAnswerError as problem:
            progress.phase, progress.text = "failed" if problem.status else "unreachable", str(problem)
        except (FileWriteError, StoreError, OSError) as problem:
            progress.phase, progress.text = "failed", str(problem)
        except PullStoppedError:
            if not self._over:
                # It was removed: nothing continues what has arrived.
                async with self._fetching:
                    await asyncio.to_thread(rmtree, self._folder, ignore_errors=True)

    def _follow(self) -> None:
        """Look at the robots that there are now."""
        names = {robot.name for robot in self._robots.all()}
        for name in self._progress.keys() - names:
            del self._progress[name]
        self.wake()

    def _find(self, name: str, token: str) -> PairedRobot | None:
        robots = self._robots.all()
        return next((robot for robot in robots if (robot.name, robot.token) == (name, token)), None)

    def _count(self, robot: str, progress: _Progress) -> None:
        """Count the sessions of a robot in the archive. Raise StoreError."""
        here = col(SessionRow.robot) == robot, col(SessionRow.state).not_in(HIDDEN)
        sessions = select(func.count()).where(*here, col(SessionRow.deleted).is_(None))
        pulled = select(func.max(PulledSessionRow.pulled)).where(col(PulledSessionRow.robot) == robot)
        with self._store.read() as database:
            progress.sessions = database.exec(sessions).one()
            progress.pulled = database.exec(pulled).one()

    async def _look(self, client: RobotClient, progress: _Progress) -> list[SessionEdits]:
        """Return the robot's sessions. Raise RobotAnswerError, PullStoppedError."""
        if self._over:
            raise PullStoppedError
        looks = self._looks_for_absent if progress.absent else self._looks
        progress.absent = True
        sessions = await asyncio.get_running_loop().run_in_executor(looks, client.sessions)
        progress.absent, progress.seen = False, time()
        return sessions

    async def _pull(
        self, client: RobotClient, robot: PairedRobot, sessions: Sequence[SessionEdits], progress: _Progress
    ) -> None:
        # Of one that the archive's own end has cut off, which is not here.
        await self._intake.drop_unfinished()
        stored, pulled, noted = await asyncio.to_thread(
            self._find_known, [session.identifier for session in sessions]
        )
        for session in sessions:
            # The lab may have been killed in between; and what was imported counts as pulled.
            if session.identifier in stored - noted.keys():
                await self._store.write(partial(note_here, session=session, robot=robot.name))
                noted[session.identifier] = robot.name, UNKNOWN
        lacking = [entry for entry in sessions if entry.identifier not in stored | pulled]
        for session in sessions:
            source, edits = noted.get(session.identifier, ("", session.edits))
            if session.identifier not in stored or source != robot.name or edits == session.edits:
                continue
            if await self._waits(client, progress, len(lacking)):
                return
            texts = await asyncio.to_thread(client.texts, session)
            await self._store.write(partial(follow, session=session, theirs=texts))
        for number, session in enumerate(lacking):
            if session.identifier in progress.problems:
                continue
            if await self._waits(client, progress, len(lacking) - number):
                return
            progress.phase, progress.text = "pulling", f"Its session “{session.name}” is being pulled."
            progress.progress = 0.0
            if await self._take(client, session, progress):
                stored.add(session.identifier)
                await self._store.write(partial(note_pulled, session=session, robot=robot.name))
                await asyncio.to_thread(self._count, robot.name, progress)
        await self._report(
            client, [entry for entry in sessions if entry.identifier in stored and not entry.archived]
        )
        progress.seen = time()
        progress.lacking = sum(entry.identifier not in stored | pulled for entry in sessions)
        if progress.problems:
            progress.phase, progress.text = "failed", "Some of its sessions cannot be pulled."
        elif progress.lacking:
            progress.phase, progress.text = "waiting", "The rest of its sessions is pulled in some minutes."
        else:
            progress.phase, progress.text = "done", "All of its sessions are in the archive."

    async def _waits(self, client: RobotClient, progress: _Progress, lacking: int) -> bool:
        """Return whether the pull must wait: what a robot does under water goes first."""
        progress.lacking = lacking
        armed = await asyncio.to_thread(client.is_armed)
        if armed:
            progress.phase, progress.text = "armed", "It is armed. Its sessions are pulled afterwards."
        return armed

    def _find_known(
        self, identifiers: Sequence[str]
    ) -> tuple[set[str], set[str], dict[str, tuple[str, int]]]:
        """Return those that are in the archive, those that are there no longer, or in its bin, and those that
        are noted as pulled, with their robot and its edits as of the last look."""
        here: set[str] = set()
        gone: set[str] = set()
        noted: dict[str, tuple[str, int]] = {}
        with self._store.read() as database:
            for some in _parts(identifiers, IDENTIFIERS_AT_ONCE):
                columns = select(SessionRow.identifier, SessionRow.state, SessionRow.deleted)
                for identifier, state, deleted in database.exec(
                    columns.where(col(SessionRow.identifier).in_(some))
                ):
                    (here if state not in HIDDEN and deleted is None else gone).add(identifier)
                row = PulledSessionRow
                rows = select(row.identifier, row.robot, row.edits).where(col(row.identifier).in_(some))
                noted |= {identifier: (robot, edits) for identifier, robot, edits in database.exec(rows)}
        return here, (gone | noted.keys()) - here, noted

    async def _take(self, client: RobotClient, session: SessionEdits, progress: _Progress) -> bool:
        """Bring a session into the archive; return False where it cannot be read.

        Raise RobotAnswerError, FileWriteError, OSError, StoreError, PullStoppedError.
        """
        export = await self._export(client, session)
        await asyncio.to_thread(make_folder, self._folder)
        path = self._folder / f"{session.identifier}-{export.sha256}{PART}"
        for other in self._folder.glob(f"{session.identifier}-*"):
            if other != path:
                other.unlink()
        require_free(self._folder, COPIES * export.bytes)

        def see(there: int) -> None:
            progress.progress = there / export.bytes

        await asyncio.to_thread(client.download, export, path, see)
        if await asyncio.to_thread(sum_file, path) != export.sha256:
            path.unlink()
            raise RobotAnswerError(
                f"The archive of “{session.name}” was damaged on its way. It is fetched again."
            )
        try:
            await self._intake.take_merged(path)
        except InvalidError as problem:
            progress.problems[session.identifier] = f"“{session.name}”: {problem}"
            return False
        except RefusedError as problem:
            # It came in another way meanwhile, or goes just now: the next look sees.
            log.info("%s: %s", session.name, problem)
            return False
        finally:
            if session.identifier not in progress.problems:
                path.unlink(missing_ok=True)
        await asyncio.to_thread(client.remove_export, export)
        return True

    async def _export(self, client: RobotClient, session: SessionEdits) -> RobotsExport:
        export = await asyncio.to_thread(client.find_export, session.identifier)
        if export is None:
            export = await asyncio.to_thread(client.begin_export, session.id)
        while export.state in ("waiting", "running"):
            await asyncio.sleep(EXPORT_PAUSE)
            export = await asyncio.to_thread(client.export, export.id)
        if export.state == "failed":
            raise RobotAnswerError(f"It cannot make an archive of “{session.name}”: {export.problem}")
        return export

    async def _report(self, client: RobotClient, sessions: Sequence[SessionEdits]) -> None:
        for some in _parts([session.identifier for session in sessions], ARCHIVED_MAX):
            await asyncio.to_thread(client.note_archived, some)


def _parts(items: Sequence[str], size: int) -> Iterable[Sequence[str]]:
    return (items[at : at + size] for at in range(0, len(items), size))


def _describe(robot: str, progress: _Progress) -> RobotPull:
    return RobotPull(
        robot=robot,
        phase=progress.phase,
        text=progress.text,
        progress=progress.progress,
        lacking=progress.lacking,
        problems=[*progress.problems.values()][:PROBLEMS_SHOWN],
        seen=_moment(progress.seen),
        sessions=progress.sessions,
        pulled=_moment(progress.pulled),
    )


def _moment(time: float | None) -> datetime | None:
    return None if time is None else datetime.fromtimestamp(time, UTC)
