"""A process that systemd starts and restarts: the server only watches it, and asks it to pause.

It writes its PID file in the folder `run` (`server.processes.runtime_service`), where the server finds it.
When the server ends, is killed or is updated, the process runs on.
"""

import asyncio
import signal
from contextlib import suppress
from pathlib import Path

from robot_runtime.clock import Clock
from robot_runtime.durable_files import write_whole
from robot_runtime.errors import RefusedError
from server.platform.disk_space import explain_write_error
from server.platform.pidfile import Running
from server.processes.logs import ProcessLog
from server.processes.managed_process import (
    NEED_POLL_SECONDS,
    TERM_SECONDS,
    ManagedProcess,
    ProcessCommand,
    SeeDown,
)
from server.processes.process import AdoptedProcess

ABSENT_SECONDS = 10.0
"""systemd starts a killed process again at once; a start takes seconds on a Raspberry Pi Zero."""
ABSENT = "does not run. Start it: sudo systemctl start mucat-runtime"


class ExternalProcess(ManagedProcess):
    """The process as `ManagedProcess`, started by somebody else; `paused` is the file that makes it wait."""

    def __init__(
        self,
        command: ProcessCommand,
        run: Path,
        paused: Path,
        clock: Clock,
        see_down: SeeDown,
        log: ProcessLog,
    ) -> None:
        super().__init__(command, log, run, clock, see_down)
        self._paused = paused

    async def run(self) -> None:
        """Watch the process whenever it runs; on cancellation leave it alone."""
        # A card that has become read-only refuses this even where the file does not exist.
        with suppress(OSError):
            self._paused.unlink(missing_ok=True)
        if self.state != "waiting":
            self._set("waiting")
        try:
            while True:
                await self._find()
                await self._watch()
        finally:
            await self.end()
            self._set("ended")

    async def end(self) -> None:
        """Stop watching the process; it runs on."""
        if self._process is not None:
            self._process.leave()
            self._process = None

    async def pause(self, why: str) -> None:
        """End the process, which waits at its next start until `run` is called again.

        Raise RefusedError where the pause file cannot be written; the process runs on.
        """
        try:
            await asyncio.to_thread(write_whole, self._paused, b"")
        except OSError as problem:
            raise RefusedError(
                f"The robot's runtime cannot be paused. {explain_write_error(problem, self._paused)}"
            ) from problem
        running = self._pid_file.read()
        if running is not None:
            await self._terminate(running)
        self.problem = why
        self._set("paused")

    async def _terminate(self, running: Running) -> None:
        with suppress(OSError):
            process = AdoptedProcess(running.pid, running.started)
            process.signal(signal.SIGTERM)
            with suppress(TimeoutError):
                async with asyncio.timeout(TERM_SECONDS):
                    await process.wait()
            process.close()

    async def _find(self) -> None:
        """Wait until the process runs; report once if it does not start in time."""
        first, since = self.state == "waiting", self._clock.now()
        while self._process is None:
            if (running := self._pid_file.read()) is not None:
                with suppress(OSError):
                    self._process = AdoptedProcess(running.pid, running.started)
                    break
            if self.problem != ABSENT and self._clock.now() - since > ABSENT_SECONDS:
                self._report(ABSENT)
            await asyncio.sleep(NEED_POLL_SECONDS)
        if first and self.state == "waiting":
            # Its messages during this server's start count: `since` is not reset.
            self.state = "running"
        else:
            self._set("running")

    async def _watch(self) -> None:
        """Watch the process until it ends."""
        assert self._process is not None
        await self._process.wait()
        self._process = None
        # Its exit status is known to systemd alone.
        reason, self._hung = self._hung or "has ended; journalctl -u mucat-runtime says why", ""
        self._report(f"{reason}. systemd starts it again")

    def _report(self, problem: str) -> None:
        self.problem = problem
        self._set("failed")
        self._see_down(self.command.name, f"The {self.command.title} {problem}.")
