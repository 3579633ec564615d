"""One sensor: its noise, offset, steps and delay, and its faults."""

from itertools import pairwise
from math import sqrt
from statistics import fmean, stdev

import pytest

from robot_runtime.simulation.water.faults import NO_FAULT, SimulatedFault
from robot_runtime.simulation.water.parameters import SensorQuality
from robot_runtime.simulation.water.sensors import Numbers, Sensor

PERIOD = 0.005


def made(quality: SensorQuality, name: str = "pressure", axes: int = 1, seed: int = 1) -> Sensor:
    return Sensor(name, quality, axes, seed)


def series(sensor: Sensor, count: int, actual: Numbers = (0.0,), first: int = 1) -> list[float]:
    """Readings of the first axis, every 5 ms."""
    return [sensor.read((first + index) * PERIOD, actual)[0] for index in range(count)]


def ramp(sensor: Sensor, count: int) -> list[float]:
    """Readings of a sensor whose true value is the time."""
    return [sensor.read(index * PERIOD, (index * PERIOD,))[0] for index in range(1, count + 1)]


def test_a_perfect_sensor_returns_the_true_value() -> None:
    assert made(SensorQuality(), axes=3).read(PERIOD, (0.1, -0.2, 0.3)) == (0.1, -0.2, 0.3)


def test_noise_has_its_size_and_no_memory() -> None:
    readings = series(made(SensorQuality(noise=0.5)), 10_000)
    # Five standard errors of mean, deviation and correlation.
    assert fmean(readings) == pytest.approx(0, abs=5 * 0.5 / 100)
    assert stdev(readings) == pytest.approx(0.5, rel=5 / sqrt(20_000))
    together = fmean(early * late for early, late in pairwise(readings))
    assert together / 0.25 == pytest.approx(0, abs=0.05)


def test_each_axis_has_noise_and_offset_of_its_own() -> None:
    sensor = made(SensorQuality(noise=0.1, bias=1.0), axes=3)
    offsets = [
        fmean(axis) for axis in zip(*[sensor.read(i * PERIOD, (0, 0, 0)) for i in range(1, 500)], strict=True)
    ]
    assert len({round(offset, 2) for offset in offsets}) == 3


def test_offset_is_drawn_with_its_size_and_stays() -> None:
    offsets = []
    for seed in range(2000):
        first, last = series(made(SensorQuality(bias=0.2), seed=seed), 2)
        assert first == last
        offsets.append(first)
    assert stdev(offsets) == pytest.approx(0.2, rel=5 / sqrt(4000))


@pytest.mark.parametrize("seconds", [4, 16])
def test_the_offset_s_random_walk_grows_with_the_root_of_time(seconds: int) -> None:
    ends = []
    for seed in range(600):
        sensor = made(SensorQuality(walk=0.3, rate=1.0), seed=seed)
        ends.append([sensor.read(float(second), (0.0,))[0] for second in range(1, seconds + 1)][-1])
    assert stdev(ends) == pytest.approx(0.3 * sqrt(seconds), rel=5 / sqrt(1200))


def test_readings_come_in_steps() -> None:
    assert [made(SensorQuality(step=0.5)).read(PERIOD, (actual,))[0] for actual in (0.2, 0.3, -0.8, 7.0)] == [
        0,
        0.5,
        -1,
        7,
    ]


@pytest.mark.parametrize(
    ("rate", "expected"), [(200.0, 200), (1000.0, 200), (100.0, 100), (30.0, 30), (1.0, 1)]
)
def test_new_readings_come_at_their_rate(rate: float, expected: int) -> None:
    shown = ramp(made(SensorQuality(rate=rate)), 2000)
    assert len(set(shown)) == pytest.approx(10 * expected, abs=1)


@pytest.mark.parametrize("latency", [0.0, 0.005, 0.05])
def test_readings_come_late(latency: float) -> None:
    shown = ramp(made(SensorQuality(latency=latency)), 100)
    steps = round(latency / PERIOD)
    expected = [max(index - steps, 1) * PERIOD for index in range(1, 101)]
    assert shown == pytest.approx(expected)


def test_same_seed_and_name_same_readings() -> None:
    quality = SensorQuality(noise=1.0, bias=1.0, walk=1.0)
    assert series(made(quality), 50) == series(made(quality), 50)
    assert series(made(quality), 50) != series(made(quality, seed=2), 50)
    assert series(made(quality), 50) != series(made(quality, name="battery"), 50)


