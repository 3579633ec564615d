"""A supervisor in simulated time, with a board and sensors that the test sets."""

from collections.abc import Callable
from math import cos, sin
from typing import Literal

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Event
from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    Depth,
    Hello,
    Imu,
    Packet,
    Start,
    Status,
    StatusFlag,
    Stop,
)
from robot_runtime.control.hil_feed import HilFeed
from robot_runtime.control.supervisor import Supervisor


class ObedientBoard:
    """A board that executes commands, unless the test changes that."""

    def __init__(self, baud: int) -> None:
        self.connected = True
        self.baud = baud
        self.text = "connected"
        self.board: Hello | None = Hello(definitions=DEFINITIONS_HASH, epoch=7, credit=64)
        self.sent: list[Packet] = []
        self.obeys = True
        self.flags = 0
        self.faults = 0
        self.epoch = 7
        self.stack_free = 200

    def send(self, *packets: Packet) -> bool:
        self.sent += packets
        return self.connected


class SupervisorRig:
    """A supervisor, its board and its events."""

    def __init__(
        self, baud: int = 250_000, heartbeat: float | None = None, *, in_the_loop: bool = False
    ) -> None:
        self.clock, self.board = SimulatedClock(100.0), ObedientBoard(baud)
        self.events: list[Event] = []
        self.hil = HilFeed(self.clock, lambda _: None, self.events.append) if in_the_loop else None
        self.on_start: Callable[[], None] = lambda: None
        self.supervisor = Supervisor(
            self.clock, self.board, self.events.append, self.hil, heartbeat=heartbeat
        )
        self._pressure = 101_325
        self._rate = self._force = 0.0
        self.board.send = self._send  # type: ignore[method-assign]

    def _send(self, *packets: Packet) -> bool:
        self.board.sent += packets
        for packet in packets:
            if isinstance(packet, Start) and self.board.obeys:
                self.board.flags |= StatusFlag.ARMED
            if isinstance(packet, Stop):
                self.board.flags &= ~StatusFlag.ARMED
            self.report()
            if isinstance(packet, Start):
                self.on_start()
        return self.board.connected

    def report(self) -> None:
        status = Status(
            time=0,
            epoch=self.board.epoch,
            flags=self.board.flags,
            faults=self.board.faults,
            reset_cause=1,
            battery=7.4,
            loop_worst=0,
            missed_ticks=0,
            frames_invalid=0,
            bytes_lost=0,
            debug_lost=0,
            stack_free=self.board.stack_free,
        )
        self.supervisor.detector.see_messages()
        self.supervisor.see_status(status)

    def sense(self, depth: float = 0.3, tilt: float = 0.0, *, frozen: bool = False) -> None:
        """Send depth and attitude, like a working board."""
        self.sense_depth(depth, frozen=frozen)
        self.sense_attitude(tilt)

    def sense_depth(self, depth: float = 0.3, *, frozen: bool = False) -> None:
        self._pressure += not frozen
        self.supervisor.detector.see_messages()
        reading = Depth(time=0, depth=depth, pressure=self._pressure, temperature=20.0)
        self.supervisor.detector.see_depth(reading)

    def sense_attitude(self, tilt: float = 0.0, *, frozen: Literal["rate", "force"] | None = None) -> None:
        self._rate += 1e-6 * (frozen != "rate")
        self._force += 1e-6 * (frozen != "force")
        self.supervisor.detector.see_messages()
        attitude = (cos(tilt / 2), sin(tilt / 2), 0.0, 0.0)
        rate, force = (self._rate, 0.0, 0.0), (0.0, 0.0, -9.81 + self._force)
        self.supervisor.detector.see_imu(Imu(time=0, attitude=attitude, rate=rate, force=force))

    def ready(self) -> None:
        self.report()
        self.sense()
