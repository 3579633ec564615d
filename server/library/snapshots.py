"""Snapshots of a session, each with the values at its moment, read from the recorded samples."""

from itertools import islice

from pydantic import Field

from robot_runtime.contract.topics import DEPTH, IMU, SNAPSHOT, TRACK
from robot_runtime.control.attitude import euler_angles
from server.library.content import Recording
from server.library.readings import newest_row
from server.platform.schema_base import Schema

SNAPSHOTS_SHOWN = 60
"""Snapshots in one answer."""


class EstimatedPosition(Schema):
    """The position by dead reckoning since the robot was armed, m: an estimate whose error grows."""

    x: float = Field(description="along heading 0")
    y: float = Field(description="along heading 90°")
    deviation_x: float = Field(description="standard deviation")
    deviation_y: float = Field(description="standard deviation")


class SnapshotValues(Schema):
    """The moment of a snapshot and the robot's values then; null where none was measured."""

    time: float = Field(description="s since the session's start")
    utc: float = Field(description="the same moment, s since 1970")
    depth: float | None = Field(description="m")
    heading: float | None = Field(description="rad")
    pitch: float | None = Field(description="rad")
    roll: float | None = Field(description="rad")
    position: EstimatedPosition | None


def list_snapshots(recording: Recording, after: float) -> list[SnapshotValues]:
    """Return the values of the snapshots after a time (s, steady clock), the first `SNAPSHOTS_SHOWN`.

    Raise StoreError, RecordingError.
    """
    if SNAPSHOT.name not in recording.topics:
        return []
    times = (time for time, _ in recording.pictures(SNAPSHOT.name, after) if time > after)
    return [read_values(recording, time) for time in islice(times, SNAPSHOTS_SHOWN)]


def read_values(recording: Recording, time: float) -> SnapshotValues:
    """Return the values at a time (s, steady clock). Raise StoreError, RecordingError."""
    depth = newest_row(recording, DEPTH.name, time)
    imu = newest_row(recording, IMU.name, time)
    track = newest_row(recording, TRACK.name, time)
    heading, pitch, roll = (
        (None, None, None)
        if imu is None
        else euler_angles((imu["attitude_0"], imu["attitude_1"], imu["attitude_2"], imu["attitude_3"]))
    )
    return SnapshotValues(
        time=time - _zero(recording),
        utc=recording.row.started + time - _zero(recording),
        depth=None if depth is None else depth["depth"],
        heading=heading,
        pitch=pitch,
        roll=roll,
        position=None if track is None else EstimatedPosition.model_validate(track),
    )


def _zero(recording: Recording) -> float:
    return recording.row.started_steady
