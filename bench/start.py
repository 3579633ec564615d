"""Times of a warm start: of everything here, and of a robot's two services on a slow computer."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from statistics import median

import httpx

from robot_runtime.places import BUILD
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from robot_runtime.simulation.boards.firmware import build_firmware, firmware_path
from server.features.bench.process_figures import cpu_seconds, family
from server.platform.settings import DataFolder
from tests.shell import ShellAuth
from tests.stack import Stack, free_port

_ROUNDS = 3
_PATIENCE = 300.0
_BAUD = 250_000
_GROUP = Path("/sys/fs/cgroup/cpu/mucat-bench")
"""A control group (version 1), which root alone can make."""
_PERIOD_US, _QUOTA_US = 25_000, 1_000
"""1/25 of a core, about what a Raspberry Pi Zero W has of one here; no quota is shorter than 1 ms."""
_CONFIG = '[robot]\nmode = "robot"\n[link]\nport = "{port}"\nbaud = {baud}\n[vision]\ncamera = "card"\n'


def measure() -> dict[str, float]:
    """Return s from the command until every part is well, the median of some starts; s of a robot's services,
    as systemd starts them, to the page and to the linked board, and of processor time until both are there.

    The figures of `quota` are of the same start with 1/25 of a core, where a control group can be made.
    """
    figures = {"start.ready_s": median(_start() for _ in range(_ROUNDS))}
    figures |= _start_services("robot", lambda: None)
    with suppress(OSError), _quota() as enter:
        figures |= _start_services("quota", enter)
    return figures


def _start() -> float:
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        with Stack(Path(folder)):
            return time.monotonic() - began


def _start_services(name: str, enter: Callable[[], None]) -> dict[str, float]:
    """Start runtime and server, whose processes call `enter` first; the board is outside."""
    build_firmware(BUILD, _BAUD)
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        path = Path(folder)
        tty, data = path / "tty", path / "data"
        config, port = path / "robot.toml", free_port()
        with EmulatorProcess(BUILD / "board", firmware_path(BUILD, _BAUD, ".elf"), tty, path / "socket"):
            config.write_text(_CONFIG.format(port=tty, baud=_BAUD))
            where = ["--config", str(config), "--data", str(data)]
            began = time.monotonic()
            runtime = _run(["runtime", *where], enter, path / "runtime.log")
            server = _run(["run", "--external-runtime", "--port", str(port), *where], enter, path / "log")
            try:
                page = _wait(lambda: _has_page(port)) - began
                linked = _wait(lambda: _is_linked(port, DataFolder(data))) - began
                spent = sum(_spent(process) for process in (server, runtime))
            finally:
                for process in (server, runtime):
                    process.terminate()
                for process in (server, runtime):
                    process.wait(_PATIENCE)
    return {
        f"start.{name}_page_s": page,
        f"start.{name}_linked_s": linked,
        f"start.{name}_cpu_s": spent,
    }


def _spent(service: subprocess.Popen[bytes]) -> float:
    return sum(map(cpu_seconds, family(service.pid)))


def _run(arguments: list[str], enter: Callable[[], None], log: Path) -> subprocess.Popen[bytes]:
    program = str(Path(sys.executable).with_name("mucat"))
    with log.open("wb") as file:
        return subprocess.Popen([program, *arguments], stdout=file, stderr=file, preexec_fn=enter)


def _wait(condition: Callable[[], bool]) -> float:
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        with suppress(OSError, httpx.TransportError):
            if condition():
                return time.monotonic()
        time.sleep(0.05)
    raise AssertionError("the robot does not start")


def _has_page(port: int) -> bool:
    return httpx.get(f"http://127.0.0.1:{port}/", timeout=_PATIENCE).status_code == 200


def _is_linked(port: int, data: DataFolder) -> bool:
    health = httpx.get(f"http://127.0.0.1:{port}/api/health", timeout=_PATIENCE, auth=ShellAuth(data)).json()
    return any(part["name"] == "link" and part["state"] == "ok" for part in health["parts"])


@contextmanager
def _quota() -> Iterator[Callable[[], None]]:
    """Yield the function that puts its process into the control group. Raise OSError."""
    _GROUP.mkdir(exist_ok=True)
    try:
        (_GROUP / "cpu.cfs_period_us").write_text(str(_PERIOD_US))
        (_GROUP / "cpu.cfs_quota_us").write_text(str(_QUOTA_US))
        yield lambda: _enter(_GROUP)
    finally:
        _GROUP.rmdir()


def _enter(group: Path) -> None:
    (group / "cgroup.procs").write_text(str(os.getpid()))
