"""The robot's software with as little of a processor as a Raspberry Pi Zero W is thought to have.

Control groups (version 1, as root) give it 1/25 of a core and 380 MB. The kernel grants no less than 1 ms at
once, so that the quota's period is 25 ms. Runtime and server are groups in that one, with the weights of
their systemd units.
"""

import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from bench.real_robot import RealRobot
from server.features.bench.measurement import LoadFigures, measure_load
from server.platform.settings import DataFolder

_CPU, _MEMORY = Path("/sys/fs/cgroup/cpu"), Path("/sys/fs/cgroup/memory")
_PERIOD_US, _QUOTA_US = 25_000, 1_000
_MEMORY_BYTES = 380_000_000
_SHARES = {"runtime": 10 * 1024, "server": 512}
"""As CPUWeight=1000 and 50 in the units."""
_SETTLE, _SECONDS = 10.0, 60.0
_TICK = 0.1
"""s between two control ticks."""


def measure() -> dict[str, float]:
    """Measure a minute with a viewer and a recording, in the lean profile: ms by which the time between two
    control ticks differs from their period, ticks left out, samples missing in the recording, messages that
    told the viewer of samples left out, alarms; and % of a core, and MB of anonymous memory. `natively` is
    the same without a quota.
    """
    figures: dict[str, float] = {}
    for name in ("natively", "quota"):
        with tempfile.TemporaryDirectory() as folder, RealRobot(Path(folder), profile="lean") as robot:
            robot.api.post("/sessions", json={"name": "bench"}).raise_for_status()
            robot.arm()
            with _groups(robot, limited=name == "quota"):
                time.sleep(_SETTLE)
                dive = measure_load(DataFolder(robot.data), _SECONDS, lambda _: None)
            robot.api.post("/robot/stop").raise_for_status()
        figures |= {f"quota.{figure}.{name}": value for figure, value in _figures(dive).items()}
    return figures


def _figures(dive: LoadFigures) -> dict[str, float]:
    return {
        "cpu_percent": dive.robot_percent,
        "anonymous_mb": dive.robot_mb,
        "viewer_lost": dive.viewer_left_out,
        "jitter_ms_p50": dive.jitter_ms[0],
        "jitter_ms_p99": dive.jitter_ms[1],
        "ticks_left_out": max(round(dive.seconds / _TICK) - dive.ticks, 0),
        "samples_lost": dive.samples_lost,
        "alarms": len(dive.alarms),
    }


@contextmanager
def _groups(robot: RealRobot, *, limited: bool) -> Iterator[None]:
    """Put the robot's processes into control groups. Raise OSError where they cannot be made."""
    if not limited:
        yield
        return
    name = f"mucat-bench-{os.getpid()}"
    parent, memory = _CPU / name, _MEMORY / name
    homes = {"runtime": ["runtime", "vision"], "server": ["runner", "server"]}
    try:
        for folder in (parent, memory):
            folder.mkdir()
        (memory / "memory.limit_in_bytes").write_text(str(_MEMORY_BYTES))
        for home, names in homes.items():
            (parent / home).mkdir()
            (parent / home / "cpu.shares").write_text(str(_SHARES[home]))
            for name in names:
                pid = str(robot.robot_processes[name].pid)
                (parent / home / "cgroup.procs").write_text(pid)
                (memory / "cgroup.procs").write_text(pid)
        (parent / "cpu.cfs_period_us").write_text(str(_PERIOD_US))
        (parent / "cpu.cfs_quota_us").write_text(str(_QUOTA_US))
        yield
    finally:
        _release(parent, memory)


def _release(parent: Path, memory: Path) -> None:
    """Return the processes to their groups, and remove these groups."""
    for group, root in ((parent / "runtime", _CPU), (parent / "server", _CPU), (memory, _MEMORY)):
        if group.exists():
            for pid in (group / "cgroup.procs").read_text().split():
                with suppress(OSError):
                    (root / "cgroup.procs").write_text(pid)
    for group in (parent / "runtime", parent / "server", parent, memory):
        with suppress(FileNotFoundError):
            group.rmdir()
