"""The alarm list: active faults, and past ones that are not acknowledged yet."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Alarm, Event
from robot_runtime.control.faults import BY_NAME

CLEAR_AFTER = 1.0
"""s without the fault after which an alarm ends, so that a flickering fault is one alarm."""


class Alarms:
    """The alarms; each start and end is published as an event. Not thread-safe."""

    def __init__(self, clock: Clock, on_event: Callable[[Event], None]) -> None:
        self._clock = clock
        self._on_event = on_event
        self._alarms: dict[str, Alarm] = {}
        self._last: dict[str, float] = {}

    def update(self, wrong: Mapping[str, str]) -> None:
        """Sets the active faults: name and detail of each."""
        now = self._clock.now()
        for name, detail in wrong.items():
            self._last[name] = now
            known = self._alarms.get(name)
            if known is None or not known.active:
                self._begin(name, detail, active=True)
        for name, alarm in list(self._alarms.items()):
            if alarm.active and name not in wrong and now - self._last[name] >= CLEAR_AFTER:
                self._end(name, alarm)

    def note(self, name: str, detail: str = "") -> None:
        """Adds a fault that is over already."""
        self._begin(name, detail, active=False)

    def acknowledge(self) -> None:
        """Acknowledges all alarms; those that are over are removed."""
        self._alarms = {
            name: replace(alarm, acknowledged=True) for name, alarm in self._alarms.items() if alarm.active
        }

    def listed(self) -> list[Alarm]:
        """Returns all alarms, the newest last."""
        return sorted(self._alarms.values(), key=lambda alarm: alarm.since)

    def _begin(self, name: str, detail: str, *, active: bool) -> None:
        fault, now = BY_NAME[name], self._clock.now()
        what = f"{fault.what} {detail}".strip()
        self._alarms[name] = Alarm(
            fault=name,
            severity=fault.severity,
            since=now,
            active=active,
            acknowledged=False,
            what=what,
            cause=fault.cause,
            remedy=fault.remedy,
        )
        self._on_event(
            Event(
                time=now, kind="alarm", severity=fault.severity, text=f"{what} {fault.cause} {fault.remedy}"
            )
        )

    def _end(self, name: str, alarm: Alarm) -> None:
        if alarm.acknowledged:
            del self._alarms[name]
        else:
            self._alarms[name] = replace(alarm, active=False)
        self._on_event(
            Event(time=self._clock.now(), kind="alarm", severity="info", text=f"It is over: {alarm.what}")
        )
