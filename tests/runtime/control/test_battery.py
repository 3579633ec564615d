"""The battery's time against the truth of the simulated pack, and the refusal of what takes longer."""

import pytest

from robot_runtime.contract.battery_pack import charge_at, resting_voltage, seconds_left
from robot_runtime.errors import RefusedError
from tests.runtime.control.flight import Flight
from tests.runtime.missions.water import mission

NEARLY_EMPTY = "[robot]\nbattery_full = 7.0\nbattery_capacity = 0.84"


@pytest.mark.parametrize("charge", [0.0, 0.02, 0.1, 0.5, 0.9, 1.0])
def test_a_voltage_at_rest_tells_the_charge(charge: float) -> None:
    assert charge_at(resting_voltage(charge)) == pytest.approx(charge, abs=1e-6)


def test_a_full_pack_lasts_for_its_energy_and_one_at_its_alarm_for_nothing() -> None:
    # 7.2 V and 3.35 Ah are 24.1 Wh, of which 1.6 % are left at 6.2 V.
    assert seconds_left(8.3, 6.2, 3.35, 5.4) / 3600 == pytest.approx(24.1 * 0.984 / 5.4, rel=0.01)
    assert seconds_left(6.2, 6.2, 3.35, 5.4) == 0.0 == seconds_left(5.9, 6.2, 3.35, 5.4)


def test_the_time_that_is_left_is_true_and_not_too_long() -> None:
    with Flight(more=NEARLY_EMPTY) as flight:
        flight.arm()
        flight.run(10.0)
        estimates: list[tuple[float, float]] = []
        while not flight.alarm("battery_low"):
            left = flight.robot.state().battery_left
            assert left is not None
            estimates.append((flight.now, left))
            flight.run(10.0)
        for when, left in estimates[:-4]:
            true = flight.now - when
            assert 0.55 * true < left < 1.1 * true, (when, left, true)


def test_a_mission_that_takes_longer_is_refused_with_the_figures() -> None:
    hold = "{ do = 'hold', seconds = 400 }"
    with Flight(more=NEARLY_EMPTY) as flight:
        flight.run(10.0)
        left = flight.robot.state().battery_left
        assert left is not None
        assert 60 < left < 240
        text = mission("{ do = 'dive', depth = 0.6 }", hold, limits="time = 3600")
        with pytest.raises(RefusedError, match=rf"lasts {left // 60:.0f} min more.*may take \d+ min. Charge"):
            flight.robot.missions.load(text, {})
        flight.robot.missions.load(mission("{ do = 'wait', seconds = 20 }"), {})


def test_an_unmeasured_battery_and_an_unknown_capacity_have_no_time() -> None:
    with Flight() as flight:
        flight.run(10.0)
        assert (flight.robot.state().battery_left or 0) > 3 * 3600
        flight.break_("battery", "drift", speed=-10.0)
        flight.run(3.0)
        assert flight.robot.state().battery_left is None
