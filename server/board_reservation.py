"""The reservation of the robot's board for other programs, with the robot's firmware restored afterwards.

While the board may hold other firmware, a file in the data folder says so: it is written before the first
upload and removed after the robot's firmware is back. So a killed server restores it at its next start.
"""

import asyncio
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

from robot_runtime.clock import Clock
from robot_runtime.durable_files import sync, write_whole
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.boards.firmware import firmware_path
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.processes.exit_status import describe_status
from server.processes.logs import ProcessLog
from server.processes.managed_process import Notify
from server.processes.process import Process
from server.processes.supervisor import ProcessSupervisor
from server.stream.bridge import Bridge, RuntimeSilentError

DISARM_SECONDS = 3.0
"""The runtime sends its state at every change, and every second."""
PORT_SECONDS = 10.0
"""Time for the emulated board to create its port."""
RESTORE_SECONDS = 120.0
"""An upload at 115200 baud takes 5 s, three attempts with a board that does not answer some 40 s."""
POLL_SECONDS = 0.05
LINES_SHOWN = 2


class RobotBoard:
    """The robot's board, whose port no other program has open. `notify` reports the state of its firmware.

    `problem` says why the firmware could not be restored, and what to do; None if it is in place. `restored`
    is awaited once it is.
    """

    def __init__(
        self,
        settings: Settings,
        notify: Notify,
        restored: Callable[[], Awaitable[None]] = lambda: asyncio.sleep(0),
    ) -> None:
        self.problem: str | None = None
        self._settings = settings
        self._notify = notify
        self._restored = restored
        link, folder = settings.link, settings.data
        self._port, reset = link.port, link.reset
        if settings.emulated_board:
            self._port, reset = str(folder.board_tty), f"board:{folder.board_socket}"
        self._arguments = ["--port", self._port, "--reset", reset]

    @property
    def away(self) -> bool:
        """True while the board may hold other firmware than the robot's."""
        return self._settings.data.firmware_away.exists()

    @asynccontextmanager
    async def reserve(self, work: str, program: Path | None = None) -> AsyncIterator[list[str]]:
        """Reserve the board for this work, given as text; yield the lab's arguments for the board.

        Afterwards it gets this program (Intel HEX), by default the firmware that was built. Raise
        RefusedError if the note that the firmware is away cannot be written.
        """
        note = self._settings.data.firmware_away
        try:
            await asyncio.to_thread(_write_note, note, work)
        except OSError as problem:
            raise RefusedError(
                f"{note} cannot be written: {problem.strerror}. After a power cut the server would not know "
                "that it must restore the robot's firmware. Free some space, or check the disk."
            ) from problem
        try:
            yield list(self._arguments)
        finally:
            await self.restore(program)

    @property
    def built(self) -> Path:
        """The robot's firmware as it was built (Intel HEX); it need not exist."""
        settings = self._settings
        return firmware_path(settings.build, settings.link.baud, ".hex", hil=settings.in_the_loop)

    async def restore(self, program: Path | None = None) -> None:
        """Upload the robot's firmware, by default the built one, and report the result."""
        problem = await self.upload(program or self.built)
        if problem:
            self.problem = (
                f"The robot's firmware is not on its board: {problem}. Check that the board is powered and "
                "its reset line connected, then start the server again, or a communication test on "
                "the robot's board; both bring it back."
            )
            self._notify("firmware", "alarm", self.problem)
            return
        await asyncio.to_thread(_remove_note, self._settings.data.firmware_away)
        self.problem = None
        await self._restored()
        self._notify("firmware", "info", "The robot's firmware is back on its board.")

    async def upload(self, program: Path) -> str:
        """Upload a program (Intel HEX); return the problem as text, empty on success."""
        return await self._transfer("--restore", program, "upload")

    async def read_out(self, program: Path) -> str:
        """Read all flash memory into a file (Intel HEX); return the problem as text, empty on success."""
        return await self._transfer("--read-out", program, "read-out")

    async def _transfer(self, way: str, program: Path, title: str) -> str:
        output = ProcessLog(self._settings.data.logs / "restore.log")
        before = output.size()
        command = [sys.executable, "-m", "robot_runtime.experiments.comm_test", way, str(program)]
        command += ["--with-parent", "--progress", str(self._settings.data.upload_progress), *self._arguments]
        try:
            async with asyncio.timeout(PORT_SECONDS):
                while not Path(self._port).exists():
                    await asyncio.sleep(POLL_SECONDS)
        except TimeoutError:
            return f"there is no {self._port}"
        try:
            with output.open() as file:
                process = Process(command, file)
            try:
                async with asyncio.timeout(RESTORE_SECONDS):
                    status = await process.wait()
            finally:
                process.close()
        except TimeoutError:
            return f"the {title} took more than {RESTORE_SECONDS:g} s"
        except OSError as problem:
            return f"the {title} could not be started: {problem.strerror}"
        finally:
            output.trim()
        if status == 0:
            return ""
        return output.last(LINES_SHOWN, since=before) or f"the {title} {describe_status(status)}"


