"""Parameters on the chip: limited, always confirmed, lost at a reset."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract.packets import (
    CHIP_PARAMETERS,
    DEFINITIONS_HASH,
    Motor,
    Packet,
    Parameter,
    ResetCause,
    StatusFlag,
)
from robot_runtime.contract.packets.layout import LayoutError
from tests.firmware.library import load
from tests.firmware.robot import BATTERY_FULL, CompiledRobot, hello, navigation

NUMBERS = {parameter.name: number for number, parameter in enumerate(CHIP_PARAMETERS)}
WORD = 65.535
"""The largest value that fits the line."""
RESTING = 0.02
"""rad that a fin at rest may move."""


def tune(robot: CompiledRobot, name: str, value: float) -> float:
    """Return the value in force, from the board's answer."""
    robot.say(Parameter(number=NUMBERS[name], value=value))
    answers = [packet for packet in robot.run(50) if isinstance(packet, Parameter)]
    assert [answer.number for answer in answers] == [NUMBERS[name]]
    return answers[0].value


def set_swing(packets: list[Packet]) -> float:
    """Commanded swing of the first fin, rad, peak to peak."""
    set_points = [packet.wanted[0] for packet in packets if isinstance(packet, Motor)]
    return max(set_points) - min(set_points)


@pytest.mark.parametrize("name", NUMBERS)
def test_values_are_accepted_within_their_range_only(robot: CompiledRobot, name: str) -> None:
    limits = CHIP_PARAMETERS[NUMBERS[name]]
    robot.greet()
    assert tune(robot, name, limits.minimum) == pytest.approx(limits.minimum)
    assert tune(robot, name, limits.minimum - 0.001) == pytest.approx(limits.minimum)
    assert tune(robot, name, limits.maximum) == pytest.approx(limits.maximum)
    assert tune(robot, name, limits.maximum + 0.001) == pytest.approx(limits.maximum)
    assert tune(robot, name, limits.default) == pytest.approx(limits.default)


@given(number=st.integers(0, 255), value=st.floats(0, WORD))
def test_no_value_out_of_range_is_ever_in_force(number: int, value: float) -> None:
    with CompiledRobot(load()) as robot:
        robot.greet()
        robot.say(Parameter(number=number, value=value))
        answers = [packet for packet in robot.run(50) if isinstance(packet, Parameter)]
        if number >= len(CHIP_PARAMETERS):
            assert answers == []
            return
        limits = CHIP_PARAMETERS[number]
        output = round(value, 3)
        taken = limits.minimum <= output <= limits.maximum
        assert [answer.value for answer in answers] == [pytest.approx(output if taken else limits.default)]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_nan_cannot_be_encoded(value: float) -> None:
    with pytest.raises(LayoutError):
        Parameter(number=0, value=value).to_bytes()


def test_a_reset_brings_the_defaults_back(robot: CompiledRobot) -> None:
    robot.greet()
    tune(robot, "fins.amplitude", 0.8)
    robot.reset(ResetCause.EXTERNAL)
    robot.greet()
    # A refused value is answered with the value in force.
    assert tune(robot, "fins.amplitude", 0.0) == pytest.approx(1.6)


def test_host_of_other_definitions_changes_nothing(robot: CompiledRobot) -> None:
    robot.greet()
    robot.say(hello(DEFINITIONS_HASH ^ 1))
    robot.run(50)
    robot.say(Parameter(number=NUMBERS["fins.amplitude"], value=0.8))
    assert not any(isinstance(packet, Parameter) for packet in robot.run(100))
    robot.say(hello())
    robot.run(50)
    assert tune(robot, "fins.amplitude", 0.0) == pytest.approx(1.6)


def test_every_answer_is_sent_despite_a_full_queue(robot: CompiledRobot) -> None:
    """After a start debug lines fill the board's queue; each answer waits for room."""
    robot.say(hello())
    robot.run(20)
    robot.say(
        *(
            Parameter(number=number, value=parameter.maximum)
            for number, parameter in enumerate(CHIP_PARAMETERS)
        )
    )
    answers = [packet for packet in robot.run(1000) if isinstance(packet, Parameter)]
    assert {answer.number: answer.value for answer in answers} == {
        number: pytest.approx(parameter.maximum) for number, parameter in enumerate(CHIP_PARAMETERS)
    }


