"""Cost and delay of every sample to every viewer, compared with foxglove-sdk."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median, quantiles
from time import monotonic, sleep
from typing import Self

import psutil

from bench.hub_ends import TOPICS
from bench.hub_viewers import OURS, THEIRS, Drain, TimedReading, TimedViewer
from server.features.bench.process_figures import cpu_seconds
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import free_port

_VIEWERS = (1, 10, 50)
_SETTLE = 3.0
_SECONDS = 1.5
_ROUNDS = 9
"""The median of so many counts, since a computer is not as quick at all times."""
_BEFORE_SECONDS, _STALL_SECONDS = 8.0, 15.0
"""The latter is enough that the buffers on the way are full and the server has noticed."""
_START_SECONDS = 240.0
_SOCKET_BYTES = 4096

Open = Callable[[], TimedViewer]


@dataclass
class _Figures:
    cpu_ms_per_1000: list[float] = field(default_factory=list)
    latencies: list[float] = field(default_factory=list)


def measure() -> dict[str, float]:
    """Measure 8 topics of 100 samples a second: CPU of the serving process in ms per 1,000 delivered samples,
    and ms from a sample to a viewer that has it.

    foxglove-sdk logs each sample as it is made, in the process that makes them; the server gets them from
    another process, as it does from the runtime. Both serve as many viewers at the same time, and their
    ratio is the median of those of several short times.
    """
    figures = {(who, many): _Figures() for who in ("hub", "foxglove") for many in _VIEWERS}
    with tempfile.TemporaryDirectory() as folder:
        data, port, other = Path(folder), free_port(), free_port()
        DataFolder(data).run.mkdir()
        with (
            process("server", folder, str(port), "server/page") as server,
            process("foxglove", str(other)) as foxglove,
            process("source", folder),
        ):
            ours, theirs = lambda: open_viewer(data, port), lambda: _theirs(other)
            wait_for_samples(ours)
            wait_for_samples(theirs)
            for many in _VIEWERS:
                with (
                    _Look(figures["hub", many], server, ours, many) as hub,
                    _Look(figures["foxglove", many], foxglove, theirs, many) as peer,
                ):
                    sleep(_SETTLE)
                    for _ in range(_ROUNDS):
                        hub.begin()
                        peer.begin()
                        sleep(_SECONDS)
                        hub.end()
                        peer.end()
            stalled = _stall(data, port, server)
    return _summary(figures) | stalled


def _summary(measured: dict[tuple[str, int], _Figures]) -> dict[str, float]:
    figures = {}
    for (who, many), entry in measured.items():
        percentiles = quantiles(entry.latencies, n=100)
        figures[f"{who}.cpu_ms_per_1000_delivered.{many}"] = median(entry.cpu_ms_per_1000)
        figures[f"{who}.latency_ms_p50.{many}"] = percentiles[49] * 1000
        figures[f"{who}.latency_ms_p99.{many}"] = percentiles[98] * 1000
    for many in _VIEWERS:
        ours, theirs = (measured[who, many].cpu_ms_per_1000 for who in ("hub", "foxglove"))
        figures[f"hub.ratio_to_foxglove.{many}"] = median(
            own / other for own, other in zip(ours, theirs, strict=True)
        )
    return figures


class _Look:
    """The viewers of a server: the first is timed, the bytes of the others are counted."""

    def __init__(self, figures: _Figures, server: psutil.Process, open_one: Open, many: int) -> None:
        self._figures, self._server = figures, server
        self._open_one, self._many = open_one, many
        self._before = (0, 0.0)

    def __enter__(self) -> Self:
        with ExitStack() as opened:
            self._watch = opened.enter_context(TimedReading(self._open_one()))
            self._drain = opened.enter_context(Drain(self._open_one, self._many - 1))
            self._opened = opened.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def begin(self) -> None:
        """Count from now on."""
        self._drain.check()
        self._watch.begin()
        self._before = self._drain.bytes, cpu_seconds(self._server.pid)

    def end(self) -> None:
        """Record the CPU time since `begin`, and the delay of each sample."""
        spent, drained = cpu_seconds(self._server.pid) - self._before[1], self._drain.bytes - self._before[0]
        self._drain.check()
        samples, size, latencies = self._watch.end()
        self._figures.cpu_ms_per_1000.append(spent * 1e6 / (samples * (1 + drained / size)))
        self._figures.latencies += latencies


def _stall(data: Path, port: int, server: psutil.Process) -> dict[str, float]:
    """Measure ten viewers, then an eleventh that never reads: its effect on the ten, and on memory."""
    figures = {}
    with TimedReading(open_viewer(data, port)) as watch, Drain(lambda: open_viewer(data, port), 9):
        sleep(_SETTLE)
        stalled: list[TimedViewer] = []
        for name in ("before", "stalled"):
            if name == "stalled":
                stalled.append(open_viewer(data, port, receive_bytes=_SOCKET_BYTES))
            watch.begin()
            memory = server.memory_info().rss
            sleep(_BEFORE_SECONDS if name == "before" else _STALL_SECONDS)
            figures[f"hub.{name}_latency_ms_p50"] = quantiles(watch.end()[2], n=100)[49] * 1000
            figures[f"hub.{name}_growth_mb"] = (server.memory_info().rss - memory) / 1e6
        for viewer in stalled:
            viewer.close()
    return figures


def open_viewer(data: Path, port: int, receive_bytes: int | None = None) -> TimedViewer:
    headers = shell_headers(DataFolder(data)) | {"origin": f"http://127.0.0.1:{port}"}
    return TimedViewer(f"ws://127.0.0.1:{port}/api/live", OURS, headers, receive_bytes)


def _theirs(port: int) -> TimedViewer:
    viewer = TimedViewer(f"ws://127.0.0.1:{port}", THEIRS, {"sec-websocket-protocol": "foxglove.sdk.v1"})
    channels: list[int] = []
    for message in viewer.messages():
        if isinstance(message, str) and (advertisement := json.loads(message))["op"] == "advertise":
            channels += [
                channel["id"] for channel in advertisement["channels"] if channel["encoding"] == "row"
            ]
        if len(channels) == len(TOPICS):
            break
    subscriptions = [{"id": number, "channelId": channel} for number, channel in enumerate(channels)]
    viewer.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))
    return viewer


def wait_for_samples(open_one: Open) -> None:
    """Wait until a viewer gets samples. Raise OSError where none does."""
    end = monotonic() + _START_SECONDS
    while True:
        try:
            viewer = open_one()
            if any(not isinstance(message, str) for message in viewer.messages()):
                return viewer.close()
        except OSError:
            if monotonic() > end:
                raise
            sleep(0.2)


@contextmanager
def process(*role: str) -> Iterator[psutil.Process]:
    # foxglove-sdk logs every viewer that disconnects, at length.
    command = [sys.executable, "-m", "bench.hub_ends", *role]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL)
    try:
        yield psutil.Process(process.pid)
    finally:
        assert process.stdin is not None
        process.stdin.close()
        process.wait(60)
