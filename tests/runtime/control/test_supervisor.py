"""Arming and disarming in simulated time, with a link to the board that the test plays."""

import pytest

from robot_runtime.contract.packets import (
    DeviceFault,
    Start,
    StatusFlag,
    Stop,
)
from robot_runtime.control.supervisor import Arming
from robot_runtime.errors import RefusedError
from tests.runtime.control.supervisor_rig import ObedientBoard, SupervisorRig


@pytest.fixture
def rig() -> SupervisorRig:
    rig = SupervisorRig()
    rig.ready()
    return rig


def test_arms_when_everything_is_well(rig: SupervisorRig) -> None:
    assert rig.supervisor.refusals() == []
    rig.supervisor.arm()
    assert rig.supervisor.armed
    assert rig.supervisor.mode == "automatic"
    assert rig.board.sent == [Start(epoch=7)]
    assert [event.kind for event in rig.events] == ["armed"]


def test_every_reason_against_arming_is_reported(rig: SupervisorRig) -> None:
    rig.board.faults = DeviceFault.IMU | DeviceFault.ENCODER_BACK_LEFT
    rig.board.flags, rig.board.stack_free = StatusFlag.BATTERY_LOW, 40
    rig.report()
    rig.clock.forward(0.41)
    rig.report()
    with pytest.raises(RefusedError) as refusal:
        rig.supervisor.arm()
    for word in ("IMU", "back left fin", "fresh depth", "battery is low", "40 B are free"):
        assert word in str(refusal.value)
    assert rig.board.sent == []


def test_no_arming_without_a_connection_or_a_status_of_the_board(rig: SupervisorRig) -> None:
    rig.board.connected, rig.board.text = False, "the port does not exist"
    assert "the port does not exist" in rig.supervisor.refusals()[0]
    rig.board.connected = True
    rig.clock.forward(0.6)
    assert "sends no status" in rig.supervisor.refusals()[0]


def test_a_board_that_does_not_arm_is_stopped_and_the_reason_reported(rig: SupervisorRig) -> None:
    rig.board.obeys = False
    with pytest.raises(RefusedError, match="did not arm"):
        rig.supervisor.arm()
    assert isinstance(rig.board.sent[-1], Stop)
    assert not rig.supervisor.armed


def test_a_check_while_the_board_arms_does_not_stop_it(rig: SupervisorRig) -> None:
    rig.on_start = rig.supervisor.tick
    rig.supervisor.arm()
    assert rig.supervisor.armed
    assert rig.board.sent == [Start(epoch=7)]


def test_a_stop_while_the_board_arms_prevails(rig: SupervisorRig) -> None:
    rig.on_start = lambda: rig.supervisor.stop("Stopped.")
    with pytest.raises(RefusedError, match="Stopped before"):
        rig.supervisor.arm()
    assert not rig.supervisor.armed
    assert rig.board.sent == [Start(epoch=7), Stop()]


@pytest.mark.parametrize(("baud", "limit"), [(250_000, 0.4), (1200, 1.56)])
def test_the_age_limit_of_the_depth_follows_the_baud(baud: int, limit: float) -> None:
    rig = SupervisorRig(baud)
    rig.ready()
    rig.supervisor.arm()
    rig.clock.forward(limit / 2)
    rig.supervisor.tick()
    rig.clock.forward(limit / 2 - 0.001)
    rig.supervisor.tick()
    assert rig.supervisor.armed
    rig.clock.forward(0.01)
    rig.supervisor.tick()
    assert not rig.supervisor.armed


def test_after_a_stall_earlier_data_of_the_board_is_ignored(rig: SupervisorRig) -> None:
    rig.supervisor.arm()
    rig.supervisor.tick()
    rig.clock.forward(3.0)
    rig.ready()
    rig.supervisor.tick()
    assert rig.supervisor.mode == "failsafe"
    assert [alarm.fault for alarm in rig.supervisor.alarms] == ["runtime_stalled"]
    assert rig.board.sent[-1] == Stop()


def test_a_short_stall_is_ignored(rig: SupervisorRig) -> None:
    rig.supervisor.arm()
    rig.supervisor.tick()
    rig.clock.forward(0.89)
    rig.ready()
    rig.supervisor.tick()
    assert rig.supervisor.armed


def test_stop_disarms_at_once_every_time(rig: SupervisorRig) -> None:
    rig.supervisor.arm()
    rig.supervisor.stop("Stopped.")
    rig.supervisor.stop("Stopped.")
    assert not rig.supervisor.armed
    assert [type(packet) for packet in rig.board.sent[1:]] == [Stop, Stop]
    assert [event.kind for event in rig.events] == ["armed", "disarmed"]


def test_status_from_before_a_stop_does_not_confirm_the_next_arming(rig: SupervisorRig) -> None:
    rig.ready()
    rig.supervisor.arm()
    rig.board.obeys = False
    obedient, rig.board.send = rig.board.send, ObedientBoard.send.__get__(rig.board)  # type: ignore[method-assign]
    rig.supervisor.stop("Enough.")
    arming = rig.supervisor.begin_arming()
    rig.supervisor.continue_arming()
    assert rig.supervisor.mode == "disarmed"
    assert not any(isinstance(packet, Start) for packet in rig.board.sent[-3:])
    rig.board.flags, rig.board.obeys = 0, True
    rig.board.send = obedient  # type: ignore[method-assign]
    rig.report()
    rig.supervisor.continue_arming()
    rig.supervisor.continue_arming()
    assert arming.over
    assert rig.supervisor.mode == "automatic"
    assert rig.supervisor.alarms == []


