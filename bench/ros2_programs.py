"""Programs of ROS 2 at the robot's door: sessions of Zenoh with certificates of the robot."""

import json
import select
import socket
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from struct import Struct
from time import monotonic, sleep
from typing import Any, Self

import httpx
import zenoh

from bench.connected_programs import END_SECONDS, steady_time
from server.features.doors.config import DoorsConfig
from server.http.sign_in.tokens import digest
from server.platform.authority import Authority
from server.platform.settings import Settings
from tests.shell import ShellAuth

_TOPICS = ("imu/data", "pressure")
"""Those whose messages begin with the time of their sample."""
_MORE = ("depth", "temperature", "battery", "joint_states", "beacon/left", "beacon/right")
_STAMP = Struct("<4xiI")
_PROGRAMS_OF_CERTIFICATE = 6
"""The robot admits 8 connections of one."""
_SECONDS = 30.0


def issue(settings: Settings, name: str) -> Path:
    """Return the folder of a new certificate for a reading program, from the server with `settings`."""
    with httpx.Client(
        base_url=f"http://127.0.0.1:{settings.server.port}/api", auth=ShellAuth(settings.data)
    ) as api:
        answer = api.post("/access/tokens", json={"name": name, "scope": "read"})
    folder = settings.data.path / name
    Authority(settings).issue_program(digest(answer.raise_for_status().json()["token"]), folder)
    return folder


class ZenohDoor:
    """The door of a server: opens programs, each of which subscribes to attitude and pressure."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._certificates: list[Path] = []

    def open_one(
        self,
        number: int,
        receive: Callable[[zenoh.Sample], None],
        topics: Sequence[str] = _TOPICS,
        address: tuple[str, int] | None = None,
    ) -> "zenoh.Session":
        """Open a session, at another address perhaps. Raise OSError."""
        while len(self._certificates) <= number // _PROGRAMS_OF_CERTIFICATE:
            self._certificates.append(issue(self._settings, f"program-{len(self._certificates)}"))
        host, port = address or self._settings.section(DoorsConfig).ros2_address
        folder = self._certificates[number // _PROGRAMS_OF_CERTIFICATE]
        try:
            session = zenoh.open(_configuration(folder, f"tls/{host}:{port}"))
        except zenoh.ZError as problem:
            raise ConnectionError(f"The door for ROS 2 admits no program: {problem}") from problem
        for topic in topics:
            session.declare_subscriber(f"0/{topic}/**", receive)
        return session

    @contextmanager
    def programs(self, many: int) -> Iterator["Ros2Programs"]:
        """Yield so many programs, once each of them gets samples."""
        programs = Ros2Programs(many)
        with ExitStack() as opened:
            for number in range(many):
                session = self.open_one(number, programs.receiver(number))
                opened.callback(session.close)
            programs.wait()
            yield programs

    @contextmanager
    def stalled(self) -> Iterator[None]:
        """Run another program, which subscribes to more and whose connection nobody reads.

        Raise ConnectionError where it is not disconnected.
        """
        came = threading.Event()
        with _Relay(self._settings.section(DoorsConfig).ros2_address) as relay:
            session = self.open_one(
                2 * _PROGRAMS_OF_CERTIFICATE, lambda _: came.set(), _TOPICS + _MORE, relay.address
            )
            try:
                if not came.wait(_SECONDS):
                    raise ConnectionError("a program of ROS 2 gets no samples")
                relay.reading.clear()
                yield
                relay.require_end()
            finally:
                session.close()  # type: ignore[no-untyped-call]


class Ros2Programs:
    """The messages of programs, counted; those of the first are timed."""

    def __init__(self, many: int) -> None:
        self._counts = [0] * many
        self._begun = 0
        self._latencies: list[float] = []

    def receiver(self, number: int) -> Callable[[zenoh.Sample], None]:
        """Take the messages of a program, in Zenoh's thread."""

        def count(_: zenoh.Sample) -> None:
            self._counts[number] += 1

        def look(sample: zenoh.Sample) -> None:
            now = monotonic()
            seconds, rest = _STAMP.unpack_from(sample.payload.to_bytes())
            self._latencies.append(now - steady_time(seconds + rest / 1e9))
            self._counts[number] += 1

        return count if number else look

    def wait(self) -> None:
        """Wait until each has a message. Raise ConnectionError."""
        end = monotonic() + _SECONDS
        while not all(self._counts):
            if monotonic() > end:
                raise ConnectionError("a program of ROS 2 gets no samples")
            sleep(0.01)

    def begin(self) -> None:
        """Count from now on."""
        self._begun, self._latencies = sum(self._counts), []

    def end(self) -> tuple[list[float], float]:
        """Return the delay of each message of the first program since `begin`, s, and the number of all."""
        return self._latencies, sum(self._counts) - self._begun


class _Relay:
    """A relay of the bytes of one connection; to the program only while `reading` is set."""

    def __init__(self, door: tuple[str, int]) -> None:
        self.reading = threading.Event()
        self.reading.set()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address: tuple[str, int] = self._listener.getsockname()[:2]
        self._door = door
        self._closed = threading.Event()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closed.set()
        self._thread.join()
        self._listener.close()

    def require_end(self) -> None:
        """Read to the end. Raise ConnectionError where the door has not ended the connection."""
        self.reading.set()
        if not self._ended.wait(END_SECONDS):
            raise ConnectionError("a program that reads nothing is still connected")

    def _run(self) -> None:
        program, _ = self._listener.accept()
        with program, socket.create_connection(self._door) as door:
            there = [program]
            while not self._closed.is_set():
                sources = [*there, door] if self.reading.is_set() else there
                for ready in select.select(sources, [], [], 0.05)[0]:
                    try:
                        data = ready.recv(65_536)
                    except OSError:
                        data = b""
                    if data and (ready is program or there):
                        (door if ready is program else program).sendall(data)
                    elif not data and ready is program:
                        there = []  # Zenoh leaves after 10 s without a message; the connection stays
                    elif not data:
                        self._ended.set()
                        return


def _configuration(folder: Path, endpoint: str) -> zenoh.Config:
    config = zenoh.Config()
    values: dict[str, Any] = {
        "mode": "client",
        "scouting/multicast/enabled": False,
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": int(1000 * _SECONDS),
        "transport/link/tls": {
            "root_ca_certificate": str(folder / "authority.pem"),
            "connect_certificate": str(folder / "certificate.pem"),
            "connect_private_key": str(folder / "key.pem"),
            "enable_mtls": True,
            "verify_name_on_connect": False,
        },
    }
    for key, value in values.items():
        config.insert_json5(key, json.dumps(value))
    return config
