"""Tracking error of a value against its set point, and the effort spent."""

import numpy as np

from server.features.metrics.series import Floats


def rms(errors: Floats) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(errors**2)))


def integral_absolute(times: Floats, errors: Floats) -> float:
    """Of the size of the error over time (s), by the trapezoidal rule."""
    return float(np.trapezoid(np.abs(errors), times))


def effort(outputs: Floats) -> float:
    """Mean size of the command, as a share of the most."""
    return float(np.mean(np.abs(outputs)))


def travel(outputs: Floats) -> float:
    """Sum of the command's changes, as a share of full command."""
    return float(np.abs(np.diff(outputs)).sum())
