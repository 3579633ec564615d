"""One of the robot's processes: started, adopted from an earlier server, restarted, ended."""

import asyncio
import hashlib
import logging
import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from robot_runtime.backoff import Backoff, describe_pause, is_killed
from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Severity
from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.places import EMULATOR_REMEDY
from server import VERSION
from server.platform.pidfile import pid_file
from server.processes.exit_status import describe_end
from server.processes.logs import LINES_SHOWN, ProcessLog
from server.processes.process import AdoptedProcess, Process, ProcessGroup

log = logging.getLogger(__name__)

TERM_SECONDS = 3.0
NEED_POLL_SECONDS = 0.05
TRIM_SECONDS = 1.0

State = Literal["waiting", "running", "failed", "ended", "paused"]
Notify = Callable[[str, Severity, str], None]
SeeDown = Callable[[str, str], None]
"""Called with a process's name and a sentence about its unexpected end."""


@dataclass(frozen=True, slots=True)
class ProcessCommand:
    """Command of a process; `needs` are files that must exist first, `made_of` those that it reads;
    an `external` one is started by systemd.

    The next server adopts a running process of the same command, version and content of `made_of`.
    """

    name: str
    title: str
    arguments: tuple[str, ...]
    needs: tuple[Path, ...] = ()
    made_of: tuple[Path, ...] = ()
    external: bool = False

    def fingerprint(self) -> str:
        """Return a hash of the command, its files and the version; equal hashes start the same process."""
        digest = hashlib.sha256(repr((self.arguments, VERSION, DEFINITIONS_HASH)).encode())
        for path in self.made_of:
            with suppress(OSError):
                digest.update(hashlib.sha256(path.read_bytes()).digest())
        return digest.hexdigest()


class ManagedProcess:
    """One supervised process; the next server finds it by its PID file in the folder `run`."""

    def __init__(
        self, command: ProcessCommand, log: ProcessLog, run: Path, clock: Clock, see_down: SeeDown
    ) -> None:
        self.command = command
        self.state: State = "waiting"
        self.since = clock.now()
        self.problem = ""
        self._log = log
        self._logged_before = 0
        self._pid_file = pid_file(run, command.name)
        self._clock = clock
        self._see_down = see_down
        self._process: ProcessGroup | None = None
        self._backoff = Backoff()
        self._hung = ""

    @property
    def pid(self) -> int | None:
        """The process's number; None while it does not run."""
        return self._process.pid if self._process is not None and self.state == "running" else None

    async def run(self) -> None:
        """Start the process, and restart it when it ends; on cancellation end it."""
        try:
            if await self._adopt():
                # Its messages during this server's start count: `since` is not reset.
                self.state = "running"
            else:
                self._set("waiting")
            while True:
                began = self._clock.now()
                if self._process is None:
                    await self._wait_for_needs()
                    began = self._clock.now()
                problem, killed = await self._run_once()
                pause = self._backoff.after(self._clock.now() - began, killed=killed)
                self._fail(problem, pause)
                await asyncio.sleep(pause)
        finally:
            await self.end()
            self._set("ended")

    async def _adopt(self) -> bool:
        """Adopt the process that a killed server has left, or end it where its fingerprint differs.

        Return True if a process was adopted.
        """
        running = self._pid_file.read()
        if running is None:
            return False
        with suppress(OSError):
            self._process = AdoptedProcess(running.pid, running.started)
        if running.fingerprint != self.command.fingerprint():
            await self.end()
        return self._process is not None

    async def _wait_for_needs(self) -> None:
        while not all(path.exists() for path in self.command.needs):
            if self.state != "failed":
                self._set("waiting")
            await asyncio.sleep(NEED_POLL_SECONDS)

    async def _run_once(self) -> tuple[str, bool]:
        """Run the process to its end. Return a description of the end, and True where it was killed."""
        try:
            process = self._process = self._process or self._start()
        except OSError as problem:
            program = self.command.arguments[0]
            return f"cannot be started: {program}: {problem.strerror}; {EMULATOR_REMEDY}", False
        except MemoryError:
            return "cannot be started: the server has no memory left", False
        if self.state != "running":
            self._set("running")
        trimming = asyncio.create_task(self._trim())
        try:
            status = await process.wait()
        finally:
            trimming.cancel()
        self._release()
        if self._hung:
            reason, self._hung = self._hung, ""
            return reason, True
        last = self._log.last(LINES_SHOWN, self._logged_before)
        return describe_end(status, last), is_killed(status)

    def _start(self) -> Process:
        self._logged_before = self._log.size()
        with self._log.open() as output:
            process = Process(self.command.arguments, output)
        try:
            self._pid_file.write(process.pid, self.command.fingerprint())
        except OSError as problem:
            log.warning("%s: the PID file cannot be written: %s", self.command.name, problem)
        return process

    async def _trim(self) -> None:
        while True:
            self._log.trim()
            await asyncio.sleep(TRIM_SECONDS)

    def _release(self) -> None:
        assert self._process is not None
        self._process.close()
        self._process = None
        self._pid_file.remove()

    def _fail(self, problem: str, pause: float) -> None:
        self.problem = problem
        self._set("failed")
        text = f"The {self.command.title} {problem}. It is started again {describe_pause(pause)}."
        self._see_down(self.command.name, text)

    async def end(self) -> None:
        """End the process, even if it is a killed server's that was not adopted yet."""
        if self._process is None and (running := self._pid_file.read()) is not None:
            with suppress(OSError):
                self._process = AdoptedProcess(running.pid, running.started)
        if self._process is None:
            return
        self._process.signal(signal.SIGTERM)
        with suppress(TimeoutError):
            async with asyncio.timeout(TERM_SECONDS):
                await self._process.wait()
        self._release()

    def end_hung(self, problem: str) -> None:
        """Kill a process that no longer answers, to restart it; `problem` follows its name in the alarm."""
        if self._process is not None:
            self._hung = problem
            self._process.signal(signal.SIGKILL)

    async def pause(self, why: str) -> None:
        """End the process without a restart; `why` is a sentence for a person."""
        await self.end()
        self.problem = why
        self._set("paused")

    def _set(self, state: State) -> None:
        self.state = state
        self.since = self._clock.now()
