"""Measurements of a robot's software on this computer: its start, and a recording with a viewer."""

import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import quantiles

from robot_runtime.contract.topics import CONTROL, EVENT
from server.features.bench.live_viewer import LiveViewer
from server.features.bench.process_figures import anonymous_mb, core_percent, cpu_seconds, family
from server.features.bench.robot_processes import OUTSIDE, find_processes
from server.library.content import Recording
from server.platform.folder_lock import runner_of
from server.platform.running_server import ask
from server.platform.settings import DataFolder, SetupError
from server.platform.shell_store import open_reader
from server.recording.session import find_row

SETTLE = 3.0
"""s between the recording's start and the measurement."""
START_SECONDS = 600.0
"""s; a Raspberry Pi Zero W takes minutes while it has something else to do."""
_LOOK = 0.2
_STORED_LOOK, _STORED_LOOKS = 1.0, 30
"""s between two looks whether all is stored, and their number."""
_NAME = "mucat bench"


@dataclass(frozen=True, slots=True, kw_only=True)
class StartFigures:
    """A server's start: s until its page is there, and s of processor time until then."""

    page_s: float
    cpu_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadFigures:
    """The figures of a recording with one viewer, of `seconds`.

    `percent` of a core and anonymous memory in `mb` are by process. `period_ms` is the median of the time
    between two control ticks, `jitter_ms` by how much that time differs from it: p50, p99 and the most.
    """

    seconds: float
    percent: dict[str, float]
    mb: dict[str, float]
    period_ms: float
    jitter_ms: tuple[float, float, float]
    ticks: int
    samples: int
    samples_lost: int
    viewer_kb_per_s: float
    viewer_left_out: int
    alarms: tuple[str, ...]

    @property
    def robot_percent(self) -> float:
        """% of a core of all that runs on a robot: without emulated board and simulated water."""
        return sum(value for name, value in self.percent.items() if name not in OUTSIDE)

    @property
    def robot_mb(self) -> float:
        """MB of anonymous memory of all that runs on a robot."""
        return sum(value for name, value in self.mb.items() if name not in OUTSIDE)


def measure_start() -> StartFigures:
    """Start a second server, without a robot and with data of its own, and end it. Raise SetupError."""
    with tempfile.TemporaryDirectory(prefix="mucat-bench-") as name:
        folder, port = Path(name), _free_port()
        config, log = folder / "robot.toml", folder / "log"
        # A name of its own: it must not hear or tell the robot that runs.
        config.write_text(f'[robot]\nname = "bench-{port}"\nmode = "robot"\n[vision]\ncamera = "card"\n')
        command = [
            sys.executable, "-m", "server.cli", "run", "--external-runtime", "--port", str(port),
            "--config", str(config), "--data", str(folder / "data"),
        ]  # fmt: skip
        began = time.monotonic()
        with log.open("wb") as file, subprocess.Popen(command, stdout=file, stderr=file) as process:
            try:
                while not _answers(port):
                    if process.poll() is not None or time.monotonic() - began > START_SECONDS:
                        raise SetupError(f"A server does not start here:\n{log.read_text(errors='replace')}")
                    time.sleep(_LOOK)
                page = time.monotonic() - began
                spent = sum(map(cpu_seconds, family(process.pid)))
            finally:
                process.terminate()
        return StartFigures(page_s=page, cpu_s=spent)


def measure_load(folder: DataFolder, seconds: float, tell: Callable[[str], None]) -> LoadFigures:
    """Measure a recording with a viewer on the running server. Raise SetupError."""
    runner = runner_of(folder)
    if runner is None:
        raise SetupError(f"No robot runs on {folder.path}. Start it with `mucat run`, or as a service.")
    with _recording(folder) as session, LiveViewer(folder) as viewer:
        tell(f"A session is recorded for {seconds + SETTLE:.0f} s, with a viewer ...")
        time.sleep(SETTLE)
        processes = find_processes(runner, folder.run)
        began, received = time.monotonic(), viewer.bytes
        percent = core_percent(processes, seconds)
        lasted = time.monotonic() - began
        received = viewer.bytes - received
        mb = {name: anonymous_mb(pid) for name, pid in processes.items()}
        left_out = viewer.left_out
        ticks, alarms = _read(folder, session, began, began + lasted)
        detail = ask(folder, "GET", f"/sessions/{session}")
    periods = [1000 * (b - a) for a, b in pairwise(ticks)]
    period = quantiles(periods, n=2)[0]
    errors = [abs(value - period) for value in periods]
    percentiles = quantiles(errors, n=100)
    return LoadFigures(
        seconds=lasted,
        percent=percent,
        mb=mb,
        period_ms=period,
        jitter_ms=(percentiles[49], percentiles[98], max(errors)),
        ticks=len(ticks),
        samples=detail["samples"],
        samples_lost=sum(gap["missed"] for gap in detail["gaps"]),
        viewer_kb_per_s=received / lasted / 1000,
        viewer_left_out=left_out,
        alarms=alarms,
    )


@contextmanager
def _recording(folder: DataFolder) -> Iterator[int]:
    """Yield the session that records: one that is there, or else a new one, which is removed at the end."""
    newest = ask(folder, "GET", "/sessions?limit=1")
    if newest and newest[0]["state"] == "recording":
        yield int(newest[0]["id"])
        return
    session = int(ask(folder, "POST", "/sessions", {"name": _NAME})["id"])
    try:
        yield session
    finally:
        for method, path in (("POST", "/stop"), ("DELETE", ""), ("POST", "/purge")):
            with suppress(SetupError):
                ask(folder, method, f"/sessions/{session}{path}")


def _read(folder: DataFolder, session: int, start: float, end: float) -> tuple[list[float], tuple[str, ...]]:
    """Return the times of control's ticks, and the texts of alarms that began, once they are stored."""
    for _ in range(_STORED_LOOKS):
        time.sleep(_STORED_LOOK)
        with open_reader(folder) as store:
            recording = Recording(store, find_row(store, session))
            if CONTROL.name not in recording.topics:
                continue
            times = recording.columns(CONTROL.name, [], start)[0].tolist()
            if times and times[-1] > end:
                alarms = [
                    str(event["text"])
                    for event in recording.documents(EVENT.name, start, end)
                    if event["severity"] == "alarm"
                ]
                return [moment for moment in times if start <= moment <= end], tuple(alarms)
    raise SetupError("The runtime's control stores nothing: `mucat doctor` says what is the matter.")


def _answers(port: int) -> bool:
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=START_SECONDS) as answer:
            return bool(answer.status == 200)
    except (urllib.error.URLError, OSError):
        return False


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
