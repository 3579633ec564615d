"""Processor time of the host for the connection to the board."""

import tempfile
import time
from pathlib import Path
from statistics import median

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.packets import Heartbeat, Navigation
from robot_runtime.link.serial_link import SerialLink
from robot_runtime.link.session import BoardMessage
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from tests.board.host import BAUD, FIRMWARE
from tests.board.rig import PROGRAM

_ROUNDS = 5
_SECONDS = 3.0
_PERIOD = 0.01
_CONNECT_SECONDS = 10.0
_TASKS = Path("/proc/self/task")


def measure() -> dict[str, float]:
    """Return CPU in percent of one core, of this process alone by the scheduler's count; the median of some
    rounds.

    The runtime's own connection, over a pseudo-terminal, to the real firmware on the emulated board at 1x
    and 250000 baud. The board sends its telemetry, 220 packets a second in 110 frames. A thread sends the
    same amount: NAVIGATION and HEARTBEAT, 100 times a second, two in a frame as the board does. What comes
    is counted and not handled.

    `wakings` is the part of it that a process takes which wakes as often and does nothing else.
    """
    heard: list[BoardMessage] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        with EmulatorProcess(PROGRAM, FIRMWARE / "robot.elf", path / "tty", path / "socket"):
            connection = SerialLink(str(path / "tty"), BAUD, SteadyClock(), 1, heard.extend, lambda: None)
            connection.start()
            try:
                _await(connection)
                rounds = [_talk(connection, heard) for _ in range(_ROUNDS)]
            finally:
                connection.close()
    figures = {name: median(timing[name] for timing in rounds) for name in rounds[0]}
    return figures | {"link.cpu_percent.wakings": _idle(figures["link.wakings_per_s"])}


def _await(connection: SerialLink) -> None:
    end = time.monotonic() + _CONNECT_SECONDS
    while not connection.connected:
        if time.monotonic() > end:
            raise RuntimeError(f"the board did not answer: {connection.text}")
        time.sleep(_PERIOD)


def _talk(connection: SerialLink, heard: list[BoardMessage]) -> dict[str, float]:
    heard.clear()
    command = Navigation(x=0.5, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=-0.5)
    began, cpu, wakings = time.monotonic(), _cpu(), _wakings()
    due, sent = began, 0
    while (now := time.monotonic()) < began + _SECONDS:
        sent += 2 * connection.send(command, Heartbeat(time=int(now * 1000) & 0xFFFFFFFF))
        due = max(due + _PERIOD, now)
        time.sleep(max(due - time.monotonic(), 0.0))
    took = time.monotonic() - began
    return {
        "link.cpu_percent": (_cpu() - cpu) / took * 100,
        "link.wakings_per_s": (_wakings() - wakings) / took,
        "link.packets_sent_per_s": sent / took,
        "link.packets_received_per_s": len(heard) / took,
    }


def _idle(wakings_per_s: float) -> float:
    """Return CPU in percent of waking so often."""
    shares = []
    for _ in range(_ROUNDS):
        cpu, wakings = _cpu(), _wakings()
        end = time.monotonic() + 1.0
        while time.monotonic() < end:
            time.sleep(1 / wakings_per_s)
        shares.append((_cpu() - cpu) / (_wakings() - wakings) * wakings_per_s * 100)
    return min(shares)


def _cpu() -> float:
    """Return s on a processor by the scheduler's count: the usual one only samples at clock ticks."""
    return sum(int((task / "schedstat").read_text().split()[0]) for task in _TASKS.iterdir()) * 1e-9


def _wakings() -> int:
    """Return the number of times that a thread has gone to sleep of its own accord."""
    lines = [line for task in _TASKS.iterdir() for line in (task / "status").read_text().splitlines()]
    return sum(int(line.split()[1]) for line in lines if line.startswith("voluntary_ctxt_switches"))
