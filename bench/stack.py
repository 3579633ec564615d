"""Processor time, memory and control jitter of a robot at full rate, recording, with one viewer."""

import tempfile
import time
from pathlib import Path

from bench import jitter
from bench.hour import copy_hours
from bench.real_robot import RealRobot, pids
from server.features.bench.live_viewer import LiveViewer
from server.features.bench.process_figures import anonymous_mb, core_percent
from server.platform.settings import DataFolder
from tests.stack import Stack

_SETTLE = 5.0
_SECONDS = 30.0
_JITTER_SECONDS = 100.0
"""Of each phase: at 10 Hz a thousand ticks, of which the worst is the p999."""


def measure() -> dict[str, float]:
    """Measure as on a robot: CPU in percent of one core over half a minute, in the lean profile as well, and
    at its end MB of memory, resident and anonymous. With the emulated board: ms by which the time between two
    control ticks differs from their period, idle and while exporting and rendering.
    """
    return _load() | _load_lean() | _jitter()


def _load_lean() -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder, RealRobot(Path(folder), profile="lean") as robot:
        robot.api.post("/sessions", json={"name": "bench"}).raise_for_status()
        with LiveViewer(DataFolder(robot.data)):
            robot.arm()
            time.sleep(_SETTLE)
            cpu = core_percent(pids(robot.robot_processes), _SECONDS)
        robot.api.post("/robot/stop").raise_for_status()
    return {"cpu.robot_stack_lean_percent": sum(cpu.values())}


def _load() -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder, RealRobot(Path(folder)) as robot:
        robot.api.post("/sessions", json={"name": "bench"}).raise_for_status()
        with LiveViewer(DataFolder(robot.data)) as viewer:
            robot.arm()
            time.sleep(_SETTLE)
            processes = robot.robot_processes | robot.outside
            received = viewer.bytes
            cpu = core_percent(pids(processes), _SECONDS)
            received = viewer.bytes - received
        figures = {f"cpu.{name}_percent": value for name, value in cpu.items()}
        figures["cpu.robot_stack_percent"] = sum(cpu[name] for name in robot.robot_processes)
        figures["stream.viewer_kb_per_s"] = received / _SECONDS / 1000
        for name, process in robot.robot_processes.items():
            figures[f"rss.{name}_mb"] = process.memory_info().rss / 1e6
            figures[f"anonymous.{name}_mb"] = anonymous_mb(process.pid)
        figures["anonymous.robot_mb"] = sum(map(anonymous_mb, pids(robot.robot_processes).values()))
        robot.api.post("/robot/stop").raise_for_status()
    return figures


def _jitter() -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        (hour,) = copy_hours(data)
        with Stack(data) as stack:
            # Before arming, which would begin a recording of its own.
            recording = {"name": "bench"}
            session = stack.api.post("/sessions", json=recording).raise_for_status().json()["id"]
            with LiveViewer(DataFolder(data)):
                stack.arm()
                time.sleep(_SETTLE)
                phases = {"idle": _phase(time.monotonic())}
                with jitter.busy(stack, hour):
                    time.sleep(_SETTLE)
                    phases["busy"] = _phase(time.monotonic())
            stack.api.post("/robot/stop").raise_for_status()
            stack.api.post(f"/sessions/{session}/stop")
        return jitter.figures(data, session, phases)


def _phase(began: float) -> tuple[float, float]:
    """Wait for the end of a phase that began at `begin`; return its times."""
    end = began + _JITTER_SECONDS
    time.sleep(max(end - time.monotonic(), 0.0))
    return began, end
