"""Each fault on the whole robot with the compiled firmware: time to the alarm, and the action."""

from collections.abc import Callable, Iterator
from math import acos, pi

import pytest

from robot_runtime.contract.packets import Motor, StatusFlag
from robot_runtime.contract.topics import LINK, MOTOR
from robot_runtime.control.fault_detector import TILT_MAX
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.control.pilot import PATIENCE
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.boards.stepped_board import PERIOD
from tests.runtime.control.flight import Flight

LATE = 0.03
"""s: up to one step of the test, and what the board takes to say it."""
Break = Callable[[Flight], None]


@pytest.fixture
def flight() -> Iterator[Flight]:
    with Flight() as flight:
        yield flight


def absent(device: str) -> Break:
    return lambda flight: flight.break_(device, "bus")


ROWS: list[tuple[str, Break]] = [
    ("depth_stale", absent("pressure")),
    ("depth_frozen", lambda flight: flight.break_("pressure", "stuck")),
    ("depth_range", lambda flight: flight.break_("pressure", "spike", share=1.0, size=300_000.0)),
    ("imu_stale", absent("gyroscope")),
    ("imu_frozen", lambda flight: flight.break_("accelerometer", "stuck")),
    ("board_silent", lambda flight: flight.cut(on=True)),
    ("server_silent", lambda flight: setattr(flight, "server", False)),
    ("control_failed", lambda flight: setattr(flight.robot.control.depth.controller, "step", None)),
]


@pytest.mark.parametrize(("name", "break_"), ROWS, ids=[name for name, _ in ROWS])
def test_a_fault_is_detected_in_time_and_stops_the_robot(flight: Flight, name: str, break_: Break) -> None:
    check_all_stop(flight, name, break_)


@pytest.mark.parametrize(("name", "break_"), ROWS, ids=[name for name, _ in ROWS])
def test_a_fault_is_detected_in_time_in_step_with_control(name: str, break_: Break) -> None:
    with Flight(in_step=True) as flight:
        check_all_stop(flight, name, break_)


def check_all_stop(flight: Flight, name: str, break_: Break) -> None:
    """The armed robot is stopped in time after the fault, and demands an acknowledgement."""
    flight.arm()
    flight.supervisor.detector.server_patience = 4.0
    flight.run(3.0)
    assert flight.supervisor.mode == "automatic"
    break_(flight)
    took = flight.until(lambda: flight.supervisor.mode == "failsafe", ROBOT_FAULTS[name].limit + LATE)
    assert took > 0.05 or name == "control_failed"
    flight.run(1.0)
    assert any(alarm.fault == name for alarm in flight.supervisor.alarms)
    message = [event.text for event in flight.events if event.kind == name]
    assert any(text.startswith(ROBOT_FAULTS[name].what) for text in message)
    assert not any(time > flight.now - 0.9 for time, _ in flight.sent)
    with pytest.raises(RefusedError, match="Acknowledge the alarms"):
        flight.supervisor.begin_arming()
    assert not flight.supervisor.board_armed or not flight.robot.line.connected


def test_no_alarm_without_a_fault(flight: Flight) -> None:
    flight.arm()
    flight.run(12.0)
    assert flight.supervisor.alarms == []
    assert flight.supervisor.mode == "automatic"


def test_a_capsized_robot_is_stopped(flight: Flight) -> None:
    flight.arm()
    flight.run(2.0)
    flight.water("trim", buoyancy=1.003, forward=0.0, right=0.0, above=-0.03)
    flight.until(lambda: tilt(flight) > TILT_MAX, 30.0)
    took = flight.until(lambda: flight.supervisor.mode == "failsafe", ROBOT_FAULTS["capsized"].limit + LATE)
    assert took > 1.8
    assert flight.alarm("capsized")
    flight.run(0.5)
    flight.supervisor.acknowledge()
    with pytest.raises(RefusedError, match="on its side or on its back"):
        flight.supervisor.begin_arming()


def tilt(flight: Flight) -> float:
    """rad, of the simulated hull."""
    _, x, y, _ = flight.stage.simulator.truth().attitude
    return acos(max(1 - 2 * (x * x + y * y), -1.0))