def broken(fault: SimulatedFault, count: int = 1000, quality: SensorQuality | None = None) -> list[float]:
    """Readings of a sensor whose true value is the time, with a fault after 1 s."""
    sensor = made(quality or SensorQuality())
    shown = []
    for index in range(1, count + 1):
        if index == 201:
            sensor.set_fault(fault, 200 * PERIOD)
        shown.append(sensor.read(index * PERIOD, (index * PERIOD,))[0])
    return shown


def test_a_stuck_sensor_repeats_the_last_reading() -> None:
    shown = broken(SimulatedFault(kind="stuck"))
    assert shown[:200] == ramp(made(SensorQuality()), 200)
    assert set(shown[200:]) == {1.0}


def test_a_sensor_stuck_from_the_beginning_repeats_the_first_reading() -> None:
    sensor = made(SensorQuality())
    sensor.set_fault(SimulatedFault(kind="stuck"), 0.0)
    assert ramp(sensor, 3) == [PERIOD, PERIOD, PERIOD]


def test_dropout_loses_its_share_and_keeps_the_last() -> None:
    shown = broken(SimulatedFault(kind="dropout", share=0.3), 4200)[200:]
    lost = sum(late == early for early, late in pairwise(shown)) / 3999
    assert lost == pytest.approx(0.3, abs=5 * sqrt(0.3 * 0.7 / 4000))
    assert all(late >= early for early, late in pairwise(shown))


def test_spikes_go_up_and_down_and_leave_the_rest() -> None:
    shown = broken(SimulatedFault(kind="spike", share=0.1, size=50.0), 4200)[200:]
    errors = [value - (201 + index) * PERIOD for index, value in enumerate(shown)]
    ups, downs = sum(error > 49 for error in errors), sum(error < -49 for error in errors)
    assert (ups + downs) / 4000 == pytest.approx(0.1, abs=5 * sqrt(0.09 / 4000))
    assert ups / (ups + downs) == pytest.approx(0.5, abs=5 * sqrt(0.25 / (ups + downs)))
    assert all(min(abs(error), abs(error - 50), abs(error + 50)) < 1e-9 for error in errors)


def test_drift_grows_from_the_time_of_its_request() -> None:
    shown = broken(SimulatedFault(kind="drift", speed=-2.0))
    for index in (201, 500, 1000):
        time = index * PERIOD
        assert shown[index - 1] == pytest.approx(time - 2.0 * (time - 1.0))


@pytest.mark.parametrize(
    "fault",
    [
        SimulatedFault(kind="stuck"),
        SimulatedFault(kind="dropout", share=0.5),
        SimulatedFault(kind="spike", share=0.5, size=3.0),
        SimulatedFault(kind="drift", speed=1.0),
        SimulatedFault(kind="bus"),
    ],
)
def test_after_a_fault_ends_readings_are_as_without_it(fault: SimulatedFault) -> None:
    quality = SensorQuality(noise=1.0, bias=1.0, walk=1.0)
    sound, mended = made(quality), made(quality)
    series(sound, 500)
    mended.set_fault(fault, 0.0)
    series(mended, 500)
    mended.set_fault(NO_FAULT, 2.5)
    assert series(mended, 500, first=501) == series(sound, 500, first=501)


@pytest.mark.parametrize(
    "numbers",
    [
        {"kind": "dropout"},
        {"kind": "stuck", "share": 0.5},
        {"kind": "dropout", "share": 0.0},
        {"kind": "dropout", "share": 1.5},
        {"kind": "dropout", "share": float("nan")},
        {"kind": "spike", "share": 0.5},
        {"kind": "spike", "share": 0.5, "size": -1.0},
        {"kind": "drift", "speed": float("inf")},
        {"kind": "tired"},
    ],
)
def test_invalid_faults_are_refused(numbers: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"takes|must be|there is no fault"):
        SimulatedFault(**numbers)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "numbers", [{"rate": 0.0}, {"noise": -1.0}, {"latency": float("nan")}, {"step": -0.1}]
)
def test_invalid_sensor_properties_are_refused(numbers: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must"):
        SensorQuality(**numbers)
