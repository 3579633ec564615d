"""Figures of step responses and relay cycles, against systems with closed-form solutions."""

from math import acos, degrees, exp, nan, pi, radians, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_runtime.contract.documents import Turning
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, row
from server.features.tuning.curve import SampleBuffer, TuningCurve
from server.features.tuning.figure_definitions import meanings
from server.features.tuning.figures import measure_response
from server.features.tuning.relay import measure_limit_cycle
from server.features.tuning.rules import RULES, propose, ultimate_gain

FROM, TO, SECONDS, RATE = 0.4, 0.7, 20.0, 10.0


def second_order(damping: float, frequency: float) -> TuningCurve:
    """From FROM to TO at 0 s; wn² / (s² + 2 ζ wn s + wn²)."""
    curve = TuningCurve([], [], [], [])
    ringing = frequency * sqrt(1 - damping**2)
    for tick in range(-20, round(SECONDS * RATE) + 1):
        time = tick / RATE
        share = 0.0
        if time > 0:
            wave = np.sin(ringing * time + acos(damping)) / sqrt(1 - damping**2)
            share = 1 - exp(-damping * frequency * time) * float(wave)
        curve.add(time, FROM if time < 0 else TO, FROM + (TO - FROM) * share, 1.0 - share)
    return curve


def figures(curve: TuningCurve, loop: str = "depth") -> dict[str, float | None]:
    measured = measure_response(curve, SampleBuffer(loop), loop, 100.0, 100.0 + SECONDS)
    return {name: figure.value for name, figure in measured.items()}


@settings(max_examples=30, deadline=None)
@given(damping=st.floats(0.3, 0.8), frequency=st.floats(1.0, 2.5))
def test_second_order_systems(damping: float, frequency: float) -> None:
    result = figures(second_order(damping, frequency))
    # Between two samples the peak is missed by at most half a sample of a sine.
    missed = 1 - np.cos(frequency / RATE / 2)
    expected = 100 * exp(-pi * damping / sqrt(1 - damping**2))
    assert result["overshoot"] == pytest.approx(expected, abs=100 * missed + 1e-3)
    # The envelope is an upper bound of what is outside the band, and half a turn later a lower one.
    bound = -np.log(0.05 * sqrt(1 - damping**2)) / (damping * frequency)
    half = pi / (frequency * sqrt(1 - damping**2))
    assert result["settling_share"] is not None
    assert bound - half - 0.1 <= result["settling_share"] <= bound + 0.1
    assert result["rise_time"] is not None
    assert 0.8 < result["rise_time"] * frequency < 2.6


def test_figures_that_follow_by_arithmetic() -> None:
    curve = TuningCurve([], [], [], [])
    for tick in range(-10, 101):
        curve.add(tick / 10, 0.4 if tick < 0 else 0.9, 0.4 if tick < 50 else 0.86, 0.5 if tick % 2 else -0.5)
    result = figures(curve)
    assert result["steady_error"] == pytest.approx(0.04)
    assert result["steady_swing"] == pytest.approx(0.0)
    assert result["iae"] == pytest.approx(0.5 * 4.9 + 0.27 * 0.1 + 0.04 * 5.0)
    assert result["effort"] == pytest.approx(50.0)
    assert result["travel"] == pytest.approx(100.0)
    assert result["rise_time"] == pytest.approx(0.1 * 0.8 * 0.5 / 0.46)
    assert result["settling_near"] is None
    assert result["fin_strokes"] is None


def test_angles_are_reported_in_degrees() -> None:
    curve = TuningCurve([], [], [], [])
    for tick in range(-10, 101):
        curve.add(tick / 10, 0.0 if tick < 0 else 0.5, 0.0 if tick < 10 else 0.49, 0.0)
    result = figures(curve, "heading")
    assert result["steady_error"] == pytest.approx(degrees(0.01))
    assert result["settling_near"] == pytest.approx(1.0)
    units = {meaning.name: meaning.unit for meaning in meanings("heading")}
    assert (units["steady_error"], units["iae"]) == ("°", "° s")


def test_a_step_across_south_is_as_small_as_it_is() -> None:
    """From 170° to -170° are 20°, also where the value swings over the edge and back."""
    samples = SampleBuffer("heading")
    for tick in range(60):
        set_point = radians(170.0 if tick < 20 else -170.0)
        value = radians(170.0 if tick < 30 else -168.0 if tick < 40 else -171.0)
        columns = {"set_point": set_point, "measured": value, "output": 0.1}
        turning = Turning(**{name: (sample, nan, nan) for name, sample in columns.items()})
        samples.see(Block.of(BY_NAME["turning"], 1, tick, row(100.0 + tick / 10, turning.to_bytes())))
    result = figures(samples.curve.between(100.0, 107.0, 102.0), "heading")
    assert result["overshoot"] == pytest.approx(10.0, abs=0.01)
    assert result["steady_error"] == pytest.approx(1.0, abs=0.001)
    assert result["iae"] == pytest.approx(20.0 * 1.0 + 2.0 * 1.0 + 1.0 * 2.0, abs=1.5)


@pytest.mark.parametrize("loop", ["depth", "roll"])
def test_every_figure_has_a_meaning(loop: str) -> None:
    assert list(figures(second_order(0.5, 1.0), loop)) != []
    assert {meaning.name for meaning in meanings(loop)} == set(figures(second_order(0.5, 1.0), loop))


