"""Who may move the fins: arming with reasons, stopping without, and noticing a board that disarms itself."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from robot_runtime.clock import Clock
from robot_runtime.control.in_the_loop import InTheLoop
from robot_runtime.errors import Refused
from robot_runtime.link.pace import airtime, stale_after
from robot_runtime.packets import Depth, Hello, Packet, SensorFault, Start, Status, StatusFlag, Stop
from robot_runtime.samples import Event, Mode, Severity

DEPTH_STALE = 0.5
"""s without a depth after which there is nothing to steer by; more where the line is too slow for that."""
_STATUS_STALE = 0.5
_ARM_TRIES = 10
ARM_WAIT = 0.1
"""s between two STARTs."""
_ARM_BYTES = 96
"""What START and the answer wait for and are themselves, on the line."""


class Line(Protocol):
    """What the supervisor needs of the connection to the board."""

    text: str
    baud: int

    @property
    def connected(self) -> bool:
        """Whether the board answers and speaks the same definitions."""
        ...

    @property
    def board(self) -> Hello | None:
        """The greeting of the board."""
        ...

    def send(self, *packets: Packet) -> bool:
        """Hand these packets to the line; False where nobody is there to take them."""
        ...


@dataclass(slots=True)
class Arming:
    """An attempt to arm this board; once it is `over`, `refusal` says why it failed, if it did."""

    board: Hello | None
    tries: int
    over: bool = False
    refusal: str = ""


class Supervisor:
    """Knows whether the robot is armed, and decides whether it may be.

    `tick` runs with the control loop; `arm` and `stop` may be called from any thread. Where there is a
    `loop`, the board must be one for it.
    """

    def __init__(
        self,
        clock: Clock,
        line: Line,
        tell: Callable[[Event], None],
        loop: InTheLoop | None = None,
    ) -> None:
        self.armed_since: float | None = None
        self._clock = clock
        self._line = line
        self._tell = tell
        self._loop = loop
        self._arming: Arming | None = None
        self._status: Status | None = None
        self._status_time = float("-inf")
        self._depth_time = float("-inf")
        self._depth_stale = stale_after(DEPTH_STALE, Depth, line.baud)
        self._status_stale = stale_after(_STATUS_STALE, Status, line.baud)
        self._arm_tries = _ARM_TRIES + round(airtime(_ARM_BYTES, line.baud) / ARM_WAIT)
        # Reentrant: telling an event may come back here to read the state.
        self._changed = threading.Condition(threading.RLock())

    @property
    def armed(self) -> bool:
        """Whether the board is armed and this process armed it."""
        return self.armed_since is not None

    @property
    def mode(self) -> Mode:
        """The mode in one word."""
        return "automatic" if self.armed else "disarmed"

    def see_depth(self) -> None:
        """Note that a depth has come now.

        Its arrival counts, not its stamp: an emulated board that had to pause keeps its clock behind.
        """
        self._depth_time = self._clock.now()

    def see_status(self, status: Status) -> None:
        """Note what the board says of itself now."""
        with self._changed:
            old, self._status, self._status_time = self._status, status, self._clock.now()
            if old is not None and old.epoch != status.epoch:
                self._disarmed("alarm", "The board restarted by itself; it is disarmed.")
            elif self.armed and not status.flags & StatusFlag.ARMED:
                self._disarmed("alarm", "The board disarmed itself; the console says why.")
            self._changed.notify_all()

    def refusals(self) -> list[str]:
        """Why arming would be refused now; empty where it would not."""
        if not self._line.connected:
            return [f"There is no connection to the board: {self._line.text}."]
        now, status = self._clock.now(), self._status
        if status is None or now - self._status_time > self._status_stale:
            return ["The board says nothing of its state. Wait a moment, or reset it."]
        if bool(status.flags & StatusFlag.HIL) != (self._loop is not None):
            return [_WRONG_FIRMWARE if self._loop is None else _NO_HIL_FIRMWARE]
        reasons = self._loop.refusals() if self._loop else []
        if reasons:
            return reasons
        reasons = [_FAULTS[fault] for fault in SensorFault if status.faults & fault]
        if now - self._depth_time > self._depth_stale:
            reasons.append("There is no fresh depth. Check the pressure sensor.")
        if status.flags & StatusFlag.BATTERY_LOW:
            reasons.append(f"The battery is low ({status.battery:.2f} V). Charge it.")
        return reasons

    def arm(self) -> None:
        """Arm the board, and wait until it is.

        Raises Refused with every reason where it may not be, or does not follow.
        """
        with self._changed:
            arming = self.begin_arming()
            while not arming.over:
                self._changed.wait_for(lambda: self.board_armed or arming.over, ARM_WAIT)
                self.go_on_arming()
            if arming.refusal:
                raise Refused(arming.refusal)

    def begin_arming(self) -> Arming:
        """Ask the board to arm; `go_on_arming` does the rest. Raises Refused with every reason against it."""
        if self.armed:
            return Arming(None, tries=0, over=True)
        reasons = self.refusals()
        board = self._line.board
        if reasons or board is None:
            raise Refused(" ".join(reasons))
        with self._changed:
            if self._arming is None:
                self._arming = arming = Arming(board, self._arm_tries)
                self._ask_to_arm(arming)
                return arming
            return self._arming

    def go_on_arming(self) -> None:
        """See whether the board has followed, or ask again; to be called every `ARM_WAIT` at least."""
        with self._changed:
            arming = self._arming
            if arming is None:
                return
            if self.board_armed:
                self.armed_since = self._clock.now()
                self._end_arming("")
                self._event("armed", "info", "Armed.")
            elif arming.tries > 0:
                self._ask_to_arm(arming)
            else:
                self._line.send(Stop())
                self._end_arming("The board did not arm; the console says why. Try again in a moment.")

    def stop(self, why: str, severity: Severity = "info") -> None:
        """Disarm at once, whatever was before."""
        with self._changed:
            self._end_arming("Stopped before the board was armed.")
            # First, so that the board's own word of it is no surprise.
            self._disarmed(severity, why)
        self._line.send(Stop())

    def tick(self) -> None:
        """Look for what should end an armed run; repeat STOP until the board follows."""
        if self._loop is not None:
            self._loop.tick()
        with self._changed:
            if self.armed and not self._line.connected:
                self._disarmed("alarm", f"The connection to the board was lost: {self._line.text}.")
            elif self.armed and self._clock.now() - self._depth_time > self._depth_stale:
                self.stop("The depth is too old to steer by; the fins are stopped.", "alarm")
            elif not self.armed and self._arming is None and self.board_armed:
                self._line.send(Stop())

    def _ask_to_arm(self, arming: Arming) -> None:
        # Repeated because the board wants half a second of steady traffic first. It ignores what it has, and
        # the line does not carry the same twice at a time.
        arming.tries -= 1
        if arming.board is not None:
            self._line.send(Start(epoch=arming.board.epoch))

    def _end_arming(self, refusal: str) -> None:
        if self._arming is not None:
            self._arming.refusal, self._arming.over = refusal, True
            self._arming = None
        self._changed.notify_all()

    @property
    def board_armed(self) -> bool:
        """Whether the board says that it is armed."""
        return self._status is not None and bool(self._status.flags & StatusFlag.ARMED)

    def _disarmed(self, severity: Severity, text: str) -> None:
        if self.armed:
            self.armed_since = None
            self._event("disarmed", severity, text)

    def _event(self, kind: str, severity: Severity, text: str) -> None:
        self._tell(Event(time=self._clock.now(), kind=kind, severity=severity, text=text))


_WRONG_FIRMWARE = (
    "The board runs the firmware for hardware in the loop, which moves nothing. Upload the robot's own, or "
    "set robot.mode to hil."
)
_NO_HIL_FIRMWARE = (
    "The board does not run the firmware for hardware in the loop. Upload build/firmware/hil/robot.hex."
)
_FAULTS = {
    SensorFault.IMU: "The IMU does not answer.",
    SensorFault.PRESSURE: "The pressure sensor does not answer.",
    SensorFault.FIN_FRONT_RIGHT: "The front right fin does not answer.",
    SensorFault.FIN_BACK_RIGHT: "The back right fin does not answer.",
    SensorFault.FIN_BACK_LEFT: "The back left fin does not answer.",
    SensorFault.FIN_FRONT_LEFT: "The front left fin does not answer.",
}
