"""Prediction of recorded windows with a craft, from their first seconds."""

from dataclasses import dataclass

import numpy as np

from robot_runtime.contract.craft import Craft
from robot_runtime.experiments.identification.bodies import STATES, Floats
from robot_runtime.experiments.identification.fit import FIRST_WEIGHTS
from robot_runtime.experiments.identification.quantities import OFFSET_SPREADS
from robot_runtime.experiments.identification.shooting import OF_A_SESSION, OFFSETS, START_SPREADS, Shooting
from robot_runtime.experiments.identification.streams import EVERY, STEP, Windows

KNOWN = 2.0
"""s of a window from which its start and the IMU's offsets are found; the rest is predicted."""
KNOWN_MOMENTS = round(KNOWN / (STEP * EVERY))
_ITERATIONS = 4


@dataclass(frozen=True, slots=True)
class Predicted:
    """The channels as the craft predicts them, and their error after the known part."""

    channels: Floats
    """Of shape (windows, CHANNELS, moments), with the offsets of the IMU."""
    rms: Floats
    """Root of the mean squared error of each channel: m, rad/s, m/s²."""


def predict(windows: Windows, craft: Craft) -> Predicted:
    """Predict each window; start and offsets fit its first 2 s best (Gauss and Newton)."""
    shooting = Shooting(windows, craft)
    count = len(windows)
    offsets = np.zeros((count, OFFSETS))
    none = np.zeros(OF_A_SESSION * shooting.sessions)
    spreads = np.array(OFFSET_SPREADS)
    own = [
        slice(STATES + OF_A_SESSION * session, STATES + OF_A_SESSION * session + OFFSETS)
        for session in windows.sessions
    ]
    errors = np.empty(0)
    for iteration in range(_ITERATIONS + 1):
        errors, slopes = shooting.errors((), none)
        errors = errors.copy()
        errors[:, 1:] += offsets[:, :, None]
        if iteration == _ITERATIONS:
            break
        for window in range(count):
            known = errors[window, :, :KNOWN_MOMENTS] / FIRST_WEIGHTS[:, None]
            steep = slopes[window, :, :KNOWN_MOMENTS] / FIRST_WEIGHTS[:, None, None]
            columns = np.concatenate((steep[:, :, :STATES], steep[:, :, own[window]]), axis=2)
            away = np.concatenate(
                (
                    (shooting.states - shooting.guess)[:, window] / START_SPREADS,
                    offsets[window] / spreads,
                )
            )
            matrix = np.concatenate((columns.reshape(-1, columns.shape[2]), np.eye(len(away))))
            step = np.linalg.lstsq(matrix, np.concatenate((known.ravel(), away)), rcond=None)[0]
            states = shooting.states.copy()
            states[:, window] -= step[:STATES] * START_SPREADS
            shooting.states = states
            offsets[window] -= step[STATES:] * spreads
    return Predicted(
        channels=errors + windows.measured.transpose(2, 0, 1),
        rms=np.sqrt((errors[:, :, KNOWN_MOMENTS:] ** 2).mean(axis=(0, 2))),
    )
