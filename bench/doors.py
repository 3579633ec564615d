"""Cost and delay of the doors for other programs, and what one that reads nothing does to the others.

Each program subscribes to attitude and depth, 100 samples a second of each.
"""

import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import quantiles
from struct import Struct
from time import monotonic, sleep, time

import psutil

from bench.hub import process
from bench.hub_viewers import Drain, HealthMonitor, Viewer
from bench.processes import cpu_seconds
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import free_port

_PROGRAMS = (1, 10)
_SETTLE = 3.0
_SECONDS, _STALL_SECONDS = 8.0, 12.0
"""The latter is enough that the buffers on the way are full and the server has disconnected it."""
_START_SECONDS = 240.0
_SOCKET_BYTES = 4096
_END_SECONDS = 5.0
_FOXGLOVE = Struct("<BIQ")
"""Before a message: an opcode, the subscription, the time (ns)."""

Open = Callable[[int | None], Viewer]


def measure() -> dict[str, float]:
    """Latency (ms, from the sample to a program that has it) and CPU of each door."""
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        data, port = Path(folder), free_port()
        DataFolder(data).run.mkdir()
        with process("doors", folder, str(port), "server/page") as server, process("source", folder):
            doors: dict[str, Open] = {
                "rosbridge": lambda size: _rosbridge(data, port, size),
                "foxglove": lambda size: _foxglove(data, port, size),
            }
            for open_one in doors.values():
                _wait_for_samples(open_one)
            sleep(_SETTLE)
            figures["doors.idle_cpu_percent"] = _idle(server)
            for name, open_one in doors.items():
                for many in _PROGRAMS:
                    found = _look(server, open_one, many)
                    figures |= {f"doors.{name}.{figure}.{many}": value for figure, value in found.items()}
                without, beside = _look_beside_stalled(open_one)
                figures[f"doors.{name}.unstalled_latency_ms_p95"] = without
                figures[f"doors.{name}.stalled_latency_ms_p95"] = beside
    return figures


def _idle(server: psutil.Process) -> float:
    before = cpu_seconds(server)
    sleep(_SECONDS)
    return 100 * (cpu_seconds(server) - before) / _SECONDS


def _look(server: psutil.Process, open_one: Open, many: int) -> dict[str, float]:
    with HealthMonitor(open_one(None)) as timed, Drain(lambda: open_one(None), many - 1) as drain:
        sleep(_SETTLE)
        timed.begin()
        spent, drained = cpu_seconds(server), drain.bytes
        sleep(_SECONDS)
        samples, size, latencies = timed.end()
        spent, drained = cpu_seconds(server) - spent, drain.bytes - drained
        drain.check()
    percentiles = quantiles(latencies, n=100)
    return {
        "latency_ms_p50": 1000 * percentiles[49],
        "latency_ms_p95": 1000 * percentiles[94],
        "cpu_percent": 100 * spent / _SECONDS,
        "cpu_ms_per_1000_delivered": spent * 1e6 / (samples * (1 + drained / size)),
    }


def _look_beside_stalled(open_one: Open) -> tuple[float, float]:
    """The p95 of ten programs, and from the moment when an eleventh comes that reads nothing."""
    with HealthMonitor(open_one(None)) as timed, Drain(lambda: open_one(None), 9) as drain:
        sleep(_SETTLE)
        timed.begin()
        sleep(_STALL_SECONDS)
        without = timed.end()[2]
        stalled = open_one(_SOCKET_BYTES)
        timed.begin()
        sleep(_STALL_SECONDS)
        beside = timed.end()[2]
        drain.check()
    _require_end(stalled)
    without_p95, beside_p95 = (1000 * quantiles(found, n=100)[94] for found in (without, beside))
    return without_p95, beside_p95


def _require_end(stalled: Viewer) -> None:
    """Read what is left of a program that was disconnected. Raises ConnectionError where it was not."""
    end = monotonic() + _END_SECONDS
    for _ in stalled.messages():
        if monotonic() > end:
            raise ConnectionError("a program that reads nothing is still connected")
    stalled.close()


def _rosbridge(data: Path, port: int, receive_bytes: int | None) -> Viewer:
    headers = shell_headers(DataFolder(data))
    viewer = Viewer(f"ws://127.0.0.1:{port}/rosbridge", _stamps, headers, receive_bytes)
    for topic in ("/imu/data", "/mucat/depth"):
        viewer.send(json.dumps({"op": "subscribe", "topic": topic}))
    return viewer


def _foxglove(data: Path, port: int, receive_bytes: int | None) -> Viewer:
    headers = shell_headers(DataFolder(data)) | {"sec-websocket-protocol": "foxglove.websocket.v1"}
    viewer = Viewer(f"ws://127.0.0.1:{port}/foxglove", _times, headers, receive_bytes)
    channels = _channels(viewer)
    wanted = [{"id": place, "channelId": channels[topic]} for place, topic in enumerate(("/imu", "/depth"))]
    viewer.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
    return viewer


def _channels(viewer: Viewer) -> dict[str, int]:
    """The numbers of the channels. Raises OSError where the connection ends before."""
    for message in viewer.messages():
        if isinstance(message, str) and (said := json.loads(message))["op"] == "advertise":
            return {one["topic"]: one["id"] for one in said["channels"]}
    raise ConnectionError("the door was closed before it listed its channels")


def _stamps(message: str | bytes) -> list[float]:
    said = json.loads(message)
    if said["op"] != "publish":
        return []
    stamp = said["msg"].get("stamp") or said["msg"]["header"]["stamp"]
    return [_steady(stamp["sec"] + stamp["nanosec"] / 1e9)]


def _times(message: str | bytes) -> list[float]:
    if isinstance(message, str) or message[0] != 1:
        return []
    return [_steady(_FOXGLOVE.unpack_from(message)[2] / 1e9)]


def _steady(utc: float) -> float:
    """A moment of UTC on the steady clock, s."""
    return utc - time() + monotonic()


def _wait_for_samples(open_one: Open) -> None:
    """Wait until a program gets samples. Raises OSError where none does."""
    end = monotonic() + _START_SECONDS
    while True:
        try:
            viewer = open_one(None)
            if any(viewer.times(message) for message in viewer.messages()):
                return viewer.close()
        except OSError:
            if monotonic() > end:
                raise
            sleep(0.2)
