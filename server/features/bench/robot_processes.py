"""The processes of a running robot, by name."""

from pathlib import Path

from server.features.bench.process_figures import PROC, command_line, family
from server.platform.pidfile import running_parts

OUTSIDE = ("board", "simulator", "scene")
"""The emulated board and the simulated water: on a robot they are a chip and a pool."""
_PROGRAMS = {
    "robot_runtime.vision": "vision",
    "robot_runtime.simulation.scene": "scene",
    "server.features.comparison": "comparison",
}


def find_processes(runner: int, run: Path) -> dict[str, int]:
    """Return the processes of the server that `runner` looks after, and of its robot; `run` has PID files."""
    named = {running.pid: name for name, running in running_parts(run).items()} | {runner: "runner"}
    processes: dict[str, int] = {}
    for root in named:
        for pid in family(root):
            processes.setdefault(named.get(pid) or _find_name(pid), pid)
    return processes


def _find_name(pid: int) -> str:
    line = command_line(pid)
    for program, name in _PROGRAMS.items():
        if program in line:
            return name
    comm = PROC / str(pid) / "comm"
    return "server" if comm.read_text().strip() == "mucat-server" else f"process {pid}"
