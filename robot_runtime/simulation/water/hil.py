"""The simulator of a robot with its hardware in the loop: receives the fins' angles, sends sensor readings.

The board computes the motion of its fins and sends their angles, 50 times a second, with its own time. The
water advances by the time between two messages, so that a slow or uneven network only delays the answers. An
answer is the bytes of a `Sense`; only the newest is sent.
"""

import logging
import threading
from collections import deque
from collections.abc import Mapping
from math import pi, remainder
from typing import Any

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, CraftDocument
from robot_runtime.contract.packets import Motor, Sense
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import CRAFT, MOTOR, TRUTH
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.water.craft_report import CraftReport
from robot_runtime.simulation.water.fins import Four
from robot_runtime.simulation.water.requests import TRUTH_PERIOD, Change, changes, serve_requests
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from robot_runtime.transport.blocks import read_blocks, read_rows
from robot_runtime.transport.zenoh_transport import ZenohTransport

log = logging.getLogger(__name__)

GAP = 0.2
"""s between two angles of a fin above which its motion is unknown; it then counts as resting."""
GAP_MAX = 1.0
"""s by which the water advances in such a gap at most."""
WAITING_MAX = 1000
"""Messages in the queue, 20 s of them; the oldest of more are dropped, which makes a gap."""
QUIET = 2.0
"""s without a message of the fins after which a warning is logged."""


class HilSimulator:
    """The connection of the simulator and a robot elsewhere. `run` returns after `end`."""

    def __init__(
        self, simulator: Simulator, messages: ZenohTransport, craft: CraftDocument = DEFAULT_DOCUMENT
    ) -> None:
        self._simulator = simulator
        self._craft = CraftReport(simulator, craft)
        self._messages = messages
        requests = changes(simulator)
        requests["fault"] = _no_bus_errors(requests["fault"])
        self._outbox = serve_requests(messages, requests, SteadyClock())
        self._waiting: deque[bytes] = deque(maxlen=WAITING_MAX)
        self._arrived = threading.Event()
        self._ending = False
        self._time: float | None = None
        self._angles: Four = (0.0, 0.0, 0.0, 0.0)
        self._truth_due = 0.0
        messages.subscribe(MOTOR.name, self._receive)

    def run(self) -> None:
        """Simulate the received motion of the fins until `end` is called."""
        receiving: bool | None = None
        robot = self._messages.robot
        while not self._ending:
            if not self._arrived.wait(QUIET):
                if receiving:
                    log.warning("the robot “%s” is lost: nothing comes from its fins; waiting for it", robot)
                elif receiving is None:
                    log.warning(
                        "nothing comes from a robot “%s”; waiting for it, and its board in the loop", robot
                    )
                receiving = False
                continue
            self._arrived.clear()
            reading = self._advance()
            if reading is None:
                continue
            if not receiving:
                log.info("joined the robot “%s”: its fins swim in this water", robot)
            receiving = True
            self._messages.publish("sense", _sense(reading).to_bytes())
            self._outbox.flush()

    def end(self) -> None:
        """Make `run` return; may be called from a signal handler or any thread."""
        self._ending = True
        self._arrived.set()

    def _receive(self, _: str, data: bytes) -> None:
        """Queue a message, in Zenoh's thread."""
        self._waiting.append(data)
        self._arrived.set()

    def _advance(self) -> Reading | None:
        """Advance by all queued messages; return the last reading."""
        reading = None
        while self._waiting:
            try:
                rows = [row for block in read_blocks(self._waiting.popleft()) for row in read_rows(block)]
            except (LayoutError, TypeError) as problem:
                log.warning("an invalid motor block was dropped: %s", problem)
                continue
            for time, motor in rows:
                assert isinstance(motor, Motor)
                reading = self._move(time, motor) or reading
        return reading

    def _move(self, time: float, motor: Motor) -> Reading | None:
        before, self._time = self._time, time
        angles_before, self._angles = self._angles, motor.angle
        if before is None or time <= before:
            # The first of a run, or the board's clock was corrected by some milliseconds. After a reboot of
            # the robot it begins near 0 again.
            self._truth_due = time
            return None
        period = time - before
        speeds: Four = (0.0, 0.0, 0.0, 0.0)
        if period <= GAP:
            a, b, c, d = (
                remainder(now - then, 2 * pi) / period
                for now, then in zip(motor.angle, angles_before, strict=True)
            )
            speeds = (a, b, c, d)
        drives: Four = motor.drive
        reading = self._simulator.advance(
            min(period, GAP_MAX), FinMotion(motor.angle, speeds, drives, powered=any(drives))
        )
        if time >= self._truth_due:
            self._truth_due = time + TRUTH_PERIOD
            if (craft := self._craft.due(time)) is not None:
                self._outbox.add_document(CRAFT, craft)
            self._outbox.add_row(TRUTH, time, self._simulator.truth().to_bytes())
        return reading


def _sense(reading: Reading) -> Sense:
    return Sense(
        pressure=round(reading.pressure),
        temperature=reading.temperature,
        rate=reading.rate,
        force=reading.force,
        right=int(reading.beacon_right),
        left=int(reading.beacon_left),
        battery=reading.battery,
    )


def _no_bus_errors(change: Change) -> Change:
    def fault(question: Mapping[str, Any]) -> None:
        if question.get("kind") == "bus":
            raise RefusedError(
                "a board in the loop has no buses to its sensors; choose another fault, or the emulated board"
            )
        change(question)

    return fault
