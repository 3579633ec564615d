"""Detects faults from the age and the content of what the board, the pilot and the server send.

Ages count from the arrival of a message, not from its stamp, because the clock of an emulated board that was
paused lags. Of a batch that waited to be read the newest arrived now, and stamps tell how much earlier the
others did. All times are of the steady clock, so that setting the computer's time has no effect.
"""

from collections.abc import Callable, Collection
from math import cos, pi
from typing import Protocol

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Mode
from robot_runtime.contract.packets import (
    FIN_COUNT,
    Depth,
    DeviceFault,
    Hello,
    Imu,
    Packet,
    Status,
    StatusFlag,
)
from robot_runtime.control.faults import CHECK_PERIOD, ROBOT_FAULTS
from robot_runtime.control.fin_check import FINS
from robot_runtime.control.hil_feed import HilFeed
from robot_runtime.control.pilot import Pilot
from robot_runtime.control.transitions import ARMED
from robot_runtime.link.timing import frames_airtime, stale_after
from robot_runtime.places import UPLOAD_REMEDY

ARRIVAL = 0.05
"""s that a message of the board may take to arrive."""
DEPTH_MIN, DEPTH_MAX = -1.0, 20.0
"""m: air pressure and sensor drift stay above the minimum, and the set point ends at 10 m."""
TOO_DEEP = 0.3
"""m below the greatest depth at which the robot is stopped; no controller overshoots by as much."""
REPEATS = 10
"""Equal readings in a row that no working sensor gives; see docs/reference/safety.md."""
TILT_MAX = 75 * pi / 180
"""rad between the robot's down and the world's; normal steering stays far below."""
AT_SURFACE = 0.2
"""m: greatest depth of a floating robot's pressure sensor, in waves."""
STACK_FREE_MIN = 64
"""B: least memory that the board's stack has left unused; `make firmware` leaves 100 or more."""
RISE_OVER = 9.5
"""s over which the rise is measured, after any motion downwards has ended."""
RISE_MIN = 0.1
"""m of rise in that time; in still water it is 0.3 m."""
IN_STEP_EARLY = 0.07
"""s by which limits are shorter where messages wait for the next check: a missing attitude is found within
two checks."""
_STATUS_STALE = 0.5
_NEVER = float("-inf")
_LIMITS = {name: fault.limit - CHECK_PERIOD for name, fault in ROBOT_FAULTS.items()}
"""s after which a check must detect each fault, to stay within its limit."""


class BoardLink(Protocol):
    """The part of the link to the board that control uses."""

    text: str
    baud: int

    @property
    def connected(self) -> bool:
        """True if the board answers and was built from the same definitions."""
        ...

    @property
    def board(self) -> Hello | None:
        """The greeting of the board."""
        ...

    def send(self, *packets: Packet) -> bool:
        """Send these packets; return False when there is no connection."""
        ...


class Repetition:
    """The repetitions of a sensor's reading."""

    def __init__(self) -> None:
        self._value: object = None
        self._since, self._count = _NEVER, 0

    def see(self, value: object, now: float) -> None:
        """Take a reading at `now` (s)."""
        if value == self._value:
            self._count += 1
        else:
            self._value, self._since, self._count = value, now, 0

    def last(self, limit: float, now: float) -> bool:
        """Return True if the reading has repeated for longer than `limit` (s), and REPEATS times."""
        return self._count >= REPEATS and now - self._since > limit


