"""The whole robot as a person starts it: `mucat run` on a loopback port, with a data folder of its own."""

import os
import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import httpx
import psutil

from server.platform.pidfile import running_parts
from server.platform.settings import DataFolder
from tests.control import Commander
from tests.shell import ShellAuth
from tests.waiting import SECONDS

ROOT = Path(__file__).resolve().parents[1]
_POLL = 0.1
_PORTS = range(20_000, 32_000)
"""Below those that Linux gives to outgoing connections, which could take a port before the server does."""


def free_port() -> int:
    """Return a TCP port of the loopback that nobody uses; a server can restart on it."""
    for port in random.sample(_PORTS, len(_PORTS)):
        with socket.socket() as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise AssertionError(f"all ports from {_PORTS.start} to {_PORTS.stop} are in use")


class Stack:
    """A running robot; leaving the context ends it and everything it started."""

    program = Path(sys.executable).parent / "mucat"
    folder = ROOT
    environment: Mapping[str, str] = {}

    def __init__(self, data: Path, *options: str) -> None:
        self.data = data
        self.port = free_port()
        self.url = self.first = f"http://127.0.0.1:{self.port}"
        self.log = data / "stack.log"
        self._options = options
        self._process: subprocess.Popen[bytes] | None = None
        self.api = Commander(base_url=f"{self.url}/api", timeout=SECONDS, auth=ShellAuth(DataFolder(data)))

    def __enter__(self) -> Self:
        self.start()
        try:
            self.wait_ready()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    @property
    def process(self) -> psutil.Process:
        """The process that was started: the runner of the server."""
        assert self._process is not None
        return psutil.Process(self._process.pid)

    @property
    def server(self) -> psutil.Process:
        """The process that serves, or will in a moment."""
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            for process in psutil.process_iter():
                with suppress(psutil.NoSuchProcess):
                    if process.name() == "mucat-server" and str(self.port) in process.cmdline():
                        return process
            time.sleep(_POLL)
        raise AssertionError("no server comes")

    def start(self) -> None:
        """Start `mucat run` without waiting for anything."""
        self.data.mkdir(parents=True, exist_ok=True)
        command = [
            str(self.program),
            "run",
            "--port",
            str(self.port),
            *self._options,
        ]
        environment = {
            **os.environ,
            "MUCAT_DATA": str(self.data),
            "PYTHONUNBUFFERED": "1",
            **self.environment,
        }
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                command,
                cwd=self.folder,
                env=environment,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def wait_ready(self) -> None:
        """Wait until every part is well."""
        end = time.monotonic() + SECONDS
        health: dict[str, Any] = {}
        while time.monotonic() < end:
            assert self._process is not None
            if self._process.poll() is not None:
                break
            try:
                health = self.api.get("/health").json()
            except httpx.TransportError:
                health = {}
            if health.get("status") == "ok":
                return
            time.sleep(_POLL)
        raise AssertionError(f"not ready: {health}\n{self.log.read_text(errors='replace')[-4000:]}")

    def calm(self) -> None:
        """Disarm, acknowledge, end a recording, and wait until every part is well and arming is possible."""
        self.wait_ready()
        self._insist("/robot/stop")
        end = time.monotonic() + SECONDS
        while True:
            self._insist("/robot/commands/acknowledge")
            state = self.api.get("/robot").json()
            recording = [
                session["id"]
                for session in self.api.get("/sessions").json()
                if session["state"] == "recording"
            ]
            if not (state["armed"] or state["refusals"] or recording):
                return
            for session in recording:
                # Refused where it has just ended by itself, as that of an arming does.
                self.api.post(f"/sessions/{session}/stop")
            assert time.monotonic() < end, (state, recording)
            time.sleep(_POLL)

    def arm(self) -> None:
        """Arm as soon as nothing speaks against it; after a start, a sensor or a value may be awaited.

        No page is open here, and none is needed.
        """
        # 409: something speaks against it.
        self._insist("/robot/commands/arm", 409, body={"unwatched": 0})

    def _insist(self, path: str, *refusals: int, body: dict[str, Any] | None = None) -> None:
        """Give a command until it is taken, where it is refused so, or the runtime is silent (503, 504)."""
        end = time.monotonic() + SECONDS
        while (answer := self.api.post(path, json=body)).status_code in (503, 504, *refusals):
            assert time.monotonic() < end, answer.text
            time.sleep(_POLL)
        answer.raise_for_status()

    def child(self, word: str) -> psutil.Process:
        """Return the started process whose command line holds `word`."""
        results = [
            process
            for process in self.process.children(recursive=True)
            if word in " ".join(process.cmdline())
        ]
        assert len(results) == 1, f"{len(results)} processes with {word}"
        return results[0]

    def part(self, name: str) -> psutil.Process:
        """Return the running part of this name, whichever server has started it; "vision" is the runtime's
        own.

        Raise LookupError where there is none.
        """
        if name == "vision":
            results = [
                process
                for process in self.part("runtime").children()
                if "robot_runtime.vision" in process.cmdline()
            ]
            return results[0]
        return psutil.Process(running_parts(DataFolder(self.data).run)[name].pid)

    def kill(self) -> None:
        """Kill the server alone, with -9; its runner starts the next one."""
        server = self.server
        server.kill()
        psutil.wait_procs([server])

    def stop(self) -> None:
        """Press Ctrl-C and wait for the end."""
        self.api.close()
        if self._process is None:
            return
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(SECONDS)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            raise AssertionError(f"Ctrl-C did not end it:\n{self.log.read_text()[-4000:]}") from None
