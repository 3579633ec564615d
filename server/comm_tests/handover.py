"""Lends the robot's board to a communication test, and takes it back with the robot's firmware on it.

While a board may hold anything but the robot's firmware, a file in the data folder says so: written before
the first upload, taken away after the firmware is back. So a server that was killed in between brings it back
at its next start.
"""

import asyncio
import os
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from signal import SIGTERM

from robot_runtime.config import load
from robot_runtime.errors import Refused
from server.bridge import Bridge, RuntimeSilent
from server.health import Watch
from server.logs import PartLog
from server.parts import Parts, Tell
from server.process import Process
from server.settings import Settings

DISARM_SECONDS = 3.0
RESTORE_SECONDS = 120.0
"""An upload at 115200 baud takes 5 s, three attempts with a board that does not answer some 40 s."""
LOOK_SECONDS = 0.05


class Board:
    """The robot's board, whose port nobody else has open. `tell` hears what becomes of its firmware."""

    def __init__(self, settings: Settings, tell: Tell) -> None:
        self._settings = settings
        self._tell = tell

    @property
    def away(self) -> bool:
        """Whether its firmware may be something else than the robot's."""
        return self._settings.data.firmware_away.exists()

    @asynccontextmanager
    async def lend(self, name: str) -> AsyncIterator[list[str]]:
        """While entered the board is the test's of this name; the value are the lab's arguments for it."""
        await asyncio.to_thread(_mark, self._settings.data.firmware_away, name)
        try:
            yield self._arguments()
        finally:
            # The test may have been ended by force; this must come to its end all the same.
            await asyncio.shield(asyncio.create_task(self.restore()))

    async def restore(self) -> bool:
        """Upload the robot's firmware; whether it is there."""
        output = PartLog(self._settings.data.logs / "restore.log")
        command = [sys.executable, "-m", "robot_runtime.comm_test", "--restore", "--with-parent"]
        command += ["--build", str(self._settings.build), *self._arguments()]
        problem = f"it took more than {RESTORE_SECONDS:g} s"
        process = Process(command, output.write)
        try:
            async with asyncio.timeout(RESTORE_SECONDS):
                status = await process.wait()
            problem = "" if status == 0 else output.last(2) or f"exit status {status}"
        except TimeoutError:
            process.signal(SIGTERM)
        finally:
            process.close()
            output.close()
        if problem:
            self._tell(
                "firmware",
                "alarm",
                f"The robot's firmware is not back on its board: {problem}. Check that the board is powered "
                "and its reset line connected, then start the server again.",
            )
            return False
        await asyncio.to_thread(_unmark, self._settings.data.firmware_away)
        self._tell("firmware", "info", "The robot's firmware is back on its board.")
        return True

    def _arguments(self) -> list[str]:
        settings, link = self._settings, load(self._settings.config).link
        port, reset = link.port, link.reset
        if settings.mode == "emulated":
            port, reset = str(settings.data.board_tty), f"board:{settings.data.board_socket}"
        arguments = ["--port", port, "--reset", reset, "--baud-upload", str(link.baud_upload)]
        return [*arguments, "--baud-robot", str(link.baud)]


class Handover:
    """Of the board between the runtime and the lab; `occupied` says why it cannot be lent now, if so."""

    def __init__(
        self, board: Board, bridge: Bridge, watch: Watch, parts: Parts, occupied: Callable[[], str | None]
    ) -> None:
        self._board = board
        self._bridge = bridge
        self._watch = watch
        self._parts = parts
        self._occupied = occupied

    @asynccontextmanager
    async def lend(self, name: str) -> AsyncIterator[list[str]]:
        """As `Board.lend`, but the robot is disarmed and its runtime ends before, and comes back afterwards.

        Raises Refused where that is not possible.
        """
        if reason := self._occupied():
            raise Refused(reason)
        await self._disarm()
        why = f"The robot's board runs the communication test “{name}”."
        async with self._without_runtime(why), self._board.lend(name) as arguments:
            yield arguments

    async def start_parts(self) -> None:
        """Start every part; where an earlier server could not bring the firmware back, that comes first."""
        if not self._board.away:
            self._parts.start()
            return
        words = "A communication test was cut off; the robot's firmware is uploaded to its board again."
        async with self._without_runtime(words):
            self._parts.start()
            await self._board.restore()

    @asynccontextmanager
    async def _without_runtime(self, why: str) -> AsyncIterator[None]:
        self._bridge.lent = why
        await self._parts.pause("runtime", why)
        try:
            yield
        finally:
            self._bridge.lent = None
            self._parts.resume("runtime")

    async def _disarm(self) -> None:
        with suppress(RuntimeSilent):
            # A board that hears nothing disarms by itself within a second, and the runtime is ended anyway.
            await self._bridge.command("stop", {})
        end = asyncio.get_running_loop().time() + DISARM_SECONDS
        while (self._watch.state() or {}).get("armed"):
            if asyncio.get_running_loop().time() > end:
                raise Refused("The robot does not disarm, so its board cannot run a communication test.")
            await asyncio.sleep(LOOK_SECONDS)


def _mark(path: Path, name: str) -> None:
    with path.open("w", encoding="utf-8") as file:
        file.write(f"{name}\n")
        file.flush()
        os.fsync(file.fileno())
    _sync_folder(path.parent)


def _unmark(path: Path) -> None:
    path.unlink(missing_ok=True)
    _sync_folder(path.parent)


def _sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
