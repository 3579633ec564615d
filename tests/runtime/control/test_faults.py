"""Each limit to the millisecond, and the text, alarm and events of each fault."""

from collections.abc import Callable
from dataclasses import replace
from math import radians
from typing import Literal

import pytest

from robot_runtime.contract.documents import Mode
from robot_runtime.contract.packets import DeviceFault, StatusFlag
from robot_runtime.control.alarms import CLEAR_AFTER, Alarms, check_consequences
from robot_runtime.control.fault_detector import REPEATS
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.control.hil_feed import SILENCE
from tests.runtime.control.supervisor_rig import SupervisorRig
from tests.runtime.control.test_hil_feed import WORD

MS = 0.001


def live(rig: SupervisorRig, seconds: float, sense: Callable[[], None]) -> None:
    """Run in steps of 20 ms, with data of the board in each."""
    for _ in range(round(seconds / 0.02)):
        rig.clock.forward(0.02)
        sense()


def wrong(rig: SupervisorRig, mode: Mode = "automatic") -> set[str]:
    return set(rig.supervisor.detector.active_faults(mode, []))


def all_but(rig: SupervisorRig, missing: str) -> Callable[[], None]:
    """Send the data of a board with one silent sensor."""

    def sense() -> None:
        rig.report()
        if missing != "depth":
            rig.sense_depth()
        if missing != "imu":
            rig.sense_attitude()

    return sense


def checked(rig: SupervisorRig, sense: Callable[[], None]) -> Callable[[], None]:
    """Sense, then have the supervisor look for faults."""

    def check() -> None:
        sense()
        rig.supervisor.tick()

    return check


@pytest.fixture
def rig() -> SupervisorRig:
    rig = SupervisorRig(heartbeat=4.0)
    rig.ready()
    return rig


@pytest.mark.parametrize(
    ("name", "limit", "missing"),
    [("depth_stale", 0.4, "depth"), ("imu_stale", 0.15, "imu")],
)
def test_a_silent_sensor_is_a_fault_after_its_limit(
    rig: SupervisorRig, name: str, limit: float, missing: str
) -> None:
    sense = all_but(rig, missing)
    rig.clock.forward(limit - MS)
    sense()
    assert name not in wrong(rig)
    rig.clock.forward(2 * MS)
    sense()
    assert name in wrong(rig)
    rig.sense()
    assert wrong(rig) == set()


def test_a_silent_board_is_not_reported_as_a_silent_imu_or_a_capsized_robot(rig: SupervisorRig) -> None:
    rig.clock.forward(0.39)
    assert wrong(rig) == set()
    rig.clock.forward(0.45)
    assert wrong(rig) == {"depth_stale"}
    rig.clock.forward(0.02)
    assert wrong(rig) == {"depth_stale", "board_silent"}
    rig.clock.forward(ROBOT_FAULTS["capsized"].limit)
    assert wrong(rig) == {"depth_stale", "board_silent"}


def test_a_silent_board_says_what_the_line_waits_for(rig: SupervisorRig) -> None:
    rig.clock.forward(ROBOT_FAULTS["board_silent"].limit)
    assert rig.supervisor.detector.active_faults("automatic", [])["board_silent"] == ""
    rig.board.connected, rig.board.text = False, "/dev/ttyS0 is missing"
    detail = rig.supervisor.detector.active_faults("automatic", [])["board_silent"]
    assert detail == "There is no connection: /dev/ttyS0 is missing."


def test_a_frozen_pressure_is_one_that_repeats_often_and_long(rig: SupervisorRig) -> None:
    live(rig, 0.38, lambda: rig.sense(frozen=True))
    assert wrong(rig) == set()
    live(rig, 0.04, lambda: rig.sense(frozen=True))
    assert wrong(rig) == {"depth_frozen"}
    rig.sense()
    assert wrong(rig) == set()


@pytest.mark.parametrize("frozen", ["rate", "force"])
def test_a_frozen_imu_repeats_its_rate_or_its_force(
    rig: SupervisorRig, frozen: Literal["rate", "force"]
) -> None:
    def sense() -> None:
        rig.sense_depth()
        rig.sense_attitude(frozen=frozen)

    live(rig, 0.38, sense)
    assert wrong(rig) == set()
    live(rig, 0.04, sense)
    assert wrong(rig) == {"imu_frozen"}
    rig.sense()
    assert wrong(rig) == set()


def test_in_the_loop_the_board_repeats_what_it_was_sent() -> None:
    rig = SupervisorRig(in_the_loop=True)
    rig.ready()
    for _ in range(50):
        rig.clock.forward(0.01)
        rig.sense_depth()
        rig.sense_attitude(frozen="rate")
    assert "imu_frozen" not in wrong(rig)


def test_on_a_slow_line_a_few_equal_readings_are_not_frozen() -> None:
    rig = SupervisorRig(1200)
    rig.ready()
    for _ in range(REPEATS - 1):
        rig.clock.forward(0.5)
        rig.sense(frozen=True)
    assert wrong(rig) == set()
    rig.sense(frozen=True)
    assert wrong(rig) == {"depth_frozen"}


