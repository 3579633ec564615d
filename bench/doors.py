"""Cost and delay of the doors for other programs, and the effect of one that reads nothing on the others.

Each program subscribes to attitude and depth, 100 samples a second of each. One of ROS 2 subscribes to
pressure in place of depth, which has no time there.
"""

import tempfile
from pathlib import Path
from statistics import median, quantiles
from time import sleep

import psutil

from bench.connected_programs import ConnectedPrograms, ProgramDoor
from bench.hub import process
from bench.ros2_programs import ZenohDoor
from bench.websocket_programs import foxglove_door, rosbridge_door
from server.features.bench.process_figures import core_percent, cpu_seconds
from server.features.doors.config import DoorsConfig
from server.platform.authority import Authority
from server.platform.server_config import ServerConfig
from server.platform.settings import DataFolder, Settings
from tests.stack import free_port

_SETTLE = 1.0
_SECONDS = 4.0
_ROUNDS = 3
_WINDOW_SECONDS = 1.8
"""The p95 of longer times would hold more of what else the computer does: those compared are alike."""
_BESIDE_WINDOWS = 6
"""Enough that the buffers on the way are full and the server has disconnected the one that reads nothing."""
_MANY = 10


def measure() -> dict[str, float]:
    """Return latency (ms, from the sample to a program that has it) and CPU of each door."""
    with tempfile.TemporaryDirectory() as folder:
        ros2 = f"tls/127.0.0.1:{free_port()}"
        settings = Settings(
            data=DataFolder(Path(folder)),
            config=Path("robot.toml"),
            sections={
                ServerConfig: ServerConfig(port=free_port()),
                DoorsConfig: DoorsConfig(rosbridge=True, foxglove=True, ros2=True, ros2_listen=ros2),
            },
        )
        settings.data.run.mkdir()
        Authority(settings).prepare()
        with (
            process("doors", folder, str(settings.server.port), "server/page", ros2) as server,
            process("source", folder),
        ):
            rosbridge, foxglove = rosbridge_door(settings), foxglove_door(settings)
            rosbridge.wait()
            foxglove.wait()
            sleep(_SETTLE)
            figures = {"doors.idle_cpu_percent": _idle(server)}
            doors: dict[str, ProgramDoor] = {
                "rosbridge": rosbridge,
                "foxglove": foxglove,
                "ros2": ZenohDoor(settings),
            }
            for name, door in doors.items():
                results = _look_at_one(server, door) | _look_at_many(server, door)
                figures |= {f"doors.{name}.{figure}": value for figure, value in results.items()}
    return figures


def _idle(server: psutil.Process) -> float:
    return core_percent({"server": server.pid}, _SECONDS)["server"]


class _Count:
    """The sum of the times in which programs were measured."""

    def __init__(self, server: psutil.Process) -> None:
        self._server = server
        self._latencies: list[float] = []
        self._spent = self._delivered = self._seconds = 0.0
        self.p95s: list[float] = []
        """Of the latency in each of these times, ms."""

    def go_on(self, programs: ConnectedPrograms, seconds: float) -> None:
        """Measure for so many s."""
        spent = cpu_seconds(self._server.pid)
        programs.begin()
        sleep(seconds)
        latencies, delivered = programs.end()
        self._spent += cpu_seconds(self._server.pid) - spent
        self._seconds += seconds
        self._latencies += latencies
        self._delivered += delivered
        self.p95s.append(_p95(latencies))

    def figures(self, many: int) -> dict[str, float]:
        """Return the figures of so many programs."""
        return {
            f"latency_ms_p50.{many}": 1000 * median(self._latencies),
            f"latency_ms_p95.{many}": _p95(self._latencies),
            f"cpu_percent.{many}": 100 * self._spent / self._seconds,
            f"cpu_ms_per_1000_delivered.{many}": self._spent * 1e6 / self._delivered,
        }


def _look_at_one(server: psutil.Process, door: ProgramDoor) -> dict[str, float]:
    count = _Count(server)
    with door.programs(1) as programs:
        sleep(_SETTLE)
        count.go_on(programs, _SECONDS)
    return count.figures(1)


def _look_at_many(server: psutil.Process, door: ProgramDoor) -> dict[str, float]:
    """Measure ten programs, by turns alone and beside an eleventh that reads nothing.

    A busy computer makes both slower; only what the eleventh does is in the ratio. The ten connect again for
    each turn, since those of WebSockets answer no ping and are disconnected after 40 s.
    """
    alone, beside = _Count(server), _Count(server)
    for _ in range(_ROUNDS):
        with door.programs(_MANY) as programs:
            sleep(_SETTLE)
            alone.go_on(programs, _WINDOW_SECONDS)
            with door.stalled():
                for _ in range(_BESIDE_WINDOWS):
                    beside.go_on(programs, _WINDOW_SECONDS)
            alone.go_on(programs, _WINDOW_SECONDS)
    without, stalled = median(alone.p95s), median(beside.p95s)
    return alone.figures(_MANY) | {
        "unstalled_latency_ms_p95": without,
        "stalled_latency_ms_p95": stalled,
        "stalled_ratio": stalled / without,
    }


def _p95(latencies: list[float]) -> float:
    return 1000 * quantiles(latencies, n=100)[94]
