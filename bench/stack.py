"""Processor time, memory and control jitter of a robot at full rate, recording, with one viewer."""

import tempfile
import threading
import time
from pathlib import Path

import psutil
from websockets.sync.client import connect
from websockets.typing import Origin

from bench import jitter
from bench.hour import copy_hours
from server.platform.pidfile import running_parts
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import Stack

_SETTLE = 5.0
_SECONDS = 30.0
_JITTER_SECONDS = 100.0
"""Of each phase: at 10 Hz a thousand ticks, of which the worst is the p999."""


def measure() -> dict[str, float]:
    """CPU in percent of one core over half a minute; resident memory in MB at its end; ms by which the time
    between two control ticks differs from their period, idle and while exporting and rendering.
    """
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        (hour,) = copy_hours(data)
        with Stack(data) as stack:
            viewer = _Viewer(stack)
            # Before arming, which would begin a recording of its own.
            recording = {"name": "bench"}
            session = stack.api.post("/sessions", json=recording).raise_for_status().json()["id"]
            stack.arm()
            time.sleep(_SETTLE)
            began = time.monotonic()
            found = _load(stack, viewer)
            phases = {"idle": _phase(began)}
            with jitter.busy(stack, hour):
                time.sleep(_SETTLE)
                phases["busy"] = _phase(time.monotonic())
            viewer.close()
            stack.api.post("/robot/stop").raise_for_status()
            stack.api.post(f"/sessions/{session}/stop")
        return found | jitter.figures(data, session, phases)


def _load(stack: Stack, viewer: "_Viewer") -> dict[str, float]:
    running = running_parts(DataFolder(stack.data).run)
    parts = {name: psutil.Process(running[name].pid) for name in ("runtime", "board", "simulator")}
    parts["server"] = stack.server
    before = {name: cpu_seconds(process) for name, process in parts.items()}
    received = viewer.bytes
    time.sleep(_SECONDS)
    cpu = {name: (cpu_seconds(process) - before[name]) / _SECONDS * 100 for name, process in parts.items()}
    figures = {f"cpu.{name}_percent": value for name, value in cpu.items()}
    figures["cpu.robot_stack_percent"] = cpu["server"] + cpu["runtime"]
    figures["stream.viewer_kb_per_s"] = (viewer.bytes - received) / _SECONDS / 1000
    figures["rss.server_mb"] = parts["server"].memory_info().rss / 1e6
    figures["rss.runtime_mb"] = parts["runtime"].memory_info().rss / 1e6
    return figures


def _phase(began: float) -> tuple[float, float]:
    """Waits for the end of a phase that began then; returns its times."""
    end = began + _JITTER_SECONDS
    time.sleep(max(end - time.monotonic(), 0.0))
    return began, end


class _Viewer:
    """A client that reads everything, as a page does."""

    def __init__(self, stack: Stack) -> None:
        self.bytes = 0
        self._socket = connect(
            f"ws://127.0.0.1:{stack.port}/api/live",
            origin=Origin(stack.url),
            additional_headers=shell_headers(DataFolder(stack.data)),
            max_size=None,
            proxy=None,
        )
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._socket.close()
        self._thread.join()

    def _read(self) -> None:
        for message in self._socket:
            self.bytes += len(message)


def cpu_seconds(process: psutil.Process) -> float:
    """s on a processor. The scheduler's own count: the usual one sees only who runs when the clock ticks."""
    tasks = Path(f"/proc/{process.pid}/task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) * 1e-9