def relayed(gain: float, lag: float, delay: float, hysteresis: float, amplitude: float) -> TuningCurve:
    """Return a relay on gain e^(-delay s) / (s (lag s + 1)), simulated finely and sampled at 10 Hz."""
    step, value, speed, side = 0.002, 0.0, 0.0, 1.0
    waiting = [1.0] * round(delay / step)
    curve = TuningCurve([], [], [], [])
    for tick in range(round(60.0 / step)):
        error = -value
        side = 1.0 if error > hysteresis else -1.0 if error < -hysteresis else side
        waiting.append(side)
        speed += step / lag * (gain * amplitude * waiting.pop(0) - speed)
        value += step * speed
        if tick % round(1 / RATE / step) == 0:
            curve.add(tick * step, 0.0, value, amplitude * side)
    return curve


@pytest.mark.parametrize(("lag", "delay"), [(0.5, 0.4), (1.0, 0.3), (2.0, 0.5)])
def test_the_ultimate_point_of_an_integrator_with_lag_and_delay(lag: float, delay: float) -> None:
    """Known from the phase: pi/2 = delay w + atan(lag w); the describing function is within 10 % or so."""
    low, high = 0.01, 20.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if delay * middle + np.arctan(lag * middle) < pi / 2 else (low, middle)
    gain = 0.2
    known_gain = low * sqrt(1 + (lag * low) ** 2) / gain
    result = measure_limit_cycle(relayed(gain, lag, delay, 0.0, 0.5), 20.0, 0.0)
    assert result.period == pytest.approx(2 * pi / low, rel=0.1)
    assert result.ultimate_gain == pytest.approx(known_gain, rel=0.15)
    assert abs(result.asymmetry) < 0.05
    assert result.remarks == []


def test_a_load_shows_as_asymmetry() -> None:
    curve = TuningCurve([], [], [], [])
    for tick in range(400):
        side = 1.0 if (tick + 20) % 40 < 28 else -1.0
        curve.add(tick / 10, 0.6, 0.6 + 0.05 * np.sin(tick / 40 * 2 * pi), 0.1 + 0.5 * side)
    result = measure_limit_cycle(curve, 0.0, 0.01)
    assert result.asymmetry == pytest.approx(0.4)
    assert result.bias == pytest.approx(0.1)
    assert result.amplitude == pytest.approx(0.5)
    assert result.period == pytest.approx(4.0)
    assert "One half of each cycle is much longer" in result.remarks[0]


def test_a_response_without_a_cycle_is_reported() -> None:
    with pytest.raises(ValueError, match="no whole cycle"):
        measure_limit_cycle(TuningCurve([], [], [], []), 0.0, 0.01)
    with pytest.raises(ValueError, match="beyond the hysteresis"):
        ultimate_gain(0.5, 0.01, 0.01)


def test_the_rules() -> None:
    """Ku 9, Pu 4 s, by hand from the sources."""
    gains = {rule.name: rule.gains(9.0, 4.0) for rule in RULES}
    assert gains["ziegler_nichols"] == pytest.approx({"kp": 5.4, "ki": 2.7, "kd": 2.7})
    assert gains["no_overshoot"] == pytest.approx({"kp": 1.8, "ki": 0.9, "kd": 2.4})
    assert gains["some_overshoot"] == pytest.approx({"kp": 3.0, "ki": 1.5, "kd": 4.0})
    assert gains["tyreus_luyben"] == pytest.approx({"kp": 4.0909, "ki": 0.46488, "kd": 2.5974}, rel=1e-4)
    assert gains["amigo"] == pytest.approx({"kp": 2.7, "ki": 1.125, "kd": 1.62})


def test_proposals_name_gains_out_of_range() -> None:
    cycle = measure_limit_cycle(relayed(0.2, 1.0, 0.3, 0.0, 0.5), 20.0, 0.0)
    limits = {"kp": (0.0, 50.0), "ki": (0.0, 20.0), "kd": (0.0, 0.1)}
    proposals = {proposal.rule: proposal for proposal in propose("depth", cycle, limits)}
    assert len(proposals) == len(RULES)
    assert proposals["amigo"].problem == "kd may be 0 to 0.1."
    assert "amigo" not in {proposal.rule for proposal in propose("roll", cycle, limits)}
    assert all(proposal.problem == "" for proposal in propose("depth", cycle, limits | {"kd": (0.0, 50.0)}))


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-1e3, 1e3)] * 4), max_size=50))
def test_curves_are_stored_unchanged(ticks: list[tuple[float, float, float, float]]) -> None:
    curve = TuningCurve([], [], [], [])
    for tick in ticks:
        curve.add(*tick)
    assert TuningCurve.from_bytes(curve.to_bytes()) == curve
    assert TuningCurve.from_bytes(b"") == TuningCurve([], [], [], [])


def test_the_figures_lie_on_the_curve() -> None:
    curve = second_order(0.4, 2.0)
    measured = measure_response(curve, SampleBuffer("depth"), "depth", 100.0, 100.0 + SECONDS)
    marks = {name: mark for name, figure in measured.items() if (mark := figure.mark) is not None}
    assert marks.keys() == {"rise_time", "overshoot", "settling_share", "settling_near"}
    rise, over, near = (marks[name] for name in ("rise_time", "overshoot", "settling_near"))
    assert (rise.low, rise.high) == pytest.approx((FROM + 0.1 * (TO - FROM), FROM + 0.9 * (TO - FROM)))
    assert np.interp([rise.start, rise.end], curve.times, curve.values) == pytest.approx(
        [rise.low, rise.high]
    )
    assert over.high == max(curve.values)
    assert np.interp(over.end, curve.times, curve.values) == over.high
    assert (near.start, near.end) == (0.0, measured["settling_near"].value)
    assert (near.low, near.high) == pytest.approx((TO - 0.02, TO + 0.02))
