"""The calibration in EEPROM: refused, stored, read back, applied; what cannot be is not kept."""

from dataclasses import replace
from itertools import permutations, product
from math import pi

import pytest

from robot_runtime.contract.calibration import EMULATED, STEPS, CalibrationValues, StepName
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.packets import (
    CHIP_PARAMETERS,
    Beacon,
    Calibration,
    CalibrationStep,
    Depth,
    Imu,
    Motor,
    Parameter,
    RequestCalibration,
    ResetCause,
    Start,
    Status,
    StatusFlag,
    ZeroDepth,
)
from tests.firmware.robot import SURFACE, CompiledRobot, hello, navigation

STORED = EMULATED.packet()
WRITTEN = 350
"""ms in which the whole record is written and read: 30 bytes, one a tick."""


def answers(robot: CompiledRobot) -> list[Calibration]:
    return [packet for packet in robot.received if isinstance(packet, Calibration)]


def stored_calibration(robot: CompiledRobot) -> Calibration:
    """Return the calibration of the board's answer."""
    before = len(answers(robot))
    robot.say(RequestCalibration())
    robot.run(50)
    assert len(answers(robot)) == before + 1
    return answers(robot)[-1]


def store(robot: CompiledRobot, calibration: Calibration) -> Calibration:
    """Store this; return the board's answer."""
    robot.say(calibration)
    robot.beat(WRITTEN, every=50)
    return answers(robot)[-1]


def start(robot: CompiledRobot) -> bool:
    """Return True if the board arms; else it says a line."""
    robot.say(Start(epoch=robot.epoch))
    robot.run(30)
    return bool(robot.status().flags & StatusFlag.ARMED)


def fresh(robot: CompiledRobot) -> CompiledRobot:
    """Return the same robot with an erased EEPROM."""
    robot.firmware.board_erase_eeprom()
    robot.reset(ResetCause.POWER_ON)
    robot.run(50)
    robot.greet()
    return robot


def test_the_board_tells_what_it_keeps(robot: CompiledRobot) -> None:
    robot.greet()
    assert stored_calibration(robot) == STORED


def test_a_fresh_board_refuses_to_arm_and_names_the_missing_steps(robot: CompiledRobot) -> None:
    fresh(robot)
    assert stored_calibration(robot).done == 0
    assert not start(robot)
    steps = "fins, motors, IMU axes, gyroscope, pressure, battery, beacons"
    assert robot.texts[-1] == f"START refused: not calibrated: {steps}"


@pytest.mark.parametrize(
    ("step", "message"),
    list(
        zip(
            STEPS,
            ["fins", "motors", "IMU axes", "gyroscope", "pressure", "battery", "beacons"],
            strict=True,
        )
    ),
)
def test_each_step_alone_is_missed(robot: CompiledRobot, step: StepName, message: str) -> None:
    robot.greet()
    store(robot, replace(STORED, done=STORED.done & ~CalibrationStep[step.upper()]))
    assert not start(robot)
    assert robot.texts[-1] == f"START refused: not calibrated: {message}"
    store(robot, STORED)
    assert start(robot)


def test_a_stored_calibration_survives_a_reset(robot: CompiledRobot) -> None:
    robot.greet()
    other = replace(STORED, fin_zeros=(1, 2, 3, 1023), axes=(-2, 1, 3), gyro_bias=(0.1, -0.2, 0.3))
    answer = store(robot, other)
    assert answer.to_bytes() == other.to_bytes()
    robot.reset(ResetCause.POWER_ON)
    robot.run(50)
    robot.greet()
    assert stored_calibration(robot) == answer
    assert start(robot)


def test_while_it_is_written_the_board_does_not_arm(robot: CompiledRobot) -> None:
    robot.greet()
    robot.say(replace(STORED, fin_zeros=(1, 2, 3, 4)))
    robot.run(100)
    assert not start(robot)


def test_a_power_cut_while_it_is_written_leaves_none(robot: CompiledRobot) -> None:
    robot.greet()
    robot.say(replace(STORED, fin_zeros=(1, 2, 3, 4)))
    robot.run(100)
    robot.reset(ResetCause.POWER_ON)
    robot.run(50)
    robot.greet()
    assert stored_calibration(robot).done == 0
    assert not start(robot)


