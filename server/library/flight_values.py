"""The robot's values at any moment of a session, as the flight view shows them."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees
from typing import TYPE_CHECKING, Any

from robot_runtime.contract.topics import CONTROL, DEPTH, EVENT, IMU, NOTICE, STATE, AnyTopic
from robot_runtime.control.attitude import euler_angles
from server.library.content import Recording

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

VALUE_SECONDS = 2.0
"""s after which a sample is no value of the moment any more; states are in force longer."""
STATE_SECONDS = 5.0
EVENT_SECONDS = 4.0
"""s for which an event is shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attitude:
    """An attitude in degrees: heading from north, 0 to 360; pitch nose up; roll right side down."""

    heading: float
    pitch: float
    roll: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightValues:
    """The values at one moment; None where none was measured, or nothing is held.

    `time` in s since the session's start, depths in m, `heading_held` in degrees.
    """

    time: float
    depth: float | None = None
    depth_held: float | None = None
    attitude: Attitude | None = None
    heading_held: float | None = None
    mode: str = ""
    armed: bool = False
    controller: str = ""
    alarms: Sequence[str] = ()
    event: str = ""


class FlightReader:
    """The values of a session between two times (s, steady clock).

    Raises StoreError, RecordingError.
    """

    def __init__(self, recording: Recording, start: float, end: float) -> None:
        self._zero = recording.row.started_steady
        start -= STATE_SECONDS
        self._depth = _Rows(recording, DEPTH, ["depth"], start, end)
        self._control = _Rows(recording, CONTROL, ["set_point"], start, end)
        attitude = [f"attitude_{part}" for part in range(4)]
        self._imu = _Rows(recording, IMU, attitude, start, end)
        self._states = _Documents(recording, [STATE], start, end)
        self._events = _Documents(recording, [EVENT, NOTICE], start, end)

    def at(self, time: float) -> FlightValues:
        """Return the values at a time (s, steady clock)."""
        depth = self._depth.at(time)
        state = self._states.at(time, STATE_SECONDS) or {}
        armed = bool(state.get("armed"))
        loops = {loop["name"]: loop for loop in state.get("loops", ()) if armed and loop["on"]}
        control = self._control.at(time)
        depth_loop, heading_loop = loops.get("depth"), loops.get("heading")
        event = self._events.at(time, EVENT_SECONDS) or {}
        return FlightValues(
            time=time - self._zero,
            depth=None if depth is None else depth[0],
            depth_held=depth_loop and (control[0] if control else depth_loop["set_point"]),
            attitude=_attitude(self._imu.at(time)),
            heading_held=heading_loop and degrees(heading_loop["set_point"]) % 360.0,
            mode=state.get("mode", ""),
            armed=armed,
            controller=depth_loop["controller"] if depth_loop else "",
            alarms=[alarm["what"] for alarm in state.get("alarms", ()) if alarm["active"]],
            event=event.get("text", ""),
        )


def format_time(seconds: float) -> str:
    """Return a time since the session's start as minutes, seconds and tenths, or with hours."""
    tenths = max(0, round(10 * seconds))
    minutes, rest = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    clock = f"{minutes:02d}:{rest // 10:02d}.{rest % 10}"
    return f"{hours}:{clock}" if hours else clock


def _attitude(imu: Sequence[float] | None) -> Attitude | None:
    if imu is None:
        return None
    heading, pitch, roll = euler_angles((imu[0], imu[1], imu[2], imu[3]))
    return Attitude(heading=degrees(heading) % 360.0, pitch=degrees(pitch), roll=degrees(roll))


class _Rows:
    """Columns of a topic, the newest row at a time."""

    def __init__(
        self, recording: Recording, topic: AnyTopic, names: Sequence[str], start: float, end: float
    ) -> None:
        self._times: NDArray[np.float64] | None = None
        if topic.name in recording.topics:
            self._times, columns = recording.columns(topic.name, names, start, end)
            self._columns = [columns[name] for name in names]

    def at(self, time: float) -> Sequence[float] | None:
        """Return the columns of the newest row; None where there is none that is young enough."""
        if self._times is None:
            return None
        newest = int(self._times.searchsorted(time, "right")) - 1
        if newest < 0 or time - self._times[newest] > VALUE_SECONDS:
            return None
        return [float(column[newest]) for column in self._columns]


class _Documents:
    """Documents of topics, the newest one at a time."""

    def __init__(self, recording: Recording, topics: Sequence[AnyTopic], start: float, end: float) -> None:
        self._documents = sorted(
            (document for topic in topics for document in _documents(recording, topic, start, end)),
            key=lambda document: document["time"],
        )
        self._times = [document["time"] for document in self._documents]

    def at(self, time: float, seconds: float) -> dict[str, Any] | None:
        """Return the newest document; None where there is none of the last `seconds`."""
        newest = bisect_right(self._times, time) - 1
        if newest < 0 or time - self._times[newest] > seconds:
            return None
        return self._documents[newest]


def _documents(recording: Recording, topic: AnyTopic, start: float, end: float) -> Iterator[dict[str, Any]]:
    return recording.documents(topic.name, start, end) if topic.name in recording.topics else iter(())
