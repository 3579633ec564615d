"""Two hosts on one computer, with a network between them that delays, jitters and loses packets.

Each host is a network namespace of its own with one interface, whose far end (a TUN device) is in the hands
of this program: it carries the IP packets over, when and if it wants to. So TCP sees true delay and true
loss, and needs no help of the kernel's. To be run within a user namespace, where a plain user may do all
that:

    unshare --user --map-root-user --net python -m tests.in_the_loop ...
"""

import ctypes
import fcntl
import heapq
import multiprocessing
import os
import random
import select
import subprocess
import time
from collections.abc import Callable
from struct import Struct
from typing import Self

HERE = "10.83.0.1"
THERE = "10.83.0.2"
_CLONE_NEWNET = 0x40000000
_TUNSETIFF = 0x400454CA
_IFF_TUN, _IFF_NO_PI = 0x0001, 0x1000
_REQUEST = Struct("16sH22x")
_PACKET_BYTES = 2048
_FORK = multiprocessing.get_context("fork")
_libc = ctypes.CDLL(None, use_errno=True)


def available() -> str:
    """Return the reason why two hosts cannot be made here; empty where they can."""
    try:
        probe = subprocess.run(
            ["unshare", "--user", "--map-root-user", "--net", "ip", "tuntap", "add", "probe", "mode", "tun"],
            capture_output=True,
            text=True,
            check=False,
        )
    except FileNotFoundError as problem:
        return f"{problem.filename} is missing"
    return probe.stderr.strip()


class TwoHosts:
    """Makes this process the host `HERE`; `enter_there` moves a child to the host `THERE`.

    `delay` and `jitter` in s for each way; packets may overtake each other. `loss` is the share that is lost.
    """

    def __init__(self, delay: float, jitter: float, loss: float, seed: int = 1) -> None:
        self.delay, self.jitter = delay, jitter
        self._loss = _FORK.Value("d", loss)
        self._carried, self._lost = _FORK.Value("L", 0), _FORK.Value("L", 0)
        self._random = random.Random(seed)
        self._here = _interface(HERE)
        home = os.open("/proc/self/ns/net", os.O_RDONLY)
        _call(_libc.unshare, _CLONE_NEWNET)
        self._there = _interface(THERE)
        self._away = os.open("/proc/self/ns/net", os.O_RDONLY)
        _call(_libc.setns, home, _CLONE_NEWNET)
        os.close(home)
        # A process of its own: the network does not wait for a test that computes.
        self._carrier = _FORK.Process(target=self._carry, daemon=True)

    def __enter__(self) -> Self:
        self._carrier.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._carrier.kill()
        self._carrier.join()
        for handle in (self._here, self._there, self._away):
            os.close(handle)

    @property
    def loss(self) -> float:
        """The share of packets that is lost."""
        return float(self._loss.value)

    @loss.setter
    def loss(self, share: float) -> None:
        self._loss.value = share

    @property
    def packets(self) -> tuple[int, int]:
        """Number of carried and of lost packets."""
        return self._carried.value, self._lost.value

    def enter_there(self) -> None:
        """Move a child that is about to run its program to the other host."""
        _call(_libc.setns, self._away, _CLONE_NEWNET)

    def _carry(self) -> None:
        under_way: list[tuple[float, int, int, bytes]] = []
        while True:
            wait = min(under_way[0][0] - time.monotonic(), 0.05) if under_way else 0.05
            ready, _, _ = select.select([self._here, self._there], [], [], max(wait, 0))
            now = time.monotonic()
            for source in ready:
                packet = os.read(source, _PACKET_BYTES)
                if self._random.random() < self.loss:
                    self._lost.value += 1
                    continue
                self._carried.value += 1
                due = now + max(self.delay + self._random.uniform(-self.jitter, self.jitter), 0)
                target = self._there if source == self._here else self._here
                heapq.heappush(under_way, (due, self._carried.value, target, packet))
            while under_way and under_way[0][0] <= now:
                _, _, target, packet = heapq.heappop(under_way)
                os.write(target, packet)


def _interface(address: str) -> int:
    """Bring up the loopback and a TUN device of this address in this namespace; return its far end."""
    handle = os.open("/dev/net/tun", os.O_RDWR)
    fcntl.ioctl(handle, _TUNSETIFF, _REQUEST.pack(b"tun0", _IFF_TUN | _IFF_NO_PI))
    for command in (
        "link set lo up",
        f"addr add {address}/24 dev tun0",
        "link set tun0 up",
    ):
        subprocess.run(["ip", *command.split()], check=True)
    return handle


def _call(function: Callable[..., int], *arguments: int) -> None:
    if function(*arguments) != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