def test_an_uncertain_depth_forbids_to_arm(rig: SupervisorRig) -> None:
    rig.board.faults = DeviceFault.SURFACE
    rig.report()
    assert "zero the depth" in rig.supervisor.detector.refusals()[0]
    rig.board.faults = 0
    rig.report()
    assert rig.supervisor.detector.refusals() == []


@pytest.mark.parametrize("depth", [-1.01, 20.01, 32.767])
def test_an_impossible_depth_is_a_fault_and_a_single_jump_is_not(rig: SupervisorRig, depth: float) -> None:
    live(rig, 0.38, lambda: rig.sense(depth))
    assert wrong(rig) == set()
    live(rig, 0.04, lambda: rig.sense(depth))
    assert wrong(rig) == {"depth_range"}
    assert f"{depth:.1f} m" in rig.supervisor.detector.depth_refusals()[0]
    rig.sense(20.0)
    assert wrong(rig) == set()


@pytest.mark.parametrize(("tilt", "faults"), [(74.0, set()), (76.0, {"capsized"}), (180.0, {"capsized"})])
def test_a_tilt_is_a_fault_once_it_lasts(rig: SupervisorRig, tilt: float, faults: set[str]) -> None:
    live(rig, 1.88, lambda: rig.sense(tilt=radians(tilt)))
    assert wrong(rig) == set()
    live(rig, 0.04, lambda: rig.sense(tilt=radians(tilt)))
    assert wrong(rig) == faults


def test_a_camera_is_watched_from_its_first_picture_on(rig: SupervisorRig) -> None:
    detector = rig.supervisor.detector
    live(rig, 2.0, rig.sense)
    assert wrong(rig) == set()
    detector.see_picture(rig.clock.now())
    live(rig, 0.88, rig.sense)
    assert wrong(rig) == set()
    live(rig, 0.04, rig.sense)
    assert wrong(rig) == {"vision_stale"}
    assert not ROBOT_FAULTS["vision_stale"].stops("automatic")


def test_faults_that_the_board_reports_are_faults(rig: SupervisorRig) -> None:
    rig.board.flags = StatusFlag.BATTERY_LOW
    rig.board.faults = DeviceFault.ENCODER_FRONT_LEFT | DeviceFault.ENCODER_BACK_RIGHT
    rig.board.faults |= DeviceFault.LEAK
    rig.board.stack_free = 63
    rig.report()
    result = rig.supervisor.detector.active_faults("automatic", [])
    assert result == {
        "battery_low": "",
        "leak": "",
        "memory_low": "",
        "fin_failing": "(encoder of the back right fin, encoder of the front left fin)",
    }
    assert rig.supervisor.detector.active_faults("disarmed", []) == {
        "battery_low": "",
        "leak": "",
        "memory_low": "",
    }
    rig.board.stack_free = 64
    rig.board.faults &= ~DeviceFault.LEAK
    rig.report()
    assert set(rig.supervisor.detector.active_faults("disarmed", ["fin_failing"])) == {
        "battery_low",
        "fin_failing",
    }


def test_each_fin_that_fails_is_told_while_the_alarm_lasts(rig: SupervisorRig) -> None:
    detector, active = rig.supervisor.detector, ["fin_failing"]
    for faults, report in (
        (DeviceFault.ENCODER_FRONT_LEFT, "(encoder of the front left fin)"),
        (DeviceFault.BRIDGE_BACK_LEFT, "(encoder of the front left fin, H-bridge of the back left fin)"),
    ):
        rig.board.faults = faults
        rig.report()
        assert detector.active_faults("automatic", active) == {"fin_failing": report}
    assert detector.active_faults("automatic", []) == {"fin_failing": "(H-bridge of the back left fin)"}


def test_a_silent_server_is_a_fault_only_while_armed(rig: SupervisorRig) -> None:
    live(rig, 4.1, rig.sense)
    assert wrong(rig) == {"server_silent"}
    assert wrong(rig, "disarmed") == set()
    rig.supervisor.detector.see_server(watched=True)
    assert wrong(rig) == set()


def test_a_simulator_that_falls_silent_is_a_fault_also_while_disarmed() -> None:
    rig = SupervisorRig(in_the_loop=True)
    rig.ready()
    assert rig.hil is not None
    assert rig.supervisor.detector.active_faults("disarmed", []) == {}
    rig.hil.forward(WORD.to_bytes())
    live(rig, SILENCE - 0.02, rig.sense)
    assert wrong(rig, "disarmed") == set()
    live(rig, 0.04, rig.sense)
    assert wrong(rig, "disarmed") == wrong(rig) == {"simulator_silent"}
    assert ROBOT_FAULTS["simulator_silent"].stops("automatic")
    rig.hil.forward(WORD.to_bytes())
    assert wrong(rig) == set()


