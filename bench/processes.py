"""Processor time and memory of the processes of a robot, as the kernel counts them."""

from pathlib import Path

import psutil


def cpu_seconds(process: psutil.Process) -> float:
    """s on a processor. The scheduler's own count: the usual one sees only who runs when the clock ticks."""
    tasks = Path(f"/proc/{process.pid}/task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) * 1e-9


def anonymous_mb(process: psutil.Process) -> float:
    """MB that cannot be dropped for want of memory; of a page that processes share, each has its part."""
    for line in Path(f"/proc/{process.pid}/smaps_rollup").read_text().splitlines():
        name, _, rest = line.partition(":")
        if name == "Pss_Anon":
            return int(rest.split()[0]) * 1024 / 1e6
    raise OSError(f"the kernel tells no Pss_Anon of process {process.pid}")