@pytest.mark.parametrize("index", range(30))
def test_a_record_with_a_wrong_byte_is_none(robot: CompiledRobot, index: int) -> None:
    robot.firmware.board_flip_eeprom(index)
    robot.reset(ResetCause.POWER_ON)
    robot.run(50)
    robot.greet()
    assert stored_calibration(robot).done == 0


@pytest.mark.parametrize(
    "impossible",
    [
        {"axes": (1, 1, 3)},
        {"axes": (0, 1, 2)},
        {"axes": (1, 2, 4)},
        {"axes": (1, 2, -128)},
        {"axes": (1, 2, -3)},
        {"battery_factor": 0.0},
        {"battery_factor": 0.79},
        {"battery_factor": 1.26},
    ],
)
def test_what_cannot_be_is_not_kept(robot: CompiledRobot, impossible: dict[str, object]) -> None:
    robot.greet()
    assert store(robot, replace(STORED, **impossible)) == STORED  # type: ignore[arg-type]
    assert start(robot)


def test_before_a_greeting_nothing_is_stored(robot: CompiledRobot) -> None:
    """The host's definitions are not known yet."""
    robot.run(50)
    robot.say(replace(STORED, fin_zeros=(1, 2, 3, 4)), Parameter(number=0, value=CHIP_PARAMETERS[0].minimum))
    robot.run(WRITTEN)
    robot.greet()
    assert stored_calibration(robot) == STORED
    assert not any(isinstance(packet, Parameter) for packet in robot.received)


def is_turn(axes: tuple[int, int, int]) -> bool:
    try:
        CalibrationValues.from_packet(replace(STORED, axes=axes))
    except ConfigError:
        return False
    return True


def test_the_board_accepts_the_axes_that_this_computer_accepts(robot: CompiledRobot) -> None:
    robot.greet()
    triples = [
        (a * forward, b * right, c * down)
        for forward, right, down in permutations((1, 2, 3))
        for a, b, c in product((1, -1), repeat=3)
    ]
    accepted = [axes for axes in triples if store(robot, replace(STORED, axes=axes)).axes == axes]
    assert accepted == [axes for axes in triples if is_turn(axes)]
    assert len(accepted) == 24


def test_an_armed_board_keeps_what_it_has(robot: CompiledRobot) -> None:
    robot.arm()
    assert store(robot, replace(STORED, fin_zeros=(1, 2, 3, 4))) == STORED
    robot.say(ZeroDepth())
    robot.pressure.show(SURFACE + 9810)
    robot.beat(500)
    assert robot.last(Depth).depth == pytest.approx(1.0, abs=0.002)


def test_axes_and_bias_of_the_imu_are_applied(robot: CompiledRobot) -> None:
    scale = Imu.wires["rate"].scale
    robot.greet()
    store(robot, replace(STORED, axes=(2, -1, 3), gyro_bias=(10 * scale, -20 * scale, 30 * scale)))
    robot.imu.rate, robot.imu.force = (100, 200, -32768), (1000, 2000, -8000)
    robot.run(50)
    imu = robot.last(Imu)
    assert imu.rate == pytest.approx((190 * scale, -80 * scale, -32768 * scale))
    assert imu.force == pytest.approx(tuple(x * Imu.wires["force"].scale for x in (2000, -1000, -8000)))


def test_a_reversed_axis_of_the_most_negative_reading_does_not_wrap(robot: CompiledRobot) -> None:
    robot.greet()
    store(robot, replace(STORED, axes=(1, -2, -3)))
    robot.imu.rate = (0, 0, -32768)
    robot.run(50)
    assert robot.last(Imu).rate[2] == pytest.approx(32767 * Imu.wires["rate"].scale)


def test_a_bias_that_is_taken_away_leaves_the_heading_still(robot: CompiledRobot) -> None:
    """5 °/s of offset turned the heading by 300° a minute."""
    offset = 5 * pi / 180
    counts = round(offset / Imu.wires["rate"].scale)
    robot.imu.rate, robot.imu.force = (0, 0, counts), (0, 0, -8192)
    robot.greet()
    store(robot, replace(STORED, gyro_bias=(0, 0, counts * Imu.wires["rate"].scale)))
    robot.reset(ResetCause.POWER_ON)
    robot.run(60_000)
    w, _, _, z = robot.last(Imu).attitude
    assert abs(2 * z / w) < 0.01


