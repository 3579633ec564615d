"""Arming and disarming of the whole firmware, in simulated time."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    DebugLevel,
    DeviceFault,
    Heartbeat,
    Hello,
    Motor,
    Packet,
    ResetCause,
    Start,
    StatusFlag,
    Stop,
)
from tests.firmware.library import load
from tests.firmware.robot import CompiledRobot, hello, navigation

FORWARD = navigation(x=1)
RESTING = 0.02
"""rad that a fin at rest may move."""


def armed(robot: CompiledRobot) -> bool:
    return bool(robot.status().flags & StatusFlag.ARMED)


def angles(packets: list[Packet]) -> list[tuple[float, ...]]:
    return [packet.angle for packet in packets if isinstance(packet, Motor)]


def span(packets: list[Packet]) -> float:
    """Largest movement of a fin, rad."""
    spans: list[float] = [max(fin) - min(fin) for fin in zip(*angles(packets), strict=True)]
    return max(spans)


def test_boots_disarmed_without_motor_power_and_sends_hello(robot: CompiledRobot) -> None:
    robot.run(300)
    assert not armed(robot)
    assert not robot.power
    greeting = robot.last(Hello)
    assert (greeting.definitions, greeting.epoch, greeting.credit) == (DEFINITIONS_HASH, 1, 320)
    robot.greet()
    robot.run(300)
    assert "boot 1, power on" in robot.texts


def test_start_after_steady_traffic_arms_and_powers(robot: CompiledRobot) -> None:
    robot.arm()
    assert robot.power
    assert armed(robot)
    assert robot.status().flags & StatusFlag.MOTOR_POWER


def test_every_boot_has_another_epoch(robot: CompiledRobot) -> None:
    robot.run(50)
    first = robot.epoch
    robot.reset(ResetCause.EXTERNAL)
    robot.run(50)
    assert robot.epoch != first


def test_board_answers_each_hello(robot: CompiledRobot) -> None:
    robot.run(300)
    for _ in range(3):
        robot.say(hello())
        assert sum(isinstance(packet, Hello) for packet in robot.run(20)) == 1


def refused(robot: CompiledRobot, reason: str, *packets: Packet) -> None:
    """Check that these packets are refused for this reason, and that nothing arms."""
    robot.say(*packets)
    robot.run(30)
    assert robot.texts[-1] == f"START refused: {reason}"
    assert robot.lines[-1].level == DebugLevel.WARNING
    assert not robot.power
    assert not armed(robot)


def test_start_without_a_greeting_is_refused(robot: CompiledRobot) -> None:
    robot.beat(700)
    robot.say(Start(epoch=robot.epoch))
    robot.run(100)
    assert not armed(robot)
    robot.greet()
    robot.run(300)
    assert "START refused: say HELLO first" in robot.texts


def test_start_from_other_definitions_is_refused(robot: CompiledRobot) -> None:
    robot.greet()
    refused(robot, "other definitions", hello(DEFINITIONS_HASH ^ 1), Start(epoch=robot.epoch))
    assert robot.status().flags & StatusFlag.DEFINITIONS_DIFFER


def test_start_for_another_boot_is_refused(robot: CompiledRobot) -> None:
    robot.greet()
    before = robot.epoch
    robot.reset(ResetCause.EXTERNAL)
    robot.greet()
    refused(robot, "epoch of another boot", Start(epoch=before))


def test_start_after_less_than_half_a_second_of_traffic_is_refused(robot: CompiledRobot) -> None:
    robot.run(300)
    robot.say(hello())
    robot.beat(480, every=80)
    refused(robot, "no steady traffic yet", Start(epoch=robot.epoch))


@pytest.mark.parametrize(("gap", "accepted"), [(250, True), (260, False)])
def test_start_soon_after_a_gap_in_the_traffic_is_refused(
    robot: CompiledRobot, gap: int, accepted: bool
) -> None:
    robot.greet()
    robot.say(Heartbeat(time=0))
    robot.run(gap)
    robot.say(Heartbeat(time=0))
    robot.run(40)
    robot.say(Start(epoch=robot.epoch))
    robot.run(30)
    assert robot.texts[-1] == ("armed" if accepted else "START refused: no steady traffic yet")
    assert armed(robot) is accepted


def test_fins_flap_only_when_armed(robot: CompiledRobot) -> None:
    robot.greet()
    robot.swim(500, FORWARD)
    assert span(robot.received) < RESTING
    assert all(packet.drive == (0, 0, 0, 0) for packet in robot.received if isinstance(packet, Motor))


def test_a_command_from_before_the_arming_is_not_followed(robot: CompiledRobot) -> None:
    robot.greet()
    robot.say(FORWARD)
    robot.run(10)
    robot.say(Start(epoch=robot.epoch))
    robot.run(20)
    robot.received.clear()
    resting = StatusFlag.ARMED | StatusFlag.NEUTRAL
    assert robot.status().flags & resting == resting
    robot.run(200)
    assert span(robot.received) < RESTING


def test_arming_alone_moves_no_fin(robot: CompiledRobot) -> None:
    for motor, angle in zip(robot.motors, (0.9, -2.0, 3.0, 0.1), strict=True):
        motor.shaft = angle
    robot.run(50)
    robot.arm()
    robot.received.clear()
    robot.beat(1000)
    assert span(robot.received) < RESTING


def test_forward_flaps_the_front_fins(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(1000, FORWARD)
    robot.received.clear()
    robot.swim(1000, FORWARD)
    fins = [max(fin) - min(fin) for fin in zip(*angles(robot.received), strict=True)]
    assert fins[0] == pytest.approx(1.6, abs=0.15)
    assert fins[3] == pytest.approx(1.6, abs=0.15)
    assert max(fins[1], fins[2]) < RESTING


@pytest.mark.parametrize("late", [0, 7, 190, 385, 620])
def test_fins_rest_half_a_second_after_the_last_command(robot: CompiledRobot, late: int) -> None:
    """Hold for any phase of the stroke at the end of the commands; the host is still alive."""
    robot.arm()
    robot.swim(1000 + late, FORWARD)
    robot.say(FORWARD)
    robot.run(1)
    still_swimming = robot.run(240)
    assert span(still_swimming) > 0.3
    robot.say(Heartbeat(time=0))
    robot.run(259)
    robot.received.clear()
    robot.beat(600)
    assert span(robot.received) < RESTING
    assert (
        robot.status().flags & (StatusFlag.NEUTRAL | StatusFlag.ARMED)
        == StatusFlag.NEUTRAL | StatusFlag.ARMED
    )


@pytest.mark.parametrize("turned", [20, 150, 400])
def test_fins_that_are_turning_round_rest_too(robot: CompiledRobot, turned: int) -> None:
    """Half a turn takes 0.64 s; the end of commands during it delays the rest no further."""
    robot.arm()
    robot.swim(1000, navigation(z=1))
    robot.swim(turned, navigation(z=-1))
    robot.swim(200, navigation())
    robot.received.clear()
    robot.swim(500, navigation())
    assert span(robot.received) < RESTING


def test_commands_that_come_again_are_followed_again(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, FORWARD)
    robot.beat(600)
    robot.swim(500, FORWARD)
    robot.received.clear()
    robot.swim(1000, FORWARD)
    assert span(robot.received) > 1.4


def test_silence_of_a_second_disarms(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, FORWARD)
    robot.say(FORWARD)
    robot.run(1)
    robot.run(998)
    assert robot.power
    robot.run(15)
    assert not robot.power
    robot.run(20)
    assert robot.texts[-1] == "disarmed: host silent for 1 s"
    assert not robot.status().flags & StatusFlag.HOST_ALIVE


def test_invalid_frames_do_not_keep_it_armed(robot: CompiledRobot) -> None:
    robot.arm()
    for _ in range(11):
        robot.send(b"\x05\x01\x02\x03\x04\0")
        robot.run(100)
    assert not robot.power
    assert robot.status().frames_invalid == 11


def test_stop_disarms_at_once(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(1000, FORWARD)
    robot.say(Stop())
    robot.run(1)
    assert not robot.power
    assert [bridge.drive for bridge in robot.bridges] == [0] * 4
    robot.swim(500, FORWARD)
    assert not robot.power
    assert "disarmed: STOP" in robot.texts


def test_stop_is_never_refused(robot: CompiledRobot) -> None:
    robot.arm()
    robot.say(hello(DEFINITIONS_HASH ^ 1), Stop())
    robot.run(10)
    assert not robot.power
    robot.say(Stop())
    robot.say(Stop())
    robot.run(30)
    assert not armed(robot)


def test_after_a_stop_it_arms_again(robot: CompiledRobot) -> None:
    robot.arm()
    robot.say(Stop())
    robot.beat(200)
    robot.say(Start(epoch=robot.epoch))
    robot.run(30)
    assert armed(robot)


def test_host_of_other_definitions_disarms(robot: CompiledRobot) -> None:
    robot.arm()
    robot.say(hello(DEFINITIONS_HASH ^ 1))
    robot.run(30)
    assert not robot.power
    assert robot.texts[-1] == "disarmed: other definitions"


def test_another_run_of_the_host_disarms(robot: CompiledRobot) -> None:
    robot.arm()
    robot.say(hello())
    robot.run(30)
    assert robot.power
    robot.say(hello(epoch=8))
    robot.run(30)
    assert not robot.power
    assert robot.texts[-1] == "disarmed: another host"


def test_after_a_watchdog_reset_it_is_disarmed_and_reports_the_cause(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, FORWARD)
    robot.reset(ResetCause.WATCHDOG)
    robot.run(100)
    assert not robot.power
    robot.greet()
    robot.run(100)
    line = next(line for line in robot.lines if "watchdog" in line.text)
    assert line.level == DebugLevel.ERROR
    assert line.text == "boot 2, watchdog: the main loop hung"
    assert [bridge.drive for bridge in robot.bridges] == [0] * 4
    assert robot.status().reset_cause == ResetCause.WATCHDOG


def test_main_loop_feeds_the_watchdog_in_time(robot: CompiledRobot) -> None:
    for _ in range(100):
        robot.run(10)
        assert robot.firmware.board_now_us() - robot.firmware.board_fed_us() <= 10_000


steps = st.one_of(
    st.tuples(st.just("wait"), st.integers(1, 400)),
    st.tuples(st.just("stop"), st.just(0)),
    st.tuples(st.just("start"), st.integers(0, 2)),
    st.tuples(st.just("hello"), st.integers(0, 2)),
    st.tuples(st.just("navigation"), st.just(0)),
    st.tuples(st.just("beat"), st.integers(1, 10)),
)


@given(story=st.lists(steps, max_size=25))
def test_under_any_input_motor_power_implies_armed_and_a_live_host(story: list[tuple[str, int]]) -> None:
    """Motor power is never on unless the host was heard within the last second and since the last STOP."""
    with CompiledRobot(load()) as robot:
        robot.greet()
        heard, stopped = robot.now, True
        for what, number in story:
            match what:
                case "wait":
                    robot.run(number)
                case "beat":
                    robot.beat(100 * number)
                case "stop":
                    robot.say(Stop())
                case "start":
                    robot.say(Start(epoch=number))
                    stopped = False
                case "hello":
                    robot.say(hello(DEFINITIONS_HASH ^ (number == 2), epoch=7 + number % 2))
                case "navigation":
                    robot.say(FORWARD)
            if what not in ("wait", "beat"):
                robot.run(10)
            if what != "wait":
                heard = robot.now
            if what == "stop":
                stopped = True
            if robot.power:
                assert not stopped
                assert robot.now - heard <= 1010


def test_water_in_the_hull_disarms_and_forbids_arming_until_the_next_start(robot: CompiledRobot) -> None:
    robot.arm()
    robot.swim(500, navigation(x=1))
    robot.firmware.board_set_leak(True)
    robot.swim(150, navigation(x=1))
    assert robot.power
    robot.swim(100, navigation(x=1))
    assert not robot.power
    assert robot.texts[-1] == "disarmed: water in the hull"
    robot.firmware.board_set_leak(False)
    robot.beat(1000)
    assert robot.status().faults == DeviceFault.LEAK
    assert robot.texts[-1] == "water in the hull"
    robot.say(Start(epoch=robot.epoch))
    robot.run(30)
    assert robot.texts[-1] == "START refused: water in the hull"
    robot.reset(ResetCause.EXTERNAL)
    robot.arm()


def test_a_moment_of_contact_is_no_leak(robot: CompiledRobot) -> None:
    robot.arm()
    for _ in range(5):
        robot.firmware.board_set_leak(True)
        robot.swim(150, navigation(x=1))
        robot.firmware.board_set_leak(False)
        robot.swim(50, navigation(x=1))
    assert robot.power
    assert robot.status().faults == 0
