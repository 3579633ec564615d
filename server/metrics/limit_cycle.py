"""A limit cycle: a lasting oscillation of steady height, as a relay without dead band makes it.

Åström and Hägglund, Advanced PID Control, 2006, on relay auto-tuning. Its period is where the autocorrelation
of the signal has its first high maximum; its amplitude is peak to peak, the median over the periods. A signal
is taken to cycle only where that maximum is at least 0.5 (of white noise it is near 0) and it lasts for at
least three periods.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from server.metrics.series import Floats, Series

CORRELATION_LEAST = 0.5
PERIODS_LEAST = 3
AMPLITUDE_LEAST = 1e-6
SMOOTHED = 1 / 20


@dataclass(frozen=True, slots=True)
class LimitCycle:
    """Period in s; amplitude peak to peak, in the signal's unit; correlation from 0.5 to 1."""

    period: float
    amplitude: float
    correlation: float


def find_limit_cycle(signal: Series) -> LimitCycle | None:
    """Return the limit cycle of a signal's steady part; None where there is none."""
    if signal.times.size < 16:
        return None
    values, step = _even(signal)
    centred = values - values.mean()
    if np.ptp(centred) < AMPLITUDE_LEAST:
        return None
    correlation = _autocorrelation(centred)
    maximum = _first_high(correlation[: centred.size // PERIODS_LEAST + 1])
    if maximum is None:
        return None
    lag, height = maximum
    return LimitCycle(float(lag * step), _amplitude(values, lag), height)


def _even(signal: Series) -> tuple[Floats, float]:
    """Return the signal at equal steps (s) of its usual period."""
    step = float(np.median(np.diff(signal.times)))
    grid = np.arange(signal.times[0], signal.times[-1], step)
    return np.interp(grid, signal.times, signal.values), step


def _autocorrelation(centred: Floats) -> Floats:
    """Return, for each lag, the correlation of the overlapping parts, -1 to 1."""
    count = centred.size
    spectrum = np.fft.rfft(centred, 2 * count)
    products = np.fft.irfft(spectrum * spectrum.conj())[:count]
    squares = np.concatenate([[0.0], np.cumsum(centred**2)])
    lags = np.arange(count)
    energy = np.sqrt(squares[count - lags] * (squares[count] - squares[lags]))
    correlation: Floats = np.divide(products, energy, out=np.zeros(count), where=energy > 1e-12)
    return correlation


def _first_high(correlation: Floats) -> tuple[float, float] | None:
    """Return lag and height of the first high maximum after the correlation was negative."""
    negative = np.flatnonzero(correlation < 0)
    if not negative.size:
        return None
    begin = int(negative[0])
    inner = correlation[begin:]
    tops = np.flatnonzero((inner[1:-1] >= inner[:-2]) & (inner[1:-1] > inner[2:])) + 1 + begin
    if not tops.size:
        return None
    highest = float(correlation[tops].max())
    if highest < CORRELATION_LEAST:
        return None
    top = int(tops[np.flatnonzero(correlation[tops] >= 0.9 * highest)[0]])
    before, here, after = correlation[top - 1 : top + 2]
    bend = before - 2 * here + after
    return top + (0.5 * (before - after) / bend if bend else 0.0), float(here)


def _amplitude(values: Floats, period: float) -> float:
    """Return the median over whole periods of the distance between highest and lowest value.

    Averages over a twentieth of the period keep noise from adding to it; a sine loses 0.4 % by that.
    """
    width = max(1, round(period * SMOOTHED))
    values = np.convolve(values, np.full(width, 1 / width), "valid")
    edges = np.round(np.arange(0, values.size, period)).astype(int)
    heights = [np.ptp(values[first:last]) for first, last in pairwise(edges)]
    return float(np.median(heights))
