"""Measures the effect of faults: the fins at the emulated board, and the messages to a page."""

import json
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from math import remainder, tau
from pathlib import Path
from typing import Any, NamedTuple

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect
from websockets.typing import Origin

from robot_runtime.contract.topics import Kind
from robot_runtime.simulation.boards.emulator_process import BoardError, EmulatorClient
from robot_runtime.simulation.water.simulator import FinMotion
from robot_runtime.transport.blocks import read_blocks
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import Stack

MOVING = 1.0
"""rad/s, over `SPAN`. A stroke reaches 7. Limits of 0.1 and 0.5, which stood here before, would count a last
correction as motion: 0.03 rad in 0.05 s are 0.6 rad/s."""
SPAN = 0.05
"""s. In less, the chip's smallest corrections end: they put a resting fin right by up to 0.03 rad."""
SILENCE = 0.1
"""s without a byte: a runtime that lives sends as often."""
_LOOK = 0.004
_APART = 0.003
"""s of the board's time in which it was asked for its time and its fins, at most."""
_AGAIN = 0.01


class FinSight(NamedTuple):
    """The fins at a time (s, steady clock).

    `board` is the board's own time: on a busy computer the emulated one falls behind.
    """

    time: float
    board: float
    moving: bool
    powered: bool
    heard: float
    """Bytes that the chip has received; where there is no board it is 0, as are the times."""


class WatchedMotions:
    """Detects from one reading to the next if any fin moves."""

    def __init__(self) -> None:
        self._looks: deque[tuple[float, tuple[float, ...]]] = deque()

    def see(self, time: float, fins: FinMotion) -> bool:
        """Return True if any fin moved in the last `SPAN`; `time` in s."""
        looks = self._looks
        if looks and time > looks[-1][0] + SPAN / 2:
            # Nobody knows when in between it moved.
            looks.clear()
        looks.append((time, fins.angles))
        while len(looks) > 1 and looks[1][0] <= time - SPAN:
            looks.popleft()
        pairs = zip(fins.angles, looks[0][1], strict=True)
        return any(abs(remainder(now - then, tau)) > MOVING * SPAN for now, then in pairs)


def find_silence(seen: Sequence[FinSight], since: float) -> float:
    """Time at which the chip had received the last byte under way at `since` (both s, steady clock).

    `since` itself where the next runtime's bytes came within `SILENCE`: the board's time may pass slowly.
    """
    later = [sample for sample in seen if sample.time >= since]
    for index, item in enumerate(later):
        after = next((other for other in later[index:] if other.board >= item.board + SILENCE), None)
        if after is not None and after.heard == item.heard:
            return item.time
    return since


class FinWatch:
    """Reads the fins continuously, whatever happens to other processes; no board, no motion."""

    def __init__(self, socket: Path) -> None:
        self.seen: list[FinSight] = []
        self._socket = socket
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._look, name="fins")
        self._thread.start()

    def close(self) -> None:
        """End the observation."""
        self._ending.set()
        self._thread.join()

    def moved_for(self, since: float) -> float:
        """s of the board's time that the fins moved since then."""
        return self._last(since, lambda sample: sample.moving)

    def powered_for(self, since: float) -> float:
        """s of the board's time that the motors had power since then."""
        return self._last(since, lambda sample: sample.powered)

    def _last(self, since: float, expected: Callable[[FinSight], bool]) -> float:
        seen = [sample for sample in self.seen if sample.time >= since]
        return (
            max((sample.board for sample in seen if expected(sample)), default=seen[0].board) - seen[0].board
        )

    def _look(self) -> None:
        while not self._ending.is_set():
            with suppress(BoardError), EmulatorClient(self._socket) as board:
                motion = WatchedMotions()
                while not self._ending.wait(_LOOK):
                    now, before, fins, stats = time.monotonic(), board.stats(), board.fins(), board.stats()
                    there, heard = stats["time"], stats["bytes_to_board"]
                    if there - before["time"] <= _APART:
                        self.seen.append(FinSight(now, there, motion.see(there, fins), fins.powered, heard))
            self.seen.append(FinSight(time.monotonic(), 0.0, moving=False, powered=False, heard=0.0))
            self._ending.wait(_AGAIN)


class Viewer:
    """A page that only receives, and reconnects whenever its connection ends."""

    def __init__(self, stack: Stack) -> None:
        self.newest: dict[str, float] = {}
        """Time of the newest sample of each topic, s."""
        self.state: dict[str, Any] = {}
        self.alarms: list[dict[str, Any]] = []
        """The robot's and the server's."""
        self.health: dict[str, str] = {}
        self.bytes = 0
        self._servers: list[dict[str, Any]] = []
        self._stack = stack
        self._ending = False
        self._thread = threading.Thread(target=self._watch, name="viewer")
        self._thread.start()

    def close(self) -> None:
        """Disconnect for good."""
        self._ending = True
        self._thread.join()

    def fresh(self, topics: tuple[str, ...], since: float) -> bool:
        """Return True if every topic has a sample newer than that."""
        return all(self.newest.get(topic, 0.0) > since for topic in topics)

    def tells(self, fault: str) -> bool:
        """Return True if this alarm is active or not acknowledged."""
        return any(alarm["fault"] == fault for alarm in self.alarms)

    def _watch(self) -> None:
        while not self._ending:
            with suppress(OSError, WebSocketException, TimeoutError):
                self._look_on()
            time.sleep(_AGAIN)

    def _look_on(self) -> None:
        address = f"ws://127.0.0.1:{self._stack.port}/api/live"
        origin = Origin(self._stack.url)
        signed = shell_headers(DataFolder(self._stack.data))
        with connect(address, origin=origin, max_size=None, proxy=None, additional_headers=signed) as socket:
            while not self._ending:
                with suppress(TimeoutError):
                    self._take(socket.recv(timeout=0.1))

    def _take(self, message: str | bytes) -> None:
        self.bytes += len(message)
        if isinstance(message, str):
            self._hear(json.loads(message))
            return
        for block in read_blocks(message):
            if block.topic.kind is not Kind.PICTURE and block.count:
                taken = block.time_of(block.following - 1)
                self.newest[block.topic.name] = max(taken, self.newest.get(block.topic.name, 0.0))
            if block.topic.name == "state":
                self.state = json.loads(block.payload)[-1]
                self._join()

    def _hear(self, news: dict[str, Any]) -> None:
        if news["op"] == "alarms":
            self._servers = news["alarms"]
            self._join()
        elif news["op"] == "health":
            self.health = {part["name"]: part["state"] for part in news["parts"]}

    def _join(self) -> None:
        self.alarms = self._servers + self.state.get("alarms", [])
