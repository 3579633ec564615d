"""Keeps the other processes running: starts them in order, watches them, starts them again, ends them.

A part runs in a process group of its own, so that Ctrl-C reaches the server alone and nothing that the part
has started outlives it. `--with-parent` lets the parts end by themselves where the server is killed.
"""

import asyncio
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from robot_runtime.clock import Clock
from robot_runtime.firmware import firmware_path
from robot_runtime.samples import Severity
from server.logs import PartLog
from server.process import Process
from server.settings import Settings

BACKOFF_FIRST = 0.2
BACKOFF_MAX = 5.0
STEADY_SECONDS = 10.0
"""A part that lived this long is started again quickly when it ends."""
TERM_SECONDS = 3.0
NEED_POLL_SECONDS = 0.05
LINES_TOLD = 3

SIMULATOR_ELSEWHERE = "It is left to another computer: mucat simulator --connect ENDPOINT."

State = Literal["waiting", "running", "failed", "ended", "paused"]
Tell = Callable[[str, Severity, str], None]


@dataclass(frozen=True, slots=True)
class Command:
    """How a part is started; `needs` are files that must be there first."""

    name: str
    title: str
    arguments: tuple[str, ...]
    needs: tuple[Path, ...] = ()


class Part:
    """One supervised process."""

    def __init__(self, command: Command, log: PartLog, clock: Clock, tell: Tell) -> None:
        self.command = command
        self.state: State = "waiting"
        self.since = clock.now()
        self.problem = ""
        self._log = log
        self._clock = clock
        self._tell = tell
        self._process: Process | None = None
        self._backoff = BACKOFF_FIRST

    @property
    def pid(self) -> int | None:
        """The process's number while it runs."""
        return self._process.pid if self._process is not None and self.state == "running" else None

    async def run(self) -> None:
        """Keep the process running until this is cancelled; then end it."""
        self._set("waiting")
        try:
            while True:
                await self._wait_for_needs()
                began = self._clock.now()
                problem = await self._run_once()
                if self._clock.now() - began >= STEADY_SECONDS:
                    self._backoff = BACKOFF_FIRST
                self._fail(problem)
                await asyncio.sleep(self._backoff)
                self._backoff = min(2 * self._backoff, BACKOFF_MAX)
        finally:
            await self._end()
            self._set("ended")
            self._log.close()

    async def _wait_for_needs(self) -> None:
        while not all(path.exists() for path in self.command.needs):
            if self.state != "failed":
                self._set("waiting")
            await asyncio.sleep(NEED_POLL_SECONDS)

    async def _run_once(self) -> str:
        """Run the process to its end. Returns what happened, in words."""
        try:
            self._process = Process(self.command.arguments, self._log.write)
        except OSError as problem:
            program = self.command.arguments[0]
            return f"cannot be started: {program}: {problem.strerror}. Build it with “make firmware”"
        self._set("running")
        status = await self._process.wait()
        self._process.close()
        last = self._log.last(LINES_TOLD)
        return describe_status(status) + (f". Its last words: {last}" if last else "")

    def _fail(self, problem: str) -> None:
        self.problem = problem
        self._set("failed")
        self._tell(
            self.command.name,
            "caution",
            f"The {self.command.title} {problem}. It is started again in {self._backoff:.1f} s.",
        )

    async def _end(self) -> None:
        if self._process is None or self.state != "running":
            return
        self._process.signal(signal.SIGTERM)
        with suppress(TimeoutError):
            async with asyncio.timeout(TERM_SECONDS):
                await self._process.wait()
        self._process.close()

    def pause(self, why: str) -> None:
        """Note that the process has been ended on purpose; `why` is a sentence."""
        self.problem = why
        self._set("paused")

    def _set(self, state: State) -> None:
        self.state = state
        self.since = self._clock.now()


class Parts:
    """All parts of this robot, by name."""

    def __init__(self, commands: Sequence[Command], logs: Path, clock: Clock, tell: Tell) -> None:
        self._parts = {
            command.name: Part(command, PartLog(logs / f"{command.name}.log"), clock, tell)
            for command in commands
        }
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def start(self) -> None:
        """Start everything, each as soon as what it needs is there; what is paused is not started."""
        for name, part in self._parts.items():
            if part.state != "paused":
                self._tasks[name] = asyncio.create_task(part.run())

    async def stop(self) -> None:
        """End every process, and wait until they are gone."""
        tasks = self._tasks.values()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def pause(self, name: str, why: str) -> None:
        """End a part, and leave it so until it is resumed; `why` is a sentence for a person."""
        task = self._tasks.pop(name, None)
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        if name in self._parts:
            self._parts[name].pause(why)

    def resume(self, name: str) -> None:
        """Start a part that was paused."""
        part = self._parts.get(name)
        if part is not None and part.state == "paused":
            self._tasks[name] = asyncio.create_task(part.run())

    def get(self, name: str) -> Part | None:
        """The part of this name; None where this robot has none."""
        return self._parts.get(name)


def plan(settings: Settings) -> list[Command]:
    """What must run for this robot, in the order in which one needs the other."""
    folder, build = settings.data, settings.build
    runtime = [sys.executable, "-m", "robot_runtime", "--config", str(settings.config)]
    runtime += ["--data", str(folder.path)]
    if settings.mode == "robot":
        return [Command("runtime", "robot's runtime", (*runtime, "--with-parent"))]
    simulator = [sys.executable, "-m", "robot_runtime.simulation"]
    if settings.in_the_loop:
        simulator += ["--in-the-loop", "--connect", f"unixsock-stream/{folder.runtime_socket}"]
    else:
        simulator += ["--board", str(folder.board_socket)]
        for socket in (folder.runtime_socket, folder.server_socket):
            simulator += ["--connect", f"unixsock-stream/{socket}"]
    simulator += ["--robot", settings.robot, "--with-parent"]
    needs = (folder.runtime_socket,) if settings.in_the_loop else (folder.board_socket, folder.runtime_socket)
    water = Command("simulator", "simulator", tuple(simulator), needs)
    if not settings.emulated_board:
        return [Command("runtime", "robot's runtime", (*runtime, "--with-parent")), water]
    runtime += ["--port", str(folder.board_tty), "--with-parent"]
    elf = firmware_path(build, settings.link.baud, ".elf", hil=settings.in_the_loop)
    board = [str(build / "board"), "--elf", str(elf)]
    board += ["--tty", str(folder.board_tty), "--socket", str(folder.board_socket)]
    # The communication test uploads its sketches to this board, as to a real one.
    board += ["--bootloader", str(build / "firmware" / "optiboot.hex")]
    board += ["--eeprom", str(folder.board_eeprom), "--with-parent"]
    return [
        Command("board", "emulated board", tuple(board)),
        Command("runtime", "robot's runtime", tuple(runtime), (folder.board_tty,)),
        water,
    ]


def describe_status(status: int) -> str:
    """How a process ended, in words that go on after its name."""
    if status >= 0:
        return f"has ended with exit status {status}"
    try:
        name = signal.Signals(-status).name
    except ValueError:
        name = str(-status)
    return f"was ended by signal {name}"
