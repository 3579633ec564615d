"""The robot's values at a moment of a session."""

from pydantic import Field

from robot_runtime.contract.chunks import row_layout
from robot_runtime.contract.topics import CONTROL, DEPTH, IMU, MOTOR, STATUS
from robot_runtime.control.attitude import euler_angles
from server.library.content import Recording
from server.platform.schema_base import Schema

VALUE_SECONDS = 2.0
"""s before the moment: an older sample is no value of it."""
FINS = 4


class FinReading(Schema):
    """One fin: angles in rad, and the drive."""

    angle: float
    set_angle: float
    drive: float


class Readings(Schema):
    """The robot's values at a moment; null where none was measured within 2 s before."""

    time: float = Field(description="s since the session's start")
    depth: float | None = Field(description="m")
    set_point: float | None = Field(description="m, also while no depth is held")
    command: float | None = Field(description="of the depth's controller, -1 to 1, downwards")
    heading: float | None = Field(description="rad")
    pitch: float | None = Field(description="rad")
    roll: float | None = Field(description="rad")
    fins: list[FinReading] = Field(description="front right, back right, back left, front left; or empty")
    battery: float | None = Field(description="V")


def read_readings(recording: Recording, time: float) -> Readings:
    """Return the values at a time (s since the session's start). Raise StoreError, RecordingError."""
    at = recording.row.started_steady + time
    depth, control, imu, motor, status = (
        newest_row(recording, topic.name, at) or {} for topic in (DEPTH, CONTROL, IMU, MOTOR, STATUS)
    )
    heading, pitch, roll = (
        euler_angles((imu["attitude_0"], imu["attitude_1"], imu["attitude_2"], imu["attitude_3"]))
        if imu
        else (None, None, None)
    )
    fins = range(FINS) if motor else ()
    return Readings(
        time=time,
        depth=depth.get("depth"),
        set_point=control.get("set_point"),
        command=control.get("output"),
        heading=heading,
        pitch=pitch,
        roll=roll,
        fins=[
            FinReading(
                angle=motor[f"angle_{fin}"], set_angle=motor[f"wanted_{fin}"], drive=motor[f"drive_{fin}"]
            )
            for fin in fins
        ],
        battery=status.get("battery"),
    )


def newest_row(recording: Recording, topic: str, time: float) -> dict[str, float] | None:
    """Return the columns of the newest row at this time (s, steady clock), in their units; None without."""
    if topic not in recording.topics:
        return None
    layout = row_layout(recording.topics[topic])
    rows = (
        row
        for some in recording.rows(topic, time - VALUE_SECONDS, time)
        for row in layout.row.iter_unpack(some)
        if time - VALUE_SECONDS <= row[0] <= time
    )
    newest = max(rows, key=lambda row: row[0], default=None)
    if newest is None:
        return None
    values = zip(newest[1:], layout.scales, strict=True)
    return dict(zip(layout.names, (value * scale for value, scale in values), strict=True))
