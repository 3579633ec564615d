"""The simulator of a robot with its hardware in the loop: receives the fins' angles, sends sensor readings.

The board computes how its fins move and sends their angles, fifty times a second, with its own time. The
water moves on by the time between two of them, so that a slow or uneven network delays what it answers, and
changes nothing else. Answers go out as the bytes of a `Sense`, the newest only.
"""

import logging
import threading
from collections import deque
from collections.abc import Mapping
from math import pi, remainder
from typing import Any

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.packets import Motor, Sense
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.water.fins import Four
from robot_runtime.simulation.water.requests import TRUTH_PERIOD, Change, changes, serve_requests
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from robot_runtime.transport.blocks import read_blocks, read_rows
from robot_runtime.transport.zenoh_transport import ZenohTransport

log = logging.getLogger(__name__)

GAP = 0.2
"""s between two angles of a fin above which nobody knows how it moved: it is taken to have rested."""
GAP_MAX = 1.0
"""s of such a gap that the water moves on for; a board that was away longer finds it as it was then."""
WAITING_MAX = 1000
"""Messages that wait, twenty seconds of them; of more the oldest are lost, which is a gap."""
QUIET = 2.0
"""s without a word of the fins after which it is said."""


class HilSimulator:
    """Joins the simulator and a robot elsewhere. `run` returns after `end`."""

    def __init__(self, simulator: Simulator, messages: ZenohTransport) -> None:
        self._simulator = simulator
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
        messages.subscribe("motor", self._receive)

    def run(self) -> None:
        """Swim as the fins are heard to move, until `end` is called."""
        heard = True
        while not self._ending:
            if not self._arrived.wait(QUIET):
                if heard:
                    log.warning("no fins are heard; waiting for the robot's runtime and its board")
                heard = False
                continue
            self._arrived.clear()
            reading = self._swim()
            if reading is None:
                continue
            if not heard:
                log.info("the fins are heard")
            heard = True
            self._messages.publish("sense", _sense(reading).to_bytes())
            self._outbox.flush()

    def end(self) -> None:
        """Makes `run` return; may be called from a signal handler or any thread."""
        self._ending = True
        self._arrived.set()

    def _receive(self, _: str, data: bytes) -> None:
        """Called in Zenoh's thread."""
        self._waiting.append(data)
        self._arrived.set()

    def _swim(self) -> Reading | None:
        """Move on by all that waits; what the sensors show at its end."""
        reading = None
        while self._waiting:
            try:
                rows = [row for block in read_blocks(self._waiting.popleft()) for row in read_rows(block)]
            except (LayoutError, TypeError) as problem:
                log.warning("what is no motor block was dropped: %s", problem)
                continue
            for time, motor in rows:
                assert isinstance(motor, Motor)
                reading = self._move(time, motor) or reading
        return reading

    def _move(self, time: float, motor: Motor) -> Reading | None:
        before, self._time = self._time, time
        angles_before, self._angles = self._angles, motor.angle
        if before is None or time <= before:
            # The first of a runtime; or the board's clock was corrected by some milliseconds.
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
            self._outbox.add_row("truth", time, self._simulator.truth().to_bytes())
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
