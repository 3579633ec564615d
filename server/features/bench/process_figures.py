"""Processor time and memory of processes, as the kernel counts them."""

import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

PROC = Path("/proc")
_NANO = 1e-9


def cpu_seconds(pid: int) -> float:
    """Return s on a processor by the scheduler's count: the usual one only samples at clock ticks."""
    tasks = (PROC / str(pid) / "task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) * _NANO


def core_percent(processes: Mapping[str, int], seconds: float) -> dict[str, float]:
    """Wait that long. Return the processor time that each process used meanwhile, in % of a core."""
    before = {name: cpu_seconds(pid) for name, pid in processes.items()}
    time.sleep(seconds)
    return {name: (cpu_seconds(pid) - before[name]) / seconds * 100 for name, pid in processes.items()}


def anonymous_mb(pid: int) -> float:
    """Return the MB that cannot be dropped for want of memory; processes share a page's MB evenly."""
    for line in (PROC / str(pid) / "smaps_rollup").read_text().splitlines():
        name, _, rest = line.partition(":")
        if name == "Pss_Anon":
            return int(rest.split()[0]) * 1024 / 1e6
    raise OSError(f"the kernel tells no Pss_Anon of process {pid}")


def family(pid: int) -> Iterator[int]:
    """Yield the process and its living descendants."""
    children: dict[int, list[int]] = {}
    for folder in PROC.glob("[0-9]*"):
        with suppress(OSError):
            # Behind the program's name in brackets, which may hold brackets itself: state, parent.
            parent = int((folder / "stat").read_text(errors="replace").rpartition(")")[2].split()[1])
            children.setdefault(parent, []).append(int(folder.name))
    members = [pid]
    for member in members:
        members += children.get(member, [])
    yield from members


def command_line(pid: int) -> str:
    """Return the words of the process's command; empty where it has ended."""
    with suppress(OSError):
        return (PROC / str(pid) / "cmdline").read_text(errors="replace").replace("\0", " ").strip()
    return ""