def test_the_pressures_offset_is_taken_away_and_moves_no_depth(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    store(robot, replace(STORED, pressure_offset=-450))
    robot.run(100)
    assert robot.last(Depth).pressure == pytest.approx(SURFACE + 450, abs=3)
    assert robot.last(Depth).depth == pytest.approx(0, abs=0.002)


def test_the_battery_is_trimmed(robot: CompiledRobot) -> None:
    before = robot.status().battery
    robot.greet()
    store(robot, replace(STORED, battery_factor=0.95))
    robot.run(200)
    assert robot.status().battery == pytest.approx(0.95 * before, abs=0.001)


@pytest.mark.parametrize("inverted", [0, 1])
def test_the_beacons_polarity(robot: CompiledRobot, inverted: int) -> None:
    robot.greet()
    store(robot, replace(STORED, beacons_inverted=inverted))
    robot.firmware.board_set_beacons(True, False)
    robot.run(200)
    assert (robot.last(Beacon).right, robot.last(Beacon).left) == (1 - inverted, inverted)


def test_directions_and_zeros_of_the_fins_are_applied(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(50)
    before = robot.last(Motor).angle
    first, two, three, four = ((zero + 256) % 1024 for zero in EMULATED.fin_zeros)
    store(robot, replace(STORED, fin_zeros=(first, two, three, four)))
    robot.run(50)
    turn = [now - then for now, then in zip(robot.last(Motor).angle, before, strict=True)]
    # A quarter of a turn; the counts of the right fins fall as their tips go down.
    assert turn == pytest.approx([pi / 2, pi / 2, -pi / 2, -pi / 2], abs=0.002)
    store(robot, replace(STORED, encoders_reversed=STORED.encoders_reversed ^ 0b1111))
    robot.run(50)
    assert robot.last(Motor).angle == pytest.approx([-angle for angle in before], abs=0.002)


def test_a_wrong_direction_of_a_motor_is_stopped(robot: CompiledRobot) -> None:
    robot.greet()
    store(robot, replace(STORED, motors_reversed=STORED.motors_reversed ^ 0b0001))
    robot.arm()
    robot.swim(600, navigation(z=1))
    assert robot.last(Status).faults


@pytest.mark.parametrize(("density", "depth"), [(1.0, 1.0), (1.025, 1 / 1.025)])
def test_the_waters_density_scales_the_depth(robot: CompiledRobot, density: float, depth: float) -> None:
    number = [parameter.name for parameter in CHIP_PARAMETERS].index("water.density")
    robot.greet()
    robot.run(500)
    robot.say(Parameter(number=number, value=density))
    robot.pressure.show(SURFACE + 9810)
    robot.run(100)
    assert robot.last(Depth).depth == pytest.approx(depth, abs=0.0015)


def test_zero_depth_measures_the_surface_anew(robot: CompiledRobot) -> None:
    robot.greet()
    robot.run(500)
    robot.pressure.show(SURFACE + 4905)
    robot.run(100)
    assert robot.last(Depth).depth == pytest.approx(0.5, abs=0.002)
    robot.say(ZeroDepth())
    robot.run(600)
    assert robot.last(Depth).depth == pytest.approx(0, abs=0.002)
    robot.reset(ResetCause.WATCHDOG)
    robot.run(200)
    assert robot.last(Depth).depth == pytest.approx(0, abs=0.002)


def test_a_board_with_other_definitions_keeps_what_it_has(robot: CompiledRobot) -> None:
    robot.say(hello(definitions=1))
    robot.run(50)
    robot.say(replace(STORED, fin_zeros=(1, 2, 3, 4)))
    robot.run(WRITTEN)
    robot.say(hello())
    robot.run(50)
    assert stored_calibration(robot) == STORED


def test_every_values_survives_the_line() -> None:
    values = replace(
        EMULATED,
        done=("fins", "gyro"),
        axes=("-z", "y", "x"),
        encoders_reversed=(False, True, False, True),
        motors_reversed=(True, False, False, False),
        pressure_offset=-1234,
        battery_factor=1.0321,
        beacons_inverted=True,
    )
    again = CalibrationValues.from_packet(Calibration.from_bytes(values.packet().to_bytes()))
    assert replace(again, gyro_bias=values.gyro_bias) == values