def test_a_low_battery_turns_the_fins_down_and_is_an_alarm() -> None:
    with Flight(more="[robot]\nbattery_full = 6.0") as flight:
        motors: list[Motor] = []
        flight.robot.bus.on_row(MOTOR, lambda _, record: motors.append(Motor.from_bytes(record)))
        flight.sticks = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
        flight.arm("manual")
        flight.until(lambda: flight.supervisor.mode == "failsafe", 25.0)
        # It is full enough until time 0.
        assert 20.0 <= flight.now <= ROBOT_FAULTS["battery_low"].limit
        assert flight.alarm("battery_low")
        flight.run(2.0)
        assert motors[-1].angle == pytest.approx([pi / 2] * 4, abs=0.1)
        status = flight.supervisor.detector.status
        assert status is not None
        assert not status.flags & (StatusFlag.ARMED | StatusFlag.MOTOR_POWER)
        flight.supervisor.acknowledge()
        with pytest.raises(RefusedError, match="battery is low"):
            flight.supervisor.begin_arming()


def test_a_fin_that_fails_is_an_alarm_and_forbids_the_next_arming(flight: Flight) -> None:
    flight.arm()
    flight.run(2.0)
    flight.break_("encoder2", "bus")
    flight.until(lambda: flight.alarm("fin_failing"), ROBOT_FAULTS["fin_failing"].limit + LATE)
    assert "(encoder of the back left fin)" in flight.supervisor.alarms[0].what
    failure = flight.robot.link.fault
    assert failure is not None
    assert failure.text == "the board reports a fault"
    flight.run(2.0)
    assert flight.robot.link.fault is failure
    assert flight.supervisor.mode == "automatic"
    flight.break_("encoder2", "none")
    flight.until(lambda: not flight.alarm("fin_failing"), 1.5)
    assert [alarm.active for alarm in flight.supervisor.alarms] == [False]
    flight.supervisor.acknowledge()
    assert flight.supervisor.alarms == []
    assert flight.supervisor.mode == "automatic"


def test_a_board_that_restarts_stops_the_robot(flight: Flight) -> None:
    flight.arm()
    flight.run(2.0)
    flight.board.reset()
    flight.until(lambda: flight.supervisor.mode == "failsafe", 1.0)
    flight.run(2.0)
    assert any("restarted" in alarm.what for alarm in flight.supervisor.alarms)
    assert not flight.supervisor.board_armed


def test_a_restored_link_is_reported_with_its_counters_at_once(flight: Flight) -> None:
    reported: list[float] = []
    flight.robot.bus.on_row(LINK, lambda time, _: reported.append(time))
    # Without a reason there is one report a second, which may come soon by chance.
    for pause in (1.0, 1.3, 1.6):
        flight.cut(on=True)
        flight.until(lambda: not flight.robot.line.connected, 2.0)
        flight.run(pause)
        flight.cut(on=False)
        flight.until(lambda: flight.robot.line.connected, 2.0)
        back = flight.now
        flight.run(0.2)
        assert reported[-1] > back - 0.05


def test_a_robot_held_down_after_a_stop_is_an_alarm_and_one_that_rises_is_not(flight: Flight) -> None:
    flight.arm()
    flight.run(5.0)
    flight.supervisor.stop("Stopped.")
    flight.run(21.0)
    assert flight.supervisor.alarms == []
    flight.arm()
    flight.run(5.0)
    flight.water("trim", buoyancy=0.99, forward=0.0, right=0.0, above=0.01)
    flight.supervisor.stop("Stopped.")
    took = flight.until(lambda: flight.alarm("not_rising"), 20.0)
    assert took > 15.0
    assert flight.supervisor.mode == "disarmed"
    assert flight.supervisor.refusals() == []


# Steering by hand