def test_what_follows_from_a_silent_simulator_names_it_as_its_cause() -> None:
    rig = SupervisorRig(in_the_loop=True)
    rig.board.flags |= StatusFlag.HIL
    rig.ready()
    assert rig.hil is not None
    rig.hil.forward(WORD.to_bytes())
    rig.supervisor.arm()
    live(rig, 1.0, checked(rig, rig.report))
    alarms = {alarm.fault: alarm for alarm in rig.supervisor.alarms}
    assert set(alarms) == {"simulator_silent", "depth_stale", "imu_stale"}
    assert set(alarms) - {"simulator_silent"} <= set(alarms["simulator_silent"].consequences)
    # None of them is left out of the record.
    assert set(alarms) <= {event.kind for event in rig.events}


def test_what_follows_from_a_silent_server_names_it_as_its_cause(rig: SupervisorRig) -> None:
    rig.supervisor.arm("manual")
    live(rig, 5.0, checked(rig, all_but(rig, "")))
    alarms = {alarm.fault: alarm for alarm in rig.supervisor.alarms}
    assert set(alarms) == {"server_silent", "pilot_quiet", "pilot_lost"}
    assert alarms["server_silent"].consequences == ["pilot_quiet", "pilot_lost", "unwatched"]


def test_a_consequence_is_a_fault_and_never_its_own_cause() -> None:
    capsized = ROBOT_FAULTS["capsized"]
    with pytest.raises(ValueError, match="no faults: sunk"):
        check_consequences({"capsized": replace(capsized, consequences=("sunk",))})
    rolled = {"rolled": replace(capsized, consequences=("capsized",))}
    with pytest.raises(ValueError, match="cycle"):
        check_consequences({"capsized": replace(capsized, consequences=("rolled",))}, rolled)
    check_consequences({"capsized": capsized}, rolled)


def test_every_fault_has_a_text_a_cause_and_a_remedy() -> None:
    for name, fault in ROBOT_FAULTS.items():
        assert all(text.endswith(".") for text in (fault.what, fault.cause, fault.remedy)), name


def test_a_pilot_is_lost_with_the_page_and_not_with_the_gamepad() -> None:
    # A page sends its sticks also at rest, and without a gamepad.
    for name in ("pilot_quiet", "pilot_lost"):
        fault = ROBOT_FAULTS[name]
        assert fault.what.startswith("No page")
        assert "gamepad" not in fault.cause + fault.remedy


def test_in_manual_only_depth_faults_do_not_stop_the_robot() -> None:
    rules = ROBOT_FAULTS.items()
    goes_on = {name for name, fault in rules if fault.stops("automatic") and not fault.stops("manual")}
    assert goes_on == {"depth_stale", "depth_frozen", "depth_range"}


# Alarms


@pytest.fixture
def alarms(rig: SupervisorRig) -> Alarms:
    return Alarms(rig.clock, ROBOT_FAULTS, rig.events.append, clear_after=CLEAR_AFTER)


def test_a_flickering_fault_is_one_alarm(rig: SupervisorRig, alarms: Alarms) -> None:
    began = rig.clock.now()
    for step in range(20):
        alarms.update({"fin_failing": "(front left)"} if step % 4 == 0 else {})
        rig.clock.forward(0.1)
    (alarm,) = alarms.listed()
    assert (alarm.since, alarm.active, alarm.acknowledged) == (began, True, False)
    rig.clock.forward(CLEAR_AFTER)
    alarms.update({})
    notices = [(event.kind, event.severity) for event in rig.events]
    assert notices == [("fin_failing", "caution"), ("alarm_over", "info")]
    assert not alarms.listed()[0].active


def test_another_detail_changes_the_words_of_an_alarm_and_is_no_new_one(
    rig: SupervisorRig, alarms: Alarms
) -> None:
    alarms.update({"fin_failing": "(front left)"})
    alarms.acknowledge()
    alarms.update({"fin_failing": "(front left, back left)"})
    (alarm,) = alarms.listed()
    assert (alarm.what, alarm.acknowledged) == ("A fin does not follow. (front left, back left)", True)
    assert len(rig.events) == 1


def test_an_alarm_disappears_when_over_and_acknowledged_in_either_order(
    rig: SupervisorRig, alarms: Alarms
) -> None:
    alarms.update({"capsized": ""})
    alarms.acknowledge()
    assert [alarm.acknowledged for alarm in alarms.listed()] == [True]
    rig.clock.forward(CLEAR_AFTER)
    alarms.update({})
    assert alarms.listed() == []
    alarms.begin("board_restarted", active=False)
    assert [alarm.active for alarm in alarms.listed()] == [False]
    alarms.acknowledge()
    assert alarms.listed() == []


def test_a_returning_fault_must_be_acknowledged_again(rig: SupervisorRig, alarms: Alarms) -> None:
    alarms.begin("capsized", active=False)
    rig.clock.forward(5.0)
    alarms.update({"capsized": ""})
    (alarm,) = alarms.listed()
    assert (alarm.since, alarm.active, alarm.acknowledged) == (rig.clock.now(), True, False)
    assert len(rig.events) == 2
