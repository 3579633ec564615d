"""The board's clock in host time: offset, drift, delays, pauses, wrapping."""

import random

import pytest

from robot_runtime.link.board_time import BoardTime


def test_stamps_become_host_time_less_the_shortest_delay() -> None:
    times = BoardTime()
    delays = [0.004, 0.002, 0.009, 0.003]
    hosts = [
        times.to_host(1_000_000 + step * 10_000, 50.0 + step * 0.01 + delay)
        for step, delay in enumerate(delays)
    ]
    assert hosts[1:] == pytest.approx([50.012, 50.022, 50.032], abs=1e-5)


def test_stamps_wrap_and_may_step_back_a_little() -> None:
    times = BoardTime()
    before = times.to_host(0xFFFF_FF00, 10.0)
    after = times.to_host(0x0000_0100, 10.000512)
    earlier = times.to_host(0x0000_0000, 10.000600)
    assert after - before == pytest.approx(512e-6, abs=1e-6)
    assert earlier - before == pytest.approx(256e-6, abs=1e-6)


@pytest.mark.parametrize("minutes", [1, 40, 60, 75, 110, 300])
def test_stamps_are_right_after_a_silence_of_any_length(minutes: float) -> None:
    times = BoardTime()
    ages = []
    for step in range(1200):
        arrival = step * 0.01 + (60 * minutes if step >= 600 else 0.0)
        ages.append(arrival - times.to_host(round(arrival * 1e6) % (1 << 32), arrival))
    assert ages == pytest.approx([0.0] * 1200, abs=1e-3)


def test_after_a_pause_the_board_s_clock_is_trusted_again_within_two_seconds() -> None:
    times = BoardTime()
    ages = []
    for step in range(600):
        arrival, paused = step * 0.01, 1.5 if step >= 200 else 0.0
        ages.append(arrival + paused - times.to_host(step * 10_000, arrival + paused))
    assert max(ages[:200]) == pytest.approx(0.0, abs=1e-6)
    assert max(ages[400:]) == pytest.approx(0.0, abs=1e-6)


def test_a_slow_board_clock_is_followed() -> None:
    times, host = BoardTime(), 0.0
    for second in range(600):
        host = times.to_host(int(second * 1e6 * (1 - 100e-6)), float(second))
    assert host == pytest.approx(599.0, abs=0.001)


@pytest.mark.parametrize("drift", [-200e-6, 0.0, 50e-6, 200e-6])
def test_among_delays_offset_and_drift_are_found(drift: float) -> None:
    """Return delays of a port that is read every 30 ms, with some seconds in which every packet is late."""
    times, chance = BoardTime(), random.Random(5)
    errors = []
    for step in range(6000):
        taken = step * 0.01
        busy = 0.005 if step // 100 % 10 == 7 else 0.0
        host = times.to_host(round(taken * (1 - drift) * 1e6), taken + busy + chance.uniform(0.001, 0.031))
        errors.append(host - taken - 0.001)
    assert max(map(abs, errors[1000:])) < 0.002
    assert times.drift == pytest.approx(drift, abs=20e-6)
    assert 0 < times.error < 0.001


def test_no_packet_has_a_time_after_its_arrival_except_by_rounding() -> None:
    times, chance = BoardTime(), random.Random(6)
    for step in range(5000):
        arrival = step * 0.01 + chance.expovariate(200)
        assert times.to_host(step * 10_000, arrival) <= arrival + 50e-6


def test_a_second_of_late_packets_only_is_ignored() -> None:
    times = BoardTime()
    for step in range(2250):
        late = 0.008 if 1900 <= step < 2100 else 0.0
        times.to_host(step * 10_000, step * 0.01 + late)
    assert times.drift == pytest.approx(0.0, abs=1e-6)
    assert times.error < 1e-5


def test_after_a_pause_the_drift_is_estimated_anew() -> None:
    times = BoardTime()
    for step in range(4000):
        taken = step * 0.01
        times.to_host(round(taken * (1 - 1e-4) * 1e6), taken + (0.4 if step >= 1000 else 0.0))
    assert times.drift == pytest.approx(1e-4, abs=5e-6)
    assert times.error < 1e-4
