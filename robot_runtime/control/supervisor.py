"""The supervisor: the robot's state, arming, stopping, and the actions on faults."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from math import inf

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Alarm, Event, Mode, Severity
from robot_runtime.contract.packets import Hello, Start, Status, StatusFlag, Stop
from robot_runtime.control.alarms import CLEAR_AFTER, Alarms
from robot_runtime.control.fault_detector import BoardLink, FaultDetector
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.control.fin_check import FinCheck
from robot_runtime.control.hil_feed import HilFeed
from robot_runtime.control.pilot import Pilot
from robot_runtime.control.transitions import ARMED, Trigger, follow
from robot_runtime.errors import RefusedError
from robot_runtime.link.timing import airtime

_ARM_TRIES = 10
ARM_WAIT = 0.1
"""s between two STARTs."""
_ARM_BYTES = 96
"""Bytes on the line between START and its answer, including both."""

_ARM: dict[Mode, Trigger] = {"automatic": "arm", "manual": "arm manual", "test": "check fins"}
_CHANGE: dict[Mode, Trigger] = {"manual": "take over", "automatic": "hand back"}
_ARMED_WORDS: dict[Mode, str] = {
    "automatic": "Armed.",
    "manual": "Armed, by hand.",
    "test": "The fins are checked.",
}


@dataclass(slots=True)
class Arming:
    """An attempt to arm this board; once it is `over`, `refusal` says why it failed, if it did.

    `on_armed` is called once the board is armed, before the mode changes; it must not block.
    `disarmed_seen`: the board has reported that it is disarmed. Until then, reports of an earlier arming may
    still be on their way.
    """

    board: Hello | None
    tries: int
    mode: Mode = "automatic"
    alone: float = 0.0
    unwatched: float = 0.0
    on_armed: Callable[[], None] | None = None
    disarmed_seen: bool = False
    over: bool = False
    refusal: str = ""


class Supervisor:
    """The robot's state, which changes only by the table in `transitions`.

    `tick` runs at least every `faults.CHECK_PERIOD` s; all may be called from any thread. With `hil` the
    board must run the firmware for hardware in the loop; with `heartbeat` (s) a server that is silent for
    longer is a fault. `on_mode` gets each new mode and must not block. `arming_obstacles` returns further
    reasons against arming. `deepest`: the greatest depth, m. `unwatched`: s for which an
    armed robot may swim while nobody watches, unless its arming says otherwise; 0: without an end.
    """

    def __init__(
        self,
        clock: Clock,
        line: BoardLink,
        on_event: Callable[[Event], None],
        hil: HilFeed | None = None,
        heartbeat: float | None = None,
        on_mode: Callable[[Mode], None] = lambda _: None,
        arming_obstacles: Callable[[], list[str]] = list,
        deepest: float = inf,
        unwatched: float = 0.0,
    ) -> None:
        self.mode: Mode = "disarmed"
        self.armed_since: float | None = None
        self.pilot = Pilot(clock)
        self.detector = FaultDetector(clock, line, self.pilot, hil, heartbeat, arming_obstacles, deepest)
        self.fin_check = FinCheck(clock)
        self._clock = clock
        self._line = line
        self._on_event = on_event
        self._hil = hil
        self._heartbeat = heartbeat
        self._unwatched = unwatched
        self._on_mode = on_mode
        self._alarms = Alarms(clock, ROBOT_FAULTS, on_event, clear_after=CLEAR_AFTER)
        self._arming: Arming | None = None
        self._arm_tries = _ARM_TRIES + round(airtime(_ARM_BYTES, line.baud) / ARM_WAIT)
        # Reentrant: a receiver of an event may read the state.
        self._changed = threading.Condition(threading.RLock())

    @property
    def armed(self) -> bool:
        """True if the board is armed and this process armed it."""
        return self.mode in ARMED

    @property
    def alarms(self) -> list[Alarm]:
        """The active alarms, and past ones that are not acknowledged."""
        with self._changed:
            return self._alarms.listed()

    @property
    def board_armed(self) -> bool:
        """True if the board reports that it is armed."""
        status = self.detector.status
        return status is not None and bool(status.flags & _ARMED_FLAG)

    @property
    def _low_battery_disarmed(self) -> bool:
        """True if the board reports that a low battery disarmed it."""
        status = self.detector.status
        return status is not None and status.flags & (_ARMED_FLAG | _BATTERY_LOW_FLAG) == _BATTERY_LOW_FLAG

    def see_status(self, status: Status) -> None:
        """Take the board's status."""
        with self._changed:
            old = self.detector.status
            self.detector.see_status(status)
            if self.mode != "disarmed" and old is not None and old.epoch != status.epoch:
                # Its silence may have been detected first; this is the cause.
                self._fail("board_restarted")
            elif self.armed and not status.flags & _ARMED_FLAG and not self.detector.board_says_why:
                self._fail("board_disarmed")
            self._changed.notify_all()

    def refusals(self) -> list[str]:
        """Return the reasons against arming now; empty if there are none."""
        with self._changed:
            failsafe = [_ACKNOWLEDGE] if self.mode == "failsafe" else []
            return [*failsafe, *self.detector.refusals()]

    @property
    def unwatched(self) -> float:
        """The time (s) for which it may swim while nobody watches: of this arming, else the configured one.

        0: without an end.
        """
        return self.detector.watch_patience if self.armed else self._unwatched

    def arm(self, mode: Mode = "automatic", alone: float = 0.0, unwatched: float | None = None) -> None:
        """Arm the board and wait until it is armed.

        Raise RefusedError with all reasons if it must not be armed, or does not arm.
        """
        self.finish_arming(self.begin_arming(mode, alone, unwatched))

    def finish_arming(self, arming: Arming) -> None:
        """Wait until an attempt to arm is over. Raise RefusedError if the board did not arm."""
        with self._changed:
            while not arming.over:
                self._changed.wait_for(
                    lambda: arming.over or self.board_armed == arming.disarmed_seen, ARM_WAIT
                )
                self.continue_arming()
            if arming.refusal:
                raise RefusedError(arming.refusal)

    def begin_arming(
        self,
        mode: Mode = "automatic",
        alone: float = 0.0,
        unwatched: float | None = None,
        on_armed: Callable[[], None] | None = None,
    ) -> Arming:
        """Ask the board to arm; `continue_arming` completes it. Raise RefusedError with all reasons.

        `alone`: s for which the robot may continue without the server. `unwatched`: s while nobody watches,
        0: without an end, None: the configured ones. A longer `alone` counts for both, since without a server
        nobody watches. What begins by `on_armed` begins by an arming of its own: it is refused where the
        robot is armed, or is being armed.
        """
        with self._changed:
            if self.mode == mode != "test" and on_armed is None:
                return Arming(None, tries=0, over=True)
            if self.armed:
                raise RefusedError(f"The robot is armed, in {self.mode}. Change its mode, or STOP it first.")
            reasons = self.refusals()
            board = self._line.board
            if reasons or board is None:
                raise RefusedError(" ".join(reasons))
            if self._arming is None:
                patience = self._unwatched if unwatched is None else unwatched
                patience = patience and max(patience, alone)
                self._arming = arming = Arming(board, self._arm_tries, mode, alone, patience, on_armed)
                arming.disarmed_seen = not self.board_armed
                self._ask_to_arm(arming)
                return arming
            if self._arming.mode != mode or on_armed is not None:
                raise RefusedError(f"The robot is already being armed for {self._arming.mode}.")
            return self._arming

    def continue_arming(self) -> None:
        """Complete arming when the board is armed, or ask again; call it every `ARM_WAIT` at least."""
        with self._changed:
            arming = self._arming
            if arming is None:
                return
            if not arming.disarmed_seen:
                arming.disarmed_seen = not self.board_armed
            elif self.board_armed:
                self._become_armed(arming)
                return
            if arming.tries > 0:
                self._ask_to_arm(arming)
            else:
                self._line.send(Stop())
                self._end_arming("The board did not arm; the console shows the reason. Try again.")

    def change_mode(self, mode: Mode) -> None:
        """Change between manual and automatic while armed. Raise RefusedError with all reasons."""
        with self._changed:
            if self.mode == mode:
                return
            if mode not in _CHANGE or follow(self.mode, _CHANGE[mode]) is None:
                raise RefusedError(f"The robot is {self.mode}; it can change to {mode} only while armed.")
            if mode == "automatic" and (reasons := self.detector.depth_refusals()):
                raise RefusedError(" ".join(reasons))
            self.pilot.begin()
            self._go(_CHANGE[mode])
            text = "The pilot steers." if mode == "manual" else "The controller steers."
            self._event("mode", "info", text)

    def acknowledge(self) -> None:
        """Acknowledge the alarms; after a failsafe the robot may be armed again."""
        with self._changed:
            self._alarms.acknowledge()
            if self._go("acknowledge"):
                self._event("mode", "info", "The failsafe is acknowledged; the robot is disarmed.")

    def stop(self, why: str) -> None:
        """Disarm at once, in any state."""
        with self._changed:
            # Before STOP is sent, so that the board's report of it is no fault.
            self._leave("stop", "info", why)
        self._line.send(Stop())

    def fail(self, fault: str) -> None:
        """Stop the robot for this fault, which is over at once."""
        with self._changed:
            if self.armed:
                self._fail(fault)

    def end_fin_check(self) -> None:
        """Disarm after a fin check and publish its result."""
        with self._changed:
            failed = self.fin_check.failed()
            if failed:
                moved = "; ".join(f"{fin} {how}" for fin, how in failed.items())
                self._alarms.begin("fin_failing", f"({moved})", active=False)
            text = f"Fin check: {len(failed)} of 4 fins did not follow." if failed else _ALL_FINS_FOLLOWED
            self._leave("checked", "caution" if failed else "info", text, kind="fin_check")
        self._line.send(Stop())

    def tick(self) -> None:
        """Check for faults and take their actions; repeat STOP until the board is disarmed."""
        with self._changed:
            if self._hil is not None:
                self._hil.tick()
            if self.detector.note_check() and self.armed:
                self._fail("runtime_stalled")
            active = {alarm.fault for alarm in self._alarms.listed() if alarm.active}
            wrong = self.detector.active_faults(self.mode, active)
            self._alarms.update(wrong)
            for name, detail in wrong.items():
                if ROBOT_FAULTS[name].stops(self.mode):
                    if self.armed:
                        self._alarms.begin_again(name, detail)
                    self._all_stop()
            if not self.armed and self._arming is None and self.board_armed:
                self._line.send(Stop())

    def _become_armed(self, arming: Arming) -> None:
        self._end_arming("")
        self.detector.server_patience = self._heartbeat and max(self._heartbeat, arming.alone)
        self.detector.note_armed(arming.unwatched)
        self.pilot.begin()
        self.fin_check.begin()
        self.armed_since = self._clock.now()
        if arming.on_armed is not None:
            arming.on_armed()
        self._go(_ARM[arming.mode])
        self._event("armed", "info", _ARMED_WORDS[arming.mode] + self._unwatched_words(arming))

    def _unwatched_words(self, arming: Arming) -> str:
        """Return how long it may swim while nobody watches, where this arming says so."""
        if arming.unwatched == self._unwatched or arming.on_armed is not None:
            return ""
        if not arming.unwatched:
            return " It goes on while nobody watches."
        return f" It goes on for {arming.unwatched:g} s while nobody watches."

    def _ask_to_arm(self, arming: Arming) -> None:
        # Repeated because the board requires half a second of steady traffic first. It ignores repetitions,
        # and the line never has two of them in transit.
        arming.tries -= 1
        if not arming.disarmed_seen:
            self._line.send(Stop())
        elif arming.board is not None:
            self._line.send(Start(epoch=arming.board.epoch))

    def _end_arming(self, refusal: str) -> None:
        if self._arming is not None:
            self._arming.refusal, self._arming.over = refusal, True
            self._arming = None
        self._changed.notify_all()

    def _fail(self, name: str) -> None:
        """Add an alarm for a fault that is over already, and stop the robot."""
        self._alarms.begin(name, active=False)
        self._all_stop()

    def _all_stop(self) -> None:
        was_armed = self._leave("fault", "alarm", f"All-stop: the fins are stopped. {_ACKNOWLEDGE}")
        # A board that a low battery disarmed turns the fins down, and cannot be armed before its next reset.
        # STOP would cut the motor power before they are down.
        if was_armed and not self._low_battery_disarmed:
            self._line.send(Stop())

    def _leave(self, trigger: Trigger, severity: Severity, why: str, kind: str = "disarmed") -> bool:
        """Leave any armed state; return True if it was in one."""
        was_armed = self.armed
        self._end_arming("Stopped before the board was armed.")
        self._go(trigger)
        if was_armed:
            self.armed_since = None
            self.detector.note_stopped()
            self._event(kind, severity, why)
        return was_armed

    def _go(self, trigger: Trigger) -> bool:
        after = follow(self.mode, trigger)
        if after is not None:
            self.mode = after
            self._on_mode(after)
        return after is not None

    def _event(self, kind: str, severity: Severity, text: str) -> None:
        self._on_event(Event(time=self._clock.now(), kind=kind, severity=severity, text=text))


_ACKNOWLEDGE = "Acknowledge the alarms before the robot is armed again."
_ARMED_FLAG = int(StatusFlag.ARMED)
"""A plain integer: an enumeration's operators cost ten times as much."""
_BATTERY_LOW_FLAG = int(StatusFlag.BATTERY_LOW)
_ALL_FINS_FOLLOWED = "Fin check: all four fins followed."
