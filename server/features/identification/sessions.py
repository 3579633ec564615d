"""The streams of recorded sessions for identification."""

import numpy as np

from robot_runtime.contract.topics import DEPTH, IMU, MOTOR
from robot_runtime.experiments.identification.streams import SessionStreams
from server.library.content import Recording, reading_content
from server.metrics.series import Floats
from server.platform.store import Reader


def read_streams(store: Reader, session: int) -> SessionStreams:
    """Return the streams of a session. Raise UnknownSessionError, StoreError, RecordingError."""
    recording = Recording.open(store, session)
    with reading_content(recording.row):
        motor, angles = _columns(recording, MOTOR.name, "angle", 4)
        inertial, rates = _columns(recording, IMU.name, "rate", 3)
        _, forces = _columns(recording, IMU.name, "force", 3)
        _, attitudes = _columns(recording, IMU.name, "attitude", 4)
        times, depth = recording.columns(DEPTH.name, ["depth", "pressure"])
        start = recording.row.started_steady
        order = np.argsort(inertial, kind="stable")
        motor_order, depth_order = np.argsort(motor, kind="stable"), np.argsort(times, kind="stable")
        return SessionStreams(
            name=recording.row.name,
            motor_times=(motor - start)[motor_order],
            angles=angles[motor_order],
            imu_times=(inertial - start)[order],
            rates=rates[order],
            forces=forces[order],
            attitudes=attitudes[order],
            depth_times=(times - start)[depth_order],
            depths=depth["depth"][depth_order],
            pressures=depth["pressure"][depth_order],
        )


def _columns(recording: Recording, topic: str, field: str, count: int) -> tuple[Floats, Floats]:
    """Return times and values of a field of several numbers, of shape (samples, count)."""
    names = [f"{field}_{index}" for index in range(count)]
    times, values = recording.columns(topic, names)
    return times, np.stack([values[name] for name in names], axis=1)