class FaultDetector:
    """Detects faults: `see_...` take the inputs, `active_faults` and `refusals` return the results.

    Without `heartbeat` no server is expected. `deepest`: the greatest depth, m.
    """

    def __init__(
        self,
        clock: Clock,
        line: BoardLink,
        pilot: Pilot,
        hil: HilFeed | None,
        heartbeat: float | None,
        arming_obstacles: Callable[[], list[str]],
        deepest: float,
    ) -> None:
        self.status: Status | None = None
        self.server_patience = heartbeat
        """s for which the server may be silent now; None where there is none."""
        self.watch_patience = 0.0
        """s for which nobody may watch the armed robot; 0: without an end."""
        self.early = 0.0
        """s by which what the board does not send, or repeats, is a fault earlier."""
        self._clock = clock
        self._line = line
        self._pilot = pilot
        self._hil = hil
        self._arming_obstacles = arming_obstacles
        self._deepest = deepest
        self._failing_fins = 0
        baud = line.baud
        self._silent = max(_LIMITS["board_silent"] - ARRIVAL, frames_airtime(3, baud))
        self._depth_stale = stale_after(_LIMITS["depth_stale"], Depth, baud)
        self._imu_stale = stale_after(ROBOT_FAULTS["imu_stale"].limit - ARRIVAL, Imu, baud)
        self._status_stale = stale_after(_STATUS_STALE, Status, baud)
        self._heard = self._heard_before = self._imu = self._upright = _NEVER
        self._status_time = self._depth_time = self._depth_sane = self._shallow = _NEVER
        self._depth = 0.0
        self._pressures, self._rates, self._forces = Repetition(), Repetition(), Repetition()
        self._server = self._checked = self._watched = clock.now()
        self._vision = float("inf")
        self._ascent: tuple[float, float] | None = None
        self._sinks = False

    def see_messages(self) -> None:
        """Note that messages came from the board."""
        self._heard_before, self._heard = self._heard, self._clock.now()

    def see_depth(self, depth: Depth, age: float = 0.0) -> None:
        """Take a depth; `age`: s by which it is older than the newest sample that came with it."""
        now = self._arrival(age)
        self._depth_time, self._depth = now, depth.depth
        if DEPTH_MIN <= depth.depth <= DEPTH_MAX:
            self._depth_sane = now
        if depth.depth <= self._deepest + TOO_DEEP:
            self._shallow = now
        self._pressures.see(depth.pressure, now)

    def see_imu(self, imu: Imu, age: float = 0.0) -> None:
        """Take an attitude; `age` as of a depth."""
        self._imu = self._arrival(age)
        self._rates.see(imu.rate, self._imu)
        self._forces.see(imu.force, self._imu)
        w, x, y, z = imu.attitude
        if w * w - x * x - y * y + z * z >= cos(TILT_MAX):
            self._upright = self._imu

    def see_status(self, status: Status) -> None:
        """Take the board's status."""
        self.status, self._status_time = status, self._clock.now()

    def see_server(self, *, watched: bool) -> None:
        """Note the server's heartbeat, and whether somebody watches the robot by it."""
        self._server = self._clock.now()
        if watched:
            self._watched = self._server

    def see_picture(self, taken: float) -> None:
        """Note the time (s) at which the newest searched picture was taken."""
        self._vision = taken

    def note_check(self) -> bool:
        """Record a check; return True if the previous one is too old to trust the inputs.

        After a stall, messages that waited are read as if they had just arrived.
        """
        stalled = self._age(self._checked) > _LIMITS["runtime_stalled"]
        self._checked = self._clock.now()
        return stalled

    def note_stopped(self) -> None:
        """Record that the fins were stopped: from now on the robot should rise."""
        self._ascent, self._sinks = (self._clock.now(), float("inf")), False

    def note_armed(self, watch_patience: float) -> None:
        """Note that the robot is armed again, and for how long (s) nobody may watch it; 0: without an end."""
        self._ascent, self._sinks = None, False
        self.watch_patience, self._watched = watch_patience, self._clock.now()

    def active_faults(self, mode: Mode, active: Collection[str]) -> dict[str, str]:
        """Return the active faults by name, each with a detail or an empty text.

        While the robot is disarmed, only faults with `always` and those already `active` are checked.
        """
        wrong = {
            name: ""
            for name, there in self._conditions(mode).items()
            if there and (mode != "disarmed" or ROBOT_FAULTS[name].always or name in active)
        }
        if "board_silent" in wrong and not self._line.connected:
            wrong["board_silent"] = f"There is no connection: {self._line.text}."
        if "fin_failing" in wrong:
            # All since the alarm began: a loose part fails again and again.
            before = self._failing_fins if "fin_failing" in active else 0
            self._failing_fins = before | (self._faults & _FIN_FAULTS)
            wrong["fin_failing"] = f"({', '.join(_failing(self._failing_fins))})"
        return wrong

    def refusals(self) -> list[str]:
        """Return the reasons against arming now; empty if there are none."""
        if not self._line.connected:
            return [f"There is no connection to the board: {self._line.text}."]
        status = self.status
        if status is None or self._age(self._status_time) > self._status_stale:
            return ["The board sends no status. Wait a moment, or reset it."]
        if bool(status.flags & StatusFlag.HIL) != (self._hil is not None):
            return [_WRONG_FIRMWARE if self._hil is None else _NO_HIL_FIRMWARE]
        reasons = self._hil.refusals() if self._hil else []
        depth = self.depth_refusals() or self._too_deep_refusals()
        return reasons or [*depth, *self._other_refusals(status), *self._arming_obstacles()]

    def depth_refusals(self) -> list[str]:
        """Return the reasons why the depth cannot be controlled now; empty if it can."""
        if self._faults & DeviceFault.PRESSURE:
            return ["The pressure sensor does not answer."]
        if self._age(self._depth_time) > self._depth_stale:
            return ["There is no fresh depth. Check the pressure sensor."]
        if self._depth_is_frozen():
            return ["The pressure reading is frozen. Check the sensor, or the simulator."]
        if self._age(self._depth_sane) > self._depth_stale:
            return [f"The depth of {self._depth:.1f} m is out of range. Zero the depth at the surface."]
        if self._faults & DeviceFault.SURFACE:
            return [_DEPTH_UNCERTAIN]
        return []

    def _too_deep_refusals(self) -> list[str]:
        if self._depth <= self._deepest + TOO_DEEP:
            return []
        return [
            f"It is at {self._depth:.1f} m, deeper than [control] deepest, {self._deepest:g} m. Let it rise."
        ]

    def _other_refusals(self, status: Status) -> list[str]:
        reasons = [f"The {part} does not answer." for part in _failing(self._faults & ~_TRACKING)]
        if self._faults & DeviceFault.IMU:
            reasons.append("The IMU does not answer.")
        elif self._imu_is_stale():
            reasons.append("There is no fresh attitude. Check the IMU.")
        elif self._imu_is_frozen():
            reasons.append("The IMU's reading is frozen. Check the IMU, or the simulator.")
        elif self._capsized():
            reasons.append("The robot lies on its side or on its back. Turn it upright.")
        if status.faults & DeviceFault.LEAK:
            reasons.append("There is water in the hull. Dry it, find the leak, and start the board again.")
        if status.flags & StatusFlag.BATTERY_LOW:
            reasons.append(f"The battery is low ({status.battery:.2f} V). Charge it.")
        if status.stack_free < STACK_FREE_MIN:
            reasons.append(
                f"The board's memory is nearly full ({status.stack_free} B are free). {_OTHER_PROGRAM}"
            )
        return reasons

    def _conditions(self, mode: Mode) -> dict[str, bool]:
        now, status, patience = self._clock.now(), self.status, self.server_patience
        pilot = now - self._pilot.taken if mode == "manual" else 0.0
        depth_age, depth_stale = now - self._depth_time, self._depth_stale - self.early
        imu_is_stale = self._imu_is_stale()
        return {
            "pilot_quiet": pilot > _LIMITS["pilot_quiet"],
            "pilot_lost": pilot > _LIMITS["pilot_lost"],
            "server_silent": patience is not None and now - self._server > patience,
            "unwatched": self._is_unwatched(mode),
            "board_silent": not self._line.connected or now - self._heard > self._silent - self.early,
            "depth_stale": depth_age > depth_stale,
            "depth_frozen": depth_age <= depth_stale and self._depth_is_frozen(),
            "depth_range": depth_age <= depth_stale < now - self._depth_sane,
            "too_deep": self._is_too_deep(),
            "imu_stale": imu_is_stale,
            "imu_frozen": not imu_is_stale and self._imu_is_frozen(),
            "capsized": self._capsized(),
            "vision_stale": mode == "automatic" and now - self._vision > _LIMITS["vision_stale"],
            "not_rising": self._does_not_rise(),
            "battery_low": status is not None and bool(status.flags & _BATTERY_LOW),
            "leak": bool(self._faults & _LEAK),
            "memory_low": status is not None and status.stack_free < STACK_FREE_MIN,
            "fin_failing": bool(self._faults & _FIN_FAULTS),
            "simulator_silent": self._hil is not None and self._hil.lost,
        }

    def _is_unwatched(self, mode: Mode) -> bool:
        """Return True if nobody has watched the armed robot for too long; only a server knows who does."""
        if mode not in ARMED or self.server_patience is None or not self.watch_patience:
            return False
        return self._age(self._watched) > self.watch_patience - CHECK_PERIOD

    def _is_too_deep(self) -> bool:
        """Return True if every depth for a while was too deep, and the newest is fresh and in range."""
        newest = self._depth_sane
        return self._age(newest) <= self._depth_stale and newest - self._shallow > _LIMITS["too_deep"]

    def _depth_is_frozen(self) -> bool:
        return self._pressures.last(_LIMITS["depth_frozen"] - self.early, self._clock.now())

    def _imu_is_frozen(self) -> bool:
        # In the loop the board repeats the simulator's last reading, whose silence is another fault.
        if self._hil is not None:
            return False
        limit, now = _LIMITS["imu_frozen"] - self.early, self._clock.now()
        return self._rates.last(limit, now) or self._forces.last(limit, now)

    def _imu_is_stale(self) -> bool:
        """Return True if the IMU alone is silent; a board that sends nothing at all is another fault."""
        return self._heard - self._imu > self._imu_stale - self.early

    def _capsized(self) -> bool:
        """Return True if the last attitude is upside down; a silent board has no known attitude."""
        return not self._imu_is_stale() and self._imu - self._upright > _LIMITS["capsized"]

    def _does_not_rise(self) -> bool:
        if self._ascent is None or self._depth <= AT_SURFACE:
            return False
        since, depth = self._ascent
        if self._age(since) >= RISE_OVER and self._age(self._depth_time) <= self._depth_stale:
            self._sinks = depth - self._depth < RISE_MIN
            self._ascent = self._clock.now(), self._depth
        return self._sinks

    @property
    def board_says_why(self) -> bool:
        """True if the board reports a fault by which it disarms: its alarm comes with the next check."""
        status = self.status
        return status is not None and bool(status.faults & _LEAK or status.flags & _BATTERY_LOW)

    @property
    def _faults(self) -> int:
        return self.status.faults if self.status is not None else 0

    def _arrival(self, age: float) -> float:
        """Return the time, s, at which a sample arrived that is so much older than the newest one."""
        now = self._clock.now()
        return min(max(now - age, self._heard_before), now)

    def _age(self, time: float) -> float:
        return self._clock.now() - time