def test_amplitude_is_that_of_full_command(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, navigation(x=1))
    tune(robot, "fins.amplitude", 0.4)
    robot.swim(500, navigation(x=1))
    robot.received.clear()
    robot.swim(1600, navigation(x=1))
    assert set_swing(robot.received) == pytest.approx(0.4, abs=0.02)


def strokes(robot: CompiledRobot, milliseconds: int) -> int:
    """Count of the first fin's strokes, from its set point."""
    robot.received.clear()
    robot.swim(milliseconds, navigation(x=1))
    set_points = [packet.wanted[0] for packet in robot.received if isinstance(packet, Motor)]
    return sum(before < 0 <= after for before, after in pairwise(set_points))


def test_frequency_is_that_of_the_strokes(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, navigation(x=1))
    assert strokes(robot, 5000) in (6, 7)
    tune(robot, "fins.frequency", 2.0)
    assert strokes(robot, 5000) in (9, 10, 11)


def test_a_slow_turn_takes_longer(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, navigation(z=1))
    assert tune(robot, "fins.turn_rate", 2.5) == 2.5
    robot.swim(100, navigation(z=1))
    # From tips up to tips down: half a turn.
    robot.received.clear()
    robot.swim(900, navigation(z=-0.01))
    assert abs(robot.last(Motor).wanted[0] - math.pi / 2) > 0.5
    robot.swim(700, navigation(z=-0.01))
    assert robot.last(Motor).wanted[0] == pytest.approx(math.pi / 2, abs=0.02)


def test_gain_drives_harder(robot: CompiledRobot) -> None:
    def drive() -> float:
        robot.received.clear()
        robot.swim(800, navigation(x=0.3))
        return max(abs(packet.drive[0]) for packet in robot.received if isinstance(packet, Motor))

    robot.arm()
    robot.swim(500, navigation(x=0.3))
    tune(robot, "fins.gain", 0.3)
    soft = drive()
    tune(robot, "fins.gain", 1.2)
    assert drive() > soft


def test_the_battery_s_alarm_waits_until_it_is_disarmed(robot: CompiledRobot) -> None:
    robot.arm()
    assert tune(robot, "battery.alarm", 7.4) == pytest.approx(6.2)
    assert robot.power


def test_the_battery_s_alarm_comes_at_its_voltage(robot: CompiledRobot) -> None:
    robot.firmware.board_set_battery(BATTERY_FULL)
    robot.greet()
    full = robot.status().battery
    assert tune(robot, "battery.alarm", 7.4) == pytest.approx(7.4)
    assert 6.2 < 7.0 < 7.4 < full
    robot.firmware.board_set_battery(716)  # 7.0 V
    robot.beat(19_000)
    assert not robot.status().flags & StatusFlag.BATTERY_LOW
    robot.beat(2_000)
    assert robot.status().flags & StatusFlag.BATTERY_LOW


@pytest.mark.parametrize(("frequency", "gain"), [(0.3, 0.3), (0.3, 1.2), (2.0, 0.3), (2.0, 1.2)])
def test_fins_rest_half_a_second_after_the_last_command_whatever_is_tuned(
    robot: CompiledRobot, frequency: float, gain: float
) -> None:
    robot.arm()
    tune(robot, "fins.frequency", frequency)
    tune(robot, "fins.gain", gain)
    tune(robot, "fins.turn_rate", 2.5)
    robot.swim(2000, navigation(x=1))
    robot.beat(500)
    robot.received.clear()
    robot.beat(300)
    angles = [packet.angle for packet in robot.received if isinstance(packet, Motor)]
    assert len(angles) > 5
    assert max(max(fin) - min(fin) for fin in zip(*angles, strict=True)) <= RESTING
