"""The spectrum of a signal, and two signals as pairs of values.

The power spectral density is Welch's (The use of fast Fourier transform for the estimation of power spectra,
IEEE Transactions on Audio and Electroacoustics 15, 1967, 70-73): the mean of the periodograms of segments
that overlap by half, each without its mean and under a Hann window w,

    S(f) = 2 |sum w[n] x[n] exp(-2 pi i f n / rate)|² / (rate sum w[n]²),

one-sided: its integral over the frequency is the variance.
"""

from dataclasses import dataclass

import numpy as np

from server.analysis.decimation import usual_pause
from server.analysis.story_schemas import SpectrumPeak
from server.metrics.series import Floats, Series

SAMPLES_LEAST = 32
"""Fewer samples in a row tell nothing of frequencies."""
SEGMENT_LEAST = 256
"""Samples of a segment, where there are so many."""
SEGMENT_MOST = 8192
SEGMENTS = 8
"""Segments that a long range is divided into, at least."""
LOBE = 2
"""Frequencies on each side of a peak that a sine's power lies in, under a Hann window."""


class NoSpectrumError(Exception):
    """The range has no spectrum; the text says why."""


@dataclass(frozen=True, slots=True)
class Density:
    """A power spectral density: `frequency` in Hz, `density` in the signal's unit² per Hz, shape (n,) each.

    The samples came at `rate` (Hz); `segments` periodograms were averaged. `peak` is None for a constant.
    """

    frequency: Floats
    density: Floats
    rate: float
    segments: int
    peak: SpectrumPeak | None


def find_spectrum(series: Series, *, angle: bool = False) -> Density:
    """Return the spectrum of a signal's samples. Raise NoSpectrumError.

    The samples are laid on an even grid of their usual period by linear interpolation, and never across a
    pause. An `angle` (rad) goes on beyond a turn.
    """
    runs, rate = _even_runs(series, angle)
    longest = max((run.size for run in runs), default=0)
    if longest < SAMPLES_LEAST:
        raise NoSpectrumError(
            f"The range has {longest} samples in a row, and a spectrum needs {SAMPLES_LEAST}. "
            "Choose a longer range."
        )
    size = min(longest, int(np.clip(2 * longest // (SEGMENTS + 1), SEGMENT_LEAST, SEGMENT_MOST)))
    step = max(size // 2, 1)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    total, segments = np.zeros(size // 2 + 1), 0
    for run in runs:
        for start in range(0, run.size - size + 1, step):
            part = run[start : start + size]
            total += np.abs(np.fft.rfft(window * (part - part.mean()))) ** 2
            segments += 1
    density = total / (segments * rate * np.sum(window**2))
    # Frequency 0 and the highest one have no twin below 0.
    density[1 : (size + 1) // 2] *= 2
    frequency = np.arange(size // 2 + 1, dtype=np.float64) * (rate / size)
    return Density(frequency, density, rate, segments, _find_peak(frequency, density))


def pair(x: Series, y: Series, points: int, *, angle: bool = False) -> tuple[Floats, Floats, Floats]:
    """Return times (s) and both values at each, shape (n,), at most `points`, where both have samples.

    The times are those of `y`; the values of `x` lie between its samples (the nearest one's for an `angle`),
    and none lies in a pause.
    """
    if x.times.size == 0 or y.times.size == 0:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    taken = y.within(float(x.times[0]), float(x.times[-1]))
    every = max(1, -(-taken.times.size // points))
    times, values = taken.times[::every], taken.values[::every]
    after = np.clip(np.searchsorted(x.times, times), 1, max(x.times.size - 1, 1))
    before = after - 1
    after = np.minimum(after, x.times.size - 1)
    if angle:
        nearer = times - x.times[before] > x.times[after] - times
        across = x.values[np.where(nearer, after, before)]
    else:
        across = np.interp(times, x.times, x.values)
    there = (
        (x.times[after] - x.times[before] <= usual_pause(x.times)) & np.isfinite(across) & np.isfinite(values)
    )
    return times[there], across[there], values[there]


def _even_runs(series: Series, angle: bool) -> tuple[list[Floats], float]:
    """Return the samples on an even grid, a run for each time without a pause, and their rate (Hz)."""
    finite = np.isfinite(series.values)
    times, values = series.times[finite], series.values[finite]
    steps = np.diff(times)
    if not np.any(steps > 0):
        return [], 0.0
    period = float(np.median(steps[steps > 0]))
    pauses = np.flatnonzero(steps > usual_pause(times)) + 1
    runs: list[Floats] = []
    for run_times, run in zip(np.split(times, pauses), np.split(values, pauses), strict=True):
        grid = np.arange(run_times[0], run_times[-1] + period / 2, period)
        runs.append(np.interp(grid, run_times, np.unwrap(run) if angle else run))
    return runs, 1 / period


def _find_peak(frequency: Floats, density: Floats) -> SpectrumPeak | None:
    power = density * (frequency[1] - frequency[0])
    variance = float(power.sum())
    # Of a constant only the rounding is left.
    if variance < 1e-18 or density.size < 2 * LOBE:
        return None
    at = 1 + int(np.argmax(density[1:]))
    low, high = max(at - LOBE, 0), at + LOBE + 1
    inside = float(power[low:high].sum())
    centre = float((frequency[low:high] * power[low:high]).sum()) / inside
    return SpectrumPeak(frequency=centre, amplitude=float(np.sqrt(2 * inside)), share=inside / variance)