def test_stop_is_repeated_while_the_board_stays_armed(rig: SupervisorRig) -> None:
    rig.board.flags = StatusFlag.ARMED
    rig.report()
    rig.supervisor.tick()
    assert rig.board.sent == [Stop()]
    rig.supervisor.tick()
    assert rig.board.sent == [Stop()]


def test_a_lost_connection_disarms_with_an_alarm(rig: SupervisorRig) -> None:
    rig.supervisor.arm()
    rig.board.connected, rig.board.text = False, "the port went away"
    rig.supervisor.tick()
    assert not rig.supervisor.armed
    assert [(event.severity, event.kind) for event in rig.events[1:]] == [
        ("alarm", "board_silent"),
        ("alarm", "disarmed"),
    ]
    assert "the port went away" in rig.events[-2].text


def test_a_board_that_restarts_or_disarms_itself_is_a_fault(rig: SupervisorRig) -> None:
    rig.supervisor.arm()
    rig.board.epoch = 8
    rig.board.flags = 0
    rig.report()
    assert "restarted" in rig.events[-2].text
    rig.supervisor.acknowledge()
    rig.supervisor.arm()
    rig.board.flags = 0
    rig.report()
    assert "disarmed itself" in rig.events[-2].text
    assert rig.supervisor.mode == "failsafe"


@pytest.mark.parametrize(
    ("flags", "faults", "fault"),
    [(0, DeviceFault.LEAK, "leak"), (StatusFlag.BATTERY_LOW, 0, "battery_low")],
)
def test_a_board_that_says_why_it_disarmed_is_one_alarm(
    rig: SupervisorRig, flags: int, faults: int, fault: str
) -> None:
    rig.supervisor.arm()
    rig.board.flags, rig.board.faults = flags, faults
    rig.report()
    rig.supervisor.tick()
    assert [alarm.fault for alarm in rig.supervisor.alarms] == [fault]
    assert rig.supervisor.mode == "failsafe"


def test_a_failsafe_must_be_acknowledged_before_arming(rig: SupervisorRig) -> None:
    rig.supervisor.arm()
    rig.board.flags = 0
    rig.report()
    before = len(rig.board.sent)
    with pytest.raises(RefusedError, match="Acknowledge the alarms"):
        rig.supervisor.arm()
    assert not any(isinstance(packet, Start) for packet in rig.board.sent[before:])
    rig.supervisor.acknowledge()
    rig.supervisor.arm()
    assert rig.supervisor.armed


def test_a_fault_that_returns_after_acknowledgement_is_an_alarm_again(rig: SupervisorRig) -> None:
    def live(seconds: float, *, depth: bool) -> None:
        for _ in range(round(seconds / 0.05)):
            rig.clock.forward(0.05)
            rig.report()
            rig.sense_attitude()
            if depth:
                rig.sense_depth()
            rig.supervisor.tick()

    rig.supervisor.arm()
    live(1.0, depth=False)
    live(0.2, depth=True)
    rig.supervisor.acknowledge()
    rig.supervisor.arm()
    live(1.0, depth=False)
    live(2.0, depth=True)
    assert rig.supervisor.mode == "failsafe"
    assert [(alarm.fault, alarm.active, alarm.acknowledged) for alarm in rig.supervisor.alarms] == [
        ("depth_stale", False, False)
    ]


def test_arming_proceeds_step_by_step_without_blocking(rig: SupervisorRig) -> None:
    rig.board.obeys = False
    arming = rig.supervisor.begin_arming()
    rig.supervisor.continue_arming()
    assert not arming.over
    assert rig.supervisor.begin_arming() is arming
    assert rig.board.sent == [Start(epoch=7)] * 2
    rig.board.obeys = True
    rig.supervisor.continue_arming()
    rig.supervisor.continue_arming()
    assert (arming.over, arming.refusal) == (True, "")
    assert rig.supervisor.armed
    assert rig.supervisor.begin_arming().over
    rig.supervisor.continue_arming()
    assert len(rig.board.sent) == 3


def test_what_begins_with_an_arming_begins_with_its_own_alone(rig: SupervisorRig) -> None:
    begun: list[str] = []

    def begin() -> Arming:
        return rig.supervisor.begin_arming(on_armed=lambda: begun.append(rig.supervisor.mode))

    rig.board.obeys = False
    rig.supervisor.begin_arming()
    with pytest.raises(RefusedError, match="is already being armed for automatic"):
        begin()
    rig.supervisor.stop("Stopped.")
    begin()
    rig.supervisor.stop("Stopped.")
    assert begun == []
    rig.board.obeys = True
    rig.supervisor.finish_arming(begin())
    assert begun == ["disarmed"]
    with pytest.raises(RefusedError, match="The robot is armed, in automatic"):
        begin()
    assert rig.supervisor.mode == "automatic"


def test_a_board_that_never_arms_ends_the_attempt(rig: SupervisorRig) -> None:
    rig.board.obeys = False
    arming = rig.supervisor.begin_arming()
    while not arming.over:
        rig.supervisor.continue_arming()
    assert "did not arm" in arming.refusal
    assert isinstance(rig.board.sent[-1], Stop)
    rig.supervisor.tick()
    assert not rig.supervisor.armed
