"""A lab's router in a process of its own, and robots that dial it."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robot_runtime.transport.zenoh_transport import ZenohTransport
from server.features.roster.fleet_session import FleetSession
from server.platform.authority import Authority
from server.platform.lab_network import ALIVE, CLOCK, PRESENCE, ROBOTS, STOP, member_settings
from server.platform.settings import Settings


class LabRouter:
    """A router with its certificates; robots of these names are let in."""

    def __init__(self, settings: Settings, folder: Path, port: int, *robots: str) -> None:
        self.settings = settings
        self.folder = folder
        self.endpoint = f"tls/127.0.0.1:{port}"
        self.authority = Authority(settings, ROBOTS)
        self.authority.prepare()
        for robot in robots:
            self.authority.issue(robot, folder / robot)
        self.local = f"unixsock-stream/{settings.data.router_socket}"
        self.presences: list[tuple[str, bytes]] = []
        self.alive: dict[str, bool] = {}

    @contextmanager
    def running(self) -> Iterator[subprocess.Popen[bytes]]:
        """The router's process, once it listens."""
        process = self.start()
        try:
            yield process
        finally:
            process.terminate()
            process.communicate()

    def start(self) -> subprocess.Popen[bytes]:
        """Start the router, and return its process once it listens."""
        self.settings.data.router_socket.unlink(missing_ok=True)
        command = [sys.executable, "-m", "server.features.roster.router"]
        command += ["--certificates", str(self.settings.data.zenoh)]
        command += ["--listen", self.local, "--listen", self.endpoint]
        process = subprocess.Popen(command, stdout=subprocess.PIPE)
        assert process.stdout is not None
        assert "listening" in json.loads(process.stdout.readline())
        return process

    @contextmanager
    def lab(self) -> Iterator[FleetSession]:
        """The lab's end, which notes what it hears."""
        session = FleetSession(
            self.local,
            lambda robot, data: self.presences.append((robot, data)),
            self.alive.__setitem__,
        )
        try:
            yield session
        finally:
            session.close()

    def robot(self, name: str, certificate: Path | None = None) -> "RobotEnd":
        """Return a robot of this name that dials the router, with its own certificate or another."""
        return RobotEnd(name, self.endpoint, certificate or self.folder / name)


class RobotEnd:
    """A robot's end: it says how it is when it is told to, and counts the STOPs."""

    def __init__(self, name: str, endpoint: str, certificate: Path) -> None:
        self.stopped = 0
        self.ahead = 0.0
        self.messages = ZenohTransport(name, connect=[endpoint], network=member_settings(certificate))
        self.messages.serve(STOP, self._stop)
        self.messages.serve(CLOCK, lambda _: {"time": time.time() + self.ahead})
        self.messages.announce(ALIVE)

    def say(self, text: str) -> None:
        """Publish a presence."""
        self.messages.publish(PRESENCE, text.encode())

    def __enter__(self) -> "RobotEnd":
        return self

    def __exit__(self, *_: object) -> None:
        self.messages.close()

    def _stop(self, _: object) -> None:
        self.stopped += 1
