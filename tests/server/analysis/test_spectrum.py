"""Spectra against SciPy's and against known sines, and one signal against another."""

import numpy as np
import pytest
from scipy.signal import welch

from server.analysis.spectrum import NoSpectrumError, find_spectrum, pair
from server.metrics.series import Floats, Series

RATE = 20.0


def sine(frequency: float, amplitude: float, seconds: float, rate: float = RATE) -> Series:
    times = np.arange(0, seconds, 1 / rate)
    return Series(times, 0.5 + amplitude * np.sin(2 * np.pi * frequency * times))


def noise(samples: int) -> Floats:
    return np.random.default_rng(5).normal(0, 0.1, samples)


@pytest.mark.parametrize("samples", [300, 2000, 20_000])
def test_the_density_is_that_of_scipy(samples: int) -> None:
    series = Series(np.arange(samples) / RATE, noise(samples))
    spectrum = find_spectrum(series)
    size = 2 * (spectrum.frequency.size - 1)
    frequency, density = welch(series.values, RATE, "hann", size)
    np.testing.assert_allclose(spectrum.frequency, frequency, rtol=1e-9)
    np.testing.assert_allclose(spectrum.density, density, rtol=1e-6)


def test_the_integral_of_the_density_is_the_variance() -> None:
    series = Series(np.arange(20_000) / RATE, noise(20_000))
    spectrum = find_spectrum(series)
    assert np.trapezoid(spectrum.density, spectrum.frequency) == pytest.approx(
        np.var(series.values), rel=0.02
    )


@pytest.mark.parametrize("frequency", [0.31, 0.4, 1.234, 7.7])
def test_the_peak_is_the_sine_in_the_signal(frequency: float) -> None:
    series = sine(frequency, 0.03, 120)
    spectrum = find_spectrum(Series(series.times, series.values + noise(series.times.size) / 100))
    assert spectrum.peak is not None
    assert spectrum.peak.frequency == pytest.approx(frequency, abs=0.01)
    assert spectrum.peak.amplitude == pytest.approx(0.03, rel=0.02)
    assert spectrum.peak.share > 0.95


def test_samples_at_uneven_times_have_the_same_peak() -> None:
    uneven = np.sort(np.random.default_rng(1).uniform(0, 120, 2400))
    spectrum = find_spectrum(Series(uneven, 0.1 * np.sin(2 * np.pi * 0.5 * uneven)))
    assert spectrum.peak is not None
    assert spectrum.peak.frequency == pytest.approx(0.5, abs=0.02)


def test_a_pause_is_not_filled() -> None:
    series = sine(0.5, 0.1, 120)
    there = (series.times < 40) | (series.times > 80)
    spectrum = find_spectrum(Series(series.times[there], series.values[there]))
    assert spectrum.segments == sum(1 + (800 - 256) // 128 for _ in range(2))
    assert spectrum.peak is not None
    assert spectrum.peak.amplitude == pytest.approx(0.1, rel=0.02)


def test_an_angle_goes_on_beyond_a_turn() -> None:
    times = np.arange(0, 120, 1 / RATE)
    angle = np.pi + 0.2 * np.sin(2 * np.pi * 0.5 * times)
    wrapped = Series(times, (angle + np.pi) % (2 * np.pi) - np.pi)
    spectrum = find_spectrum(wrapped, angle=True)
    assert spectrum.peak is not None
    assert spectrum.peak.amplitude == pytest.approx(0.2, rel=0.02)


def test_a_constant_has_no_peak() -> None:
    assert find_spectrum(Series(np.arange(500) / RATE, np.full(500, 0.7))).peak is None


@pytest.mark.parametrize("samples", [0, 2, 31])
def test_too_few_samples_are_refused_with_their_number(samples: int) -> None:
    with pytest.raises(NoSpectrumError, match=f"has {samples} samples in a row, and a spectrum needs 32"):
        find_spectrum(Series(np.arange(samples) / RATE, np.zeros(samples)))


def test_values_that_are_no_numbers_are_left_out() -> None:
    series = sine(0.5, 0.1, 60)
    series.values[::7] = np.nan
    spectrum = find_spectrum(series)
    assert spectrum.peak is not None
    assert spectrum.peak.frequency == pytest.approx(0.5, abs=0.02)


def test_a_signal_is_paired_with_another_between_its_samples() -> None:
    x = Series(np.array([0.0, 1.0, 2.0]), np.array([0.0, 10.0, 20.0]))
    y = Series(np.array([-1.0, 0.5, 1.5, 3.0]), np.array([9.0, 1.0, 2.0, 9.0]))
    times, across, up = pair(x, y, 100)
    assert (times.tolist(), across.tolist(), up.tolist()) == ([0.5, 1.5], [5.0, 15.0], [1.0, 2.0])


def test_pairs_are_thinned_and_none_lies_in_a_pause() -> None:
    x, y = sine(0.5, 1, 100), sine(0.3, 1, 100)
    there = (x.times < 30) | (x.times > 60)
    times, across, up = pair(Series(x.times[there], x.values[there]), y, 500)
    assert times.size == across.size == up.size <= 500
    assert not np.any((times > 30.1) & (times < 59.9))


def test_an_empty_signal_has_no_pairs() -> None:
    empty = Series(np.zeros(0), np.zeros(0))
    assert [part.size for part in pair(empty, sine(1, 1, 1), 10)] == [0, 0, 0]
