"""What is wrong with the processes around the robot, and was, until somebody has acknowledged it.

The runtime has alarms of its own for the robot, in its `state`; these are the server's, of what it alone can
see. Each becomes a notice too, and so an event in a recording.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Alarm, Severity
from server.processes.supervisor import Tell


@dataclass(frozen=True, slots=True)
class Fault:
    """One kind of alarm; the words for a person are sentences. `what` is "" where each time has its own."""

    severity: Severity
    what: str
    cause: str
    remedy: str


_PART = "It crashed, was killed, or the computer ran out of memory."
_LOGS = "It is started again by itself. Where that goes on, the System page and its log say more."
FAULTS = {
    "runtime_silent": Fault(
        "alarm",
        "The robot's runtime says nothing.",
        "It hangs, or the computer is overloaded.",
        "The board stops the fins by itself after 1 s. After 10 s the runtime is ended and started again, "
        "disarmed; nothing is to be done.",
    ),
    "runtime_down": Fault("alarm", "", _PART, _LOGS),
    "board_down": Fault("alarm", "", _PART, _LOGS),
    "simulator_down": Fault("caution", "", _PART, _LOGS),
    "scene_down": Fault("caution", "", _PART, _LOGS),
    "simulator_silent": Fault(
        "caution",
        "The simulated water stands still.",
        "The simulator hangs, or the computer is overloaded.",
        "End the simulator, which is then started again.",
    ),
    "server_restarted": Fault(
        "caution",
        "",
        _PART,
        "A robot that was armed is stopped where the server is away for more than 4 s. Nothing is to be "
        "done; where it happens again, look into the words that it prints.",
    ),
    "disk_low": Fault(
        "caution",
        "The disk is almost full.",
        "Recordings or exports have filled it.",
        "Remove sessions or exports, or have old ones removed by themselves (keep_free in robot.toml).",
    ),
    "store_failing": Fault(
        "alarm",
        "Nothing can be stored.",
        "The disk is full, broken or read-only.",
        "Free some space, or check the disk. Up to 8 MB of a recording wait meanwhile.",
    ),
}


class Alarms:
    """All that are active, or not acknowledged yet; `changed` is called whenever they are different."""

    def __init__(self, clock: Clock, tell: Tell, changed: Callable[[], None]) -> None:
        self._clock = clock
        self._tell = tell
        self._changed = changed
        self._alarms: dict[str, Alarm] = {}

    @property
    def all(self) -> list[Alarm]:
        """The newest last."""
        return sorted(self._alarms.values(), key=lambda alarm: alarm.since)

    def see(self, fault: str, wrong: bool) -> None:
        """Whether this is wrong now."""
        alarm = self._alarms.get(fault)
        if wrong and (alarm is None or not alarm.active):
            self.begin(fault, FAULTS[fault].what)
        elif alarm is not None and alarm.active and not wrong:
            self._end(alarm)

    def begin(self, fault: str, what: str) -> None:
        """Something of this kind has happened; `see` says when it is over."""
        kind = FAULTS[fault]
        self._alarms[fault] = Alarm(
            fault=fault,
            severity=kind.severity,
            since=self._clock.now(),
            active=True,
            acknowledged=False,
            what=what,
            cause=kind.cause,
            remedy=kind.remedy,
        )
        self._tell(fault, kind.severity, what)
        self._changed()

    def acknowledge(self) -> None:
        """Somebody has taken note of all of them; those that are over are gone."""
        self._alarms = {
            fault: replace(alarm, acknowledged=True) for fault, alarm in self._alarms.items() if alarm.active
        }
        self._changed()

    def _end(self, alarm: Alarm) -> None:
        if alarm.acknowledged:
            del self._alarms[alarm.fault]
        else:
            self._alarms[alarm.fault] = replace(alarm, active=False)
        self._changed()