def _failing(faults: int) -> list[str]:
    """Return the fins' parts that have one of these faults, as text."""
    return [part for fault, part in _FIN_PARTS.items() if faults & fault]


_FIN_PARTS = {
    int(first) << fin: f"{part} of the {name} fin"
    for first, part in (
        (DeviceFault.ENCODER_FRONT_RIGHT, "encoder"),
        (DeviceFault.BRIDGE_FRONT_RIGHT, "H-bridge"),
        (DeviceFault.TRACKING_FRONT_RIGHT, "motor"),
    )
    for fin, name in enumerate(FINS)
}
# Plain integers: the operators of enumerations cost ten times as much, and the faults are checked often.
_FIN_FAULTS = sum(_FIN_PARTS)
_BATTERY_LOW = int(StatusFlag.BATTERY_LOW)
_LEAK = int(DeviceFault.LEAK)
_TRACKING = sum(DeviceFault.TRACKING_FRONT_RIGHT << fin for fin in range(FIN_COUNT))
"""Only the next arming clears these, so they do not forbid it."""
_DEPTH_UNCERTAIN = (
    "The depth is uncertain, since the board's supply failed while the robot was armed or under water. "
    "Let it rise, or zero the depth at the surface."
)
_OTHER_PROGRAM = f"Upload firmware that checks its memory: {UPLOAD_REMEDY}."
_WRONG_FIRMWARE = (
    "The board runs the firmware for hardware in the loop, which drives no motors. Upload the "
    f"robot's own ({UPLOAD_REMEDY}), or set robot.mode to hil."
)
_NO_HIL_FIRMWARE = (
    f"The board does not run the firmware for hardware in the loop. Upload it: {UPLOAD_REMEDY}."
)