class BoardReservation:
    """The handover of the board from the runtime to a program; `occupied` returns a reason against it."""

    def __init__(
        self,
        board: RobotBoard,
        bridge: Bridge,
        monitor: HealthMonitor,
        processes: ProcessSupervisor,
        clock: Clock,
        occupied: Callable[[], str | None],
    ) -> None:
        self._board = board
        self._bridge = bridge
        self._monitor = monitor
        self._processes = processes
        self._clock = clock
        self._occupied = occupied

    @asynccontextmanager
    async def reserve(self, work: str, program: Path | None = None) -> AsyncIterator[list[str]]:
        """Reserve as `RobotBoard.reserve`; disarm the robot and end its runtime before, restart it
        afterwards.

        Raise RefusedError if that is not possible.
        """
        reason = self._bridge.reserved_reason or self._occupied()
        if reason:
            raise RefusedError(reason)
        # True also while the robot's firmware comes back, when there is nothing left to end.
        why = f"{work} has the robot's board. Some seconds after its end the board is the robot's again."
        with self._nobody_commands(why):
            await self._disarm()
            # A session may have been about to start when the board was asked for.
            if reason := self._occupied():
                raise RefusedError(reason)
            async with self._without_runtime(why), self._board.reserve(work, program) as arguments:
                yield arguments

    async def start_processes(self) -> None:
        """Start every process; first restore the robot's firmware, if an earlier server has not."""
        if not self._board.away:
            self._processes.start()
            return
        why = "Work on the robot's board was cut off; its firmware is being uploaded to the board again."
        try:
            with self._nobody_commands(why):
                async with self._without_runtime(why):
                    self._processes.start()
                    await self._board.restore()
        except RefusedError as problem:
            self._monitor.firmware_away = (
                f"The robot's firmware cannot be brought back to its board. {problem}"
            )
            self._processes.start()

    @contextmanager
    def _nobody_commands(self, why: str) -> Iterator[None]:
        self._bridge.reserved_reason = why
        try:
            yield
        finally:
            self._bridge.reserved_reason = None

    @asynccontextmanager
    async def _without_runtime(self, why: str) -> AsyncIterator[None]:
        await self._processes.pause("runtime", why)
        self._bridge.stopped = True
        try:
            yield
        finally:
            self._bridge.stopped = False
            self._monitor.firmware_away = self._board.problem
            self._processes.resume("runtime")

    async def _disarm(self) -> None:
        sent = self._clock.now()
        try:
            await self._bridge.stop()
        except RuntimeSilentError as problem:
            if not problem.waited:
                return  # no runtime: a board without commands disarms itself within a second
            raise RefusedError(f"The robot could not be disarmed before. {problem}") from problem
        while self._may_be_armed(sent):
            if self._clock.now() - sent > DISARM_SECONDS:
                raise RefusedError(
                    f"The robot was not disarmed within {DISARM_SECONDS:g} s, so its board cannot run "
                    "another program. Look at the System page, and try again."
                )
            await asyncio.sleep(POLL_SECONDS)

    def _may_be_armed(self, since: float) -> bool:
        """Return True unless a state newer than the STOP says that the robot is disarmed."""
        state = self._monitor.state() or {}
        time = state.get("time")
        return not isinstance(time, int | float) or time < since or state.get("armed") is not False


def _write_note(path: Path, work: str) -> None:
    write_whole(path, f"{work}\n".encode())


def _remove_note(path: Path) -> None:
    path.unlink(missing_ok=True)
    sync(path.parent)
