"""Reads what identification needs of recorded sessions."""

import numpy as np

from robot_runtime.experiments.identification.streams import SessionStreams
from server.features.sessions.recording import Recording, reading_content
from server.features.sessions.session import find_row
from server.metrics.series import Floats
from server.platform.store import Reader


def read_streams(store: Reader, session: int) -> SessionStreams:
    """The streams of a session. Raises UnknownSessionError, StoreError, RecordingError."""
    recording = Recording(store, find_row(store, session))
    with reading_content(recording.row):
        motor, angles = _columns(recording, "motor", "angle", 4)
        inertial, rates = _columns(recording, "imu", "rate", 3)
        _, forces = _columns(recording, "imu", "force", 3)
        _, attitudes = _columns(recording, "imu", "attitude", 4)
        times, depth = recording.columns("depth", ["depth", "pressure"])
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
    """Times and values of a field of several numbers, of shape (samples, count)."""
    names = [f"{field}_{index}" for index in range(count)]
    times, values = recording.columns(topic, names)
    return times, np.stack([values[name] for name in names], axis=1)
