"""Processor time and memory of runtime and server at full rate, recording, with one viewer."""

import tempfile
import threading
import time
from pathlib import Path

import psutil
from websockets.sync.client import connect
from websockets.typing import Origin

from server.platform.pidfile import running_parts
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import Stack

_SETTLE = 5.0
_SECONDS = 30.0


def measure() -> dict[str, float]:
    """CPU in percent of one core over half a minute; resident memory in MB at its end."""
    with tempfile.TemporaryDirectory() as folder, Stack(Path(folder)) as stack:
        viewer = _Viewer(stack)
        stack.arm()
        stack.api.post("/sessions", json={"name": "bench"}).raise_for_status()
        running = running_parts(DataFolder(stack.data).run)
        parts = {name: psutil.Process(running[name].pid) for name in ("runtime", "board", "simulator")}
        parts["server"] = stack.server
        time.sleep(_SETTLE)
        before = {name: cpu_seconds(process) for name, process in parts.items()}
        received = viewer.bytes
        time.sleep(_SECONDS)
        cpu = {
            name: (cpu_seconds(process) - before[name]) / _SECONDS * 100 for name, process in parts.items()
        }
        figures = {f"cpu.{name}_percent": value for name, value in cpu.items()}
        figures["cpu.robot_stack_percent"] = cpu["server"] + cpu["runtime"]
        figures["stream.viewer_kb_per_s"] = (viewer.bytes - received) / _SECONDS / 1000
        figures["rss.server_mb"] = parts["server"].memory_info().rss / 1e6
        figures["rss.runtime_mb"] = parts["runtime"].memory_info().rss / 1e6
        viewer.close()
        return figures


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
