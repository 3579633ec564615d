"""Programs on the computers of a lab, started by the documented commands."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil

from server.platform.running_server import ask
from server.platform.settings import DataFolder, SetupError
from tests.proofs.lab.network import LabComputer
from tests.stack import ROOT
from tests.waiting import SECONDS, wait_for

MUCAT = str(Path(sys.executable).parent / "mucat")
DASK = str(Path(sys.executable).parent / "dask")
_POLL = 0.1


def wait_beside(condition: Callable[[], object], what: str) -> float:
    """Wait as `wait_for`, with pauses: the question takes processor time, which robots need."""

    def holds() -> bool:
        if condition():
            return True
        time.sleep(_POLL)
        return False

    return wait_for(holds, what)


def _has_ended(process: psutil.Process) -> bool:
    """Return True also for one that nobody has asked for its status."""
    try:
        return process.status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


class ComputerProgram:
    """A program in the foreground of a computer, as a person or systemd starts it."""

    def __init__(self, computer: LabComputer, log: Path, *command: str) -> None:
        self.computer, self.log = computer, log
        self.command = command
        self._popen: subprocess.Popen[bytes] | None = None

    @property
    def is_running(self) -> bool:
        """True until it ends."""
        return self._popen is not None and self._popen.poll() is None

    def start(self) -> None:
        """Start it, without waiting for anything."""
        self._popen = self.computer.call(self._open)

    def kill(self) -> None:
        """Kill it with -9, with all that it has started."""
        assert self._popen is not None
        process = psutil.Process(self._popen.pid)
        processes = [process, *process.children(recursive=True)]
        for each in processes:
            # So that none of them starts another one meanwhile.
            with suppress(psutil.NoSuchProcess):
                each.suspend()
        for each in processes:
            with suppress(psutil.NoSuchProcess):
                each.kill()
        self._popen.wait(SECONDS)
        wait_beside(lambda: all(map(_has_ended, processes)), "the end of all that was killed")

    def stop(self) -> int:
        """Press Ctrl-C, wait for the end, and return its exit status."""
        if self._popen is None:
            return 0
        if self.is_running:
            self._popen.send_signal(signal.SIGINT)
        return self.wait()

    def wait(self) -> int:
        """Wait for its end, and return its exit status."""
        assert self._popen is not None
        try:
            return self._popen.wait(SECONDS)
        except subprocess.TimeoutExpired:
            self.kill()
            raise AssertionError(f"it did not end: {self.read()[-4000:]}") from None

    def read(self) -> str:
        """Return what it has printed."""
        return self.log.read_text(errors="replace") if self.log.exists() else ""

    def _open(self) -> subprocess.Popen[bytes]:
        with self.log.open("ab") as log:
            return subprocess.Popen(
                self.command,
                cwd=ROOT,
                env={**os.environ, "PYTHONUNBUFFERED": "1"},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )


class MucatServer(ComputerProgram):
    """`mucat run` or `mucat lab run`, with a data folder and a robot.toml of its own."""

    def __init__(self, computer: LabComputer, folder: Path, config: str, *arguments: str) -> None:
        folder.mkdir()
        self.data = DataFolder(folder / "data")
        (folder / "robot.toml").write_text(config)
        self._where = ("--data", str(self.data.path), "--config", str(folder / "robot.toml"))
        super().__init__(computer, folder / "server.log", MUCAT, *arguments, *self._where)

    def ask(self, method: str, path: str, body: Mapping[str, Any] | None = None) -> Any:
        """Ask the server, on its own computer as a shell does. Raise SetupError."""
        return self.computer.call(ask, self.data, method, path, body)

    def shell(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run a command of `mucat` on this computer."""
        return self.computer.run(MUCAT, *arguments, *self._where)

    def insist(self, method: str, path: str, body: Mapping[str, Any] | None = None) -> Any:
        """Ask the server until it is not refused: after a start a sensor or a value may be awaited."""
        end = time.monotonic() + SECONDS
        while True:
            try:
                return self.ask(method, path, body)
            except SetupError:
                if time.monotonic() >= end:
                    raise
            time.sleep(_POLL)

    def wait_until(self, condition: Callable[[Any], object], path: str, what: str) -> float:
        """Wait until the answer to this question is so; return the time (s, steady clock)."""

        def holds() -> object:
            try:
                return condition(self.ask("GET", path))
            except SetupError:
                return False

        try:
            return wait_beside(holds, what)
        except AssertionError as problem:
            raise AssertionError(f"{problem}: {self.read()[-4000:]}") from problem


class SwimmingRobot(MucatServer):
    """A robot on an emulated board in simulated water, in real time."""

    def __init__(self, computer: LabComputer, folder: Path) -> None:
        config = f"""[robot]
name = "{computer.name}"
profile = "lean"
[vision]
camera = "card"
[server]
host = "0.0.0.0"
tls = true
"""
        super().__init__(computer, folder, config, "run")

    @property
    def is_armed(self) -> bool:
        """True while it is armed."""
        return bool(self.ask("GET", "/robot")["armed"])

    @property
    def is_in_a_lab(self) -> bool:
        """True while its lab is connected."""
        return bool(self.ask("GET", "/lab")["connected"])

    def wait_ready(self) -> None:
        """Wait until every part is well."""
        self.wait_until(lambda health: health["status"] == "ok", "/health", f"{self.computer.name}")

    def arm(self) -> None:
        """Acknowledge what there is, and arm it, watched by nobody; a recording begins."""
        refused: list[str] = []

        def arms() -> bool:
            try:
                self.ask("POST", "/control/take?over=true")
                self.ask("POST", "/robot/commands/acknowledge")
                self.ask("POST", "/robot/commands/arm", {"unwatched": 0})
            except SetupError as problem:
                refused.append(str(problem))
                return False
            return True

        try:
            wait_beside(arms, "the robot to arm")
        except AssertionError as problem:
            raise AssertionError(f"{problem}: {refused[-1]}") from problem
        self.ask("POST", "/control/release")

    def record(self, name: str, seconds: float) -> None:
        """Record a session of so long, disarmed."""
        session = self.insist("POST", "/sessions", {"name": name})["id"]
        time.sleep(seconds)
        self.insist("POST", f"/sessions/{session}/stop")
