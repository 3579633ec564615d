"""The alarm list: active faults, and past ones that are not acknowledged yet.

The runtime has one for the robot (`robot_runtime.control.faults`), the server one for the processes around it
(`server.health.faults`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from graphlib import TopologicalSorter

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Alarm, Event, Severity

CLEAR_AFTER = 1.0
"""s without a fault of the robot after which its alarm ends, so that an intermittent fault is one alarm."""
OVER = "alarm_over"
"""The kind of the event at the end of an alarm; at its beginning it is the fault's name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultText:
    """The texts of a fault, in sentences; `what` is empty if each occurrence brings its own."""

    severity: Severity
    what: str
    cause: str
    remedy: str
    consequences: tuple[str, ...] = ()
    """Names of the faults that follow from this one, here or in the other list."""


def check_consequences(*lists: Mapping[str, FaultText]) -> None:
    """Raise ValueError where a consequence is no fault of these lists, or follows from itself."""
    follows: dict[str, set[str]] = {}
    for name, fault in (entry for faults in lists for entry in faults.items()):
        follows.setdefault(name, set()).update(fault.consequences)
    if unknown := {name for names in follows.values() for name in names} - follows.keys():
        raise ValueError(f"consequences that are no faults: {', '.join(sorted(unknown))}")
    TopologicalSorter(follows).prepare()


class Alarms:
    """The alarms; each start and end is published as an event, and `changed` is called. Not thread-safe.

    A fault must be absent for `clear_after` s before its alarm is over.
    """

    def __init__(
        self,
        clock: Clock,
        faults: Mapping[str, FaultText],
        on_event: Callable[[Event], None],
        *,
        clear_after: float = 0.0,
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        self._clock = clock
        self._faults = faults
        self._on_event = on_event
        self._clear_after = clear_after
        self._changed = changed
        self._alarms: dict[str, Alarm] = {}
        self._last: dict[str, float] = {}

    def update(self, wrong: Mapping[str, str]) -> None:
        """Set the active faults: name and detail of each."""
        for name in dict.fromkeys([*wrong, *self._alarms]):
            self.see(name, name in wrong, wrong.get(name, ""))

    def see(self, name: str, wrong: bool, detail: str = "") -> None:
        """Set the state of this fault; a new detail of an active fault is no new alarm."""
        now, alarm = self._clock.now(), self._alarms.get(name)
        active = alarm is not None and alarm.active
        if wrong:
            self._last[name] = now
            if alarm is None or not active:
                self.begin(name, detail)
            elif detail not in alarm.what:
                self._alarms[name] = replace(alarm, what=f"{self._faults[name].what} {detail}".strip())
                self._changed()
        elif alarm is not None and active and now - self._last[name] >= self._clear_after:
            self._end(alarm)

    def begin(self, name: str, detail: str = "", *, active: bool = True) -> None:
        """Begin an alarm. It is active until `see` finds the fault gone; if not `active`, it is past."""
        fault, now = self._faults[name], self._clock.now()
        what = f"{fault.what} {detail}".strip()
        self._last[name] = now
        self._alarms[name] = Alarm(
            fault=name,
            severity=fault.severity,
            since=now,
            until=None if active else now,
            active=active,
            acknowledged=False,
            what=what,
            cause=fault.cause,
            remedy=fault.remedy,
            consequences=list(fault.consequences),
        )
        text = f"{what} {fault.cause} {fault.remedy}"
        self._on_event(Event(time=now, kind=name, severity=fault.severity, text=text))
        self._changed()

    def begin_again(self, name: str, detail: str = "") -> None:
        """Begin an acknowledged alarm again, because its fault has stopped the robot once more."""
        if self._alarms[name].acknowledged:
            self.begin(name, detail)

    def acknowledge(self) -> None:
        """Acknowledge all alarms; those that are over are removed."""
        self._alarms = {
            name: replace(alarm, acknowledged=True) for name, alarm in self._alarms.items() if alarm.active
        }
        self._changed()

    def listed(self) -> list[Alarm]:
        """Return all alarms, the newest last."""
        return sorted(self._alarms.values(), key=lambda alarm: alarm.since)

    def _end(self, alarm: Alarm) -> None:
        if alarm.acknowledged:
            del self._alarms[alarm.fault]
        else:
            self._alarms[alarm.fault] = replace(alarm, active=False, until=self._last[alarm.fault])
        text = f"Cleared: {alarm.what}"
        self._on_event(Event(time=self._clock.now(), kind=OVER, severity="info", text=text))
        self._changed()
