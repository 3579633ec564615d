"""Processor time and memory of the processes of a robot, as the kernel counts them."""

import time
from collections.abc import Mapping
from pathlib import Path

import psutil


def cpu_seconds(process: psutil.Process) -> float:
    """Return s on a processor by the scheduler's count: the usual one only samples at clock ticks."""
    tasks = Path(f"/proc/{process.pid}/task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) * 1e-9


def core_percent(processes: Mapping[str, psutil.Process], seconds: float) -> dict[str, float]:
    """Wait that long. Return the processor time that each process used meanwhile, in % of a core."""
    before = {name: cpu_seconds(process) for name, process in processes.items()}
    time.sleep(seconds)
    return {
        name: (cpu_seconds(process) - before[name]) / seconds * 100 for name, process in processes.items()
    }


def anonymous_mb(process: psutil.Process) -> float:
    """Return the MB that cannot be dropped for want of memory; processes share a page's MB evenly."""
    for line in Path(f"/proc/{process.pid}/smaps_rollup").read_text().splitlines():
        name, _, rest = line.partition(":")
        if name == "Pss_Anon":
            return int(rest.split()[0]) * 1024 / 1e6
    raise OSError(f"the kernel tells no Pss_Anon of process {process.pid}")
