"""The network of a lab on one computer: each of its computers is a network namespace, on a cable of its own.

It is laid in the present namespace, which must be nobody else's: `unshare --net`.
"""

import ctypes
import os
import socket
import subprocess
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import ParamSpec, TypeVar

from tests.stack import ROOT
from tests.waiting import SECONDS

P = ParamSpec("P")
T = TypeVar("T")

NETWORK = "10.84.0"
GATEWAY = f"{NETWORK}.254"
_SWITCH = "switch"
_NEW_NAMES, _NEW_NETWORK = 0x04000000, 0x40000000
"""CLONE_NEWUTS and CLONE_NEWNET of unshare(2)."""
_libc = ctypes.CDLL(None, use_errno=True)


class LabNetwork:
    """A switch, and the computers on it; leaving the context unplugs them."""

    def __init__(self) -> None:
        others = [name for _, name in socket.if_nameindex() if name != "lo"]
        if others:
            raise RuntimeError(f"there are {', '.join(others)}; a network namespace of its own has none")
        self._computers: list[LabComputer] = []
        _run("ip link set lo up")
        _run(f"ip link add name {_SWITCH} type bridge")
        _run(f"ip addr add {GATEWAY}/24 dev {_SWITCH}")
        _run(f"ip link set {_SWITCH} up")

    def __enter__(self) -> "LabNetwork":
        return self

    def __exit__(self, *_: object) -> None:
        for computer in self._computers:
            computer.close()

    def add(self, name: str, number: int) -> "LabComputer":
        """Return a new computer on the network; `number` is the last one of its address."""
        computer = LabComputer(name, number)
        self._computers.append(computer)
        _run(f"ip link add name {name} type veth peer name eth0 netns {computer.namespace}")
        _run(f"ip link set {name} master {_SWITCH} up")
        computer.call(computer.bring_up)
        return computer

    def cut(self, computer: "LabComputer") -> None:
        """Pull a computer's cable out of the switch: what is on its way is lost, and nobody is notified."""
        _run(f"ip link set {computer.name} down")

    def mend(self, computer: "LabComputer") -> None:
        """Plug it in again."""
        _run(f"ip link set {computer.name} up")


class LabComputer:
    """A computer: what it runs and asks goes over its own cable, and has its own name and loopback."""

    def __init__(self, name: str, number: int) -> None:
        self.name, self.address = name, f"{NETWORK}.{number}"
        # A namespace is a thread's, and that of what the thread starts.
        self._thread = ThreadPoolExecutor(1, name, self._leave)
        self.namespace = self.call(lambda: f"/proc/{os.getpid()}/task/{threading.get_native_id()}/ns/net")

    def call(self, function: Callable[P, T], *arguments: P.args, **options: P.kwargs) -> T:
        """Call a function on this computer, and return its result."""
        return self._thread.submit(function, *arguments, **options).result()

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        """Run a program on this computer to its end."""
        return self.call(
            lambda: subprocess.run(
                command, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False
            )
        )

    def bring_up(self) -> None:
        """Configure the network, on this computer."""
        _run("ip link set lo up")
        _run(f"ip addr add {self.address}/24 dev eth0")
        _run("ip link set eth0 up")
        _run(f"ip route add default via {GATEWAY}")

    def slow(self, rate: str) -> None:
        """Limit what it sends to this rate, such as "100kbit", as over a poor radio link."""
        self.call(_run, f"tc qdisc replace dev eth0 root tbf rate {rate} burst 4kb latency 500ms")

    def close(self) -> None:
        """End the computer."""
        self._thread.shutdown()

    def _leave(self) -> None:
        if _libc.unshare(_NEW_NETWORK | _NEW_NAMES) != 0:
            raise OSError(ctypes.get_errno(), "no namespace of its own")
        socket.sethostname(self.name)


def _run(command: str) -> None:
    subprocess.run(command.split(), check=True)