def test_pilot_input_moves_the_fins_and_its_silence_ends_the_mode(flight: Flight) -> None:
    flight.sticks = [1.0, 0.0, 0.0, 0.0, 0.0, 0.5]
    flight.arm("manual")
    flight.run(2.0)
    assert {command.x for _, command in flight.sent[-10:]} == {1.0}
    assert flight.stage.simulator.truth().position[0] > 0.05
    taken, flight.sticks = flight.supervisor.pilot.taken, None
    flight.until(lambda: flight.sent[-1][1].x == 0.0, PATIENCE + LATE)
    assert PATIENCE <= flight.sent[-1][0] - taken <= PATIENCE + 2 * PERIOD
    flight.until(lambda: flight.alarm("pilot_quiet"), ROBOT_FAULTS["pilot_quiet"].limit + LATE)
    assert flight.supervisor.mode == "manual"
    flight.until(lambda: flight.supervisor.mode == "failsafe", ROBOT_FAULTS["pilot_lost"].limit + LATE)
    assert 2.8 < flight.now - taken <= 3.0 + LATE
    flight.sticks = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    flight.run(1.0)
    assert flight.supervisor.mode == "failsafe"
    flight.supervisor.acknowledge()
    flight.arm("manual")
    flight.run(0.5)
    assert flight.sent[-1][1].x == 1.0


def test_pilot_input_is_sent_at_once(flight: Flight) -> None:
    flight.sticks = [0.0] * 6
    flight.arm("manual")
    # The next tick of the control loop is in 70 ms.
    flight.run(0.43)
    flight.push([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], sequence=1_000)
    assert (flight.sent[-1][0], flight.sent[-1][1].z) == (flight.now, 1.0)


def test_pilot_input_that_cannot_be_sent_stops_the_robot(
    flight: Flight, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: object) -> None:
        raise RuntimeError("out of order")

    flight.sticks = [0.0] * 6
    flight.arm("manual")
    flight.run(0.43)
    monkeypatch.setattr(flight.robot.control, "_send", fail)
    flight.push([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], sequence=1_000)
    assert [alarm.fault for alarm in flight.supervisor.alarms] == ["control_failed"]
    assert flight.supervisor.mode == "failsafe"


def test_an_exception_in_the_fault_detector_stops_the_robot(
    flight: Flight, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("out of order")

    flight.arm()
    flight.run(0.5)
    monkeypatch.setattr(flight.supervisor.detector, "active_faults", fail)
    flight.until(lambda: flight.supervisor.mode == "failsafe", ROBOT_FAULTS["control_failed"].limit + LATE)
    assert [alarm.fault for alarm in flight.supervisor.alarms] == ["control_failed"]


def test_in_manual_a_lost_depth_is_only_an_alarm_and_blocks_automatic(flight: Flight) -> None:
    flight.sticks = [0.0] * 6
    flight.arm("manual")
    flight.break_("pressure", "bus")
    flight.until(lambda: flight.alarm("depth_stale"), ROBOT_FAULTS["depth_stale"].limit + LATE)
    flight.run(5.0)
    assert flight.supervisor.mode == "manual"
    with pytest.raises(RefusedError, match="pressure sensor does not answer"):
        flight.command("mode", mode="automatic")
    flight.break_("pressure", "none")
    flight.run(1.0)
    flight.command("mode", mode="automatic")
    assert flight.supervisor.mode == "automatic"
    flight.command("mode", mode="manual")
    flight.run(0.2)
    assert flight.sent[-1][1].z == 0.0


def test_a_mission_continues_without_the_server_for_its_permitted_time(flight: Flight) -> None:
    flight.supervisor._heartbeat = 4.0
    flight.arm(alone=10.0)
    flight.server = False
    took = flight.until(lambda: flight.supervisor.mode == "failsafe", 10.2)
    assert took > 9.9
    flight.server = True
    flight.run(2.0)
    flight.supervisor.acknowledge()
    flight.arm()
    flight.server = False
    assert flight.until(lambda: flight.supervisor.mode == "failsafe", 5.0) > 3.9


# The fin check


@pytest.mark.parametrize(("broken", "failed"), [(None, []), ("encoder1", ["back right"])])
def test_the_fin_check_finds_the_fin_that_does_not_follow(
    flight: Flight, broken: str | None, failed: list[str]
) -> None:
    flight.arm("test")
    if broken is not None:
        flight.break_(broken, "stuck")
    took = flight.until(lambda: flight.supervisor.mode == "disarmed", 10.0)
    assert took > 5.0
    assert list(flight.supervisor.fin_check.failed()) == failed
    flight.run(0.5)
    assert not flight.supervisor.board_armed
    text = next(event for event in flight.events if event.kind == "fin_check")
    assert text.severity == ("caution" if failed else "info")
    assert [alarm.fault for alarm in flight.supervisor.alarms] == ["fin_failing"] * bool(failed)
