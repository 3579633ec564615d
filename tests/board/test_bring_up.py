"""The bring-up on the emulated chip: of a fresh board, and of one with each mistake, which it names."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from math import radians
from pathlib import Path

import pytest

from robot_runtime.contract.calibration import EMULATED
from robot_runtime.contract.packets import DEFINITIONS_HASH, FIN_COUNT, Hello, Jog, RequestScan, Start
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.bring_up.guide import STEPS
from robot_runtime.simulation.boards.workbench import ALONG
from server.features.bring_up.report import write_report
from tests.board.bring_up import HOLD, NAMED, Person
from tests.board.host import TICK, EmulatedRobot, start
from tests.board.rig import ROOT, build

Begin = Callable[..., Person]


@pytest.fixture(scope="module", autouse=True)
def _sketch(built: None) -> None:  # noqa: ARG001 - the board comes first
    build(ROOT / "firmware", "bring_up")


@pytest.fixture
def begin(tmp_path: Path) -> Iterator[Begin]:
    begun: list[Person] = []

    def start(*mistakes: str) -> Person:
        begun.append(Person(tmp_path, *mistakes))
        return begun[-1]

    yield start
    for person in begun:
        person.close()


def test_a_fresh_board_is_brought_up_and_calibrated(begin: Begin) -> None:
    person = begin()
    person.everything()
    assert {step.name: person.work.state(step.name) for step in STEPS} == {
        step.name: "done" for step in STEPS
    }, [person.work.results(step.name) for step in STEPS]
    result = person.work.calibration()
    assert result.missing == []
    # The emulated board's own calibration, which its firmware begins with, is what a person finds.
    assert result.fin_zeros == pytest.approx(EMULATED.fin_zeros, abs=1)
    assert result.encoders_reversed == EMULATED.encoders_reversed
    assert result.motors_reversed == EMULATED.motors_reversed
    assert result.axes == EMULATED.axes
    assert result.gyro_bias == pytest.approx((0, 0, 0), abs=0.001)
    assert result.pressure_offset == pytest.approx(0, abs=20)
    assert result.battery_factor == pytest.approx(1, abs=0.005)
    assert result.beacons_inverted == EMULATED.beacons_inverted


@pytest.mark.parametrize(("mistake", "step", "message"), NAMED)
def test_each_mistake_is_found_and_named(begin: Begin, mistake: str, step: str, message: str) -> None:
    person = begin(mistake)
    person.do(step)
    assert person.work.state(step) == "wrong", person.work.results(step)
    assert message in person.advice(step)


def test_what_can_be_calibrated_away_is(begin: Begin) -> None:
    """Lead and a magnet the other way round, a chip that lies askew, and parts that are off."""
    person = begin(
        "leads-reversed:front-right",
        "encoder-reversed:back-left",
        "imu-turned:-y+x+z",
        "gyro-offset:-3,12,20",
        "beacons-inverted",
        "regulator-off:5",
        "stiction:18",
    )
    person.everything()
    assert {step.name: person.work.state(step.name) for step in STEPS} == {
        step.name: "done" for step in STEPS
    }, [person.work.results(step.name) for step in STEPS]
    result = person.work.calibration()
    assert result.motors_reversed == (False, True, False, True)
    assert result.encoders_reversed == (True, True, True, False)
    assert result.beacons_inverted
    assert result.battery_factor == pytest.approx(1.05, abs=0.006)
    # The chip's x lies along -y of the body, its y along x: forward is y, right is -x.
    assert result.axes == ("y", "-x", "z")
    assert result.gyro_bias == pytest.approx((radians(12), radians(3), radians(20)), abs=0.002)


@pytest.mark.parametrize("axes", ["+x-y-z", "+z+x+y", "-y-x-z"])
def test_an_imu_that_lies_otherwise_gets_its_axes(begin: Begin, axes: str) -> None:
    person = begin(f"imu-turned:{axes}")
    person.do("axes")
    assert person.work.state("axes") == "done"
    forward, right, down = person.work.calibration().axes
    where = {"xyz"[number]: axes[2 * number : 2 * number + 2] for number in range(3)}
    for axis, body in ((forward, "x"), (right, "y"), (down, "z")):
        assert where[axis[-1]] == ("-" if axis.startswith("-") else "+") + body


def test_a_skipped_step_says_so_until_it_is_done(begin: Begin) -> None:
    person = begin()
    person.press("devices", "skip")
    assert person.work.state("devices") == "skipped"
    assert "Skipped: Devices on the bus." in write_report("turtle", datetime.now(UTC), person.work)
    person.do("devices")
    assert person.work.state("devices") == "done"
    with pytest.raises(RefusedError, match="no step 'tail'"):
        person.press("tail", "skip")


def test_a_motor_stops_when_nobody_holds_it(begin: Begin) -> None:
    person = begin()
    person.press("motor_1", "turn")
    person.bench.host.run(0.2)
    turning = person.rig.board.fins()
    assert abs(turning.speeds[1]) > 1
    person.bench.host.run(0.4)
    assert person.rig.board.fins().speeds == pytest.approx((0, 0, 0, 0), abs=0.05)


def test_a_motor_is_never_driven_hard_and_the_sketch_never_arms(begin: Begin) -> None:
    person = begin()
    for _ in range(5):
        person.bench.host.say(Jog(fin=0, drive=127))
        person.bench.host.run(0.1)
    low = abs(person.rig.board.fins().speeds[0])
    assert 0 < low < 6
    hello = person.bench.host.session.board
    assert hello
    person.bench.host.say(Start(epoch=hello.epoch))
    person.bench.host.run(1.0)
    assert person.rig.board.fins().speeds == pytest.approx((0, 0, 0, 0), abs=0.05)


def test_a_host_of_other_definitions_gets_no_motor_power(tmp_path: Path) -> None:
    with start("bring_up", tmp_path, "--uncalibrated") as rig:
        robot = EmulatedRobot(rig)
        robot.listen(0.5)
        robot.send(Hello(definitions=DEFINITIONS_HASH ^ 1, epoch=77, credit=4096))
        robot.listen(0.1)
        robot.send(RequestScan())
        powered = []
        for _ in range(50):
            robot.listen(TICK)
            powered.append(rig.board.fins().powered)
        assert not any(powered)


@pytest.mark.parametrize(
    ("step", "action", "given", "message"),
    [
        ("devices", "dance", {}, "no step 'devices' with the action 'dance'"),
        ("battery", "compare", {}, "Multimeter must be between 4 and 9 V"),
        ("battery", "compare", {"volts": 12}, "Multimeter must be between 4 and 9 V"),
        ("battery", "compare", {"volts": "7"}, "Multimeter must be between 4 and 9 V"),
        ("fin_0", "down", {}, "First turn the fin along its mount"),
        ("motor_0", "seen", {"fin": "front right"}, "First hold the button"),
        ("motor_0", "seen", {"fin": "tail"}, "Fin must be one of"),
        ("gyro", "rest", {}, "First measure how the IMU lies"),
        ("pressure", "bucket", {"depth": 30}, "First measure the pressure in air"),
        ("beacons", "right", {}, "First cover both detectors"),
    ],
)
def test_what_cannot_be_done_is_refused_in_words(
    begin: Begin, step: str, action: str, given: dict[str, float | str], message: str
) -> None:
    with pytest.raises(RefusedError, match=message):
        begin().work.perform(step, action, given)


def test_a_leak_sensor_is_done_only_when_it_was_wet_and_dry(begin: Begin) -> None:
    person = begin()
    person.press("leak", "dry")
    assert person.work.state("leak") == "open"
    # Its ends are still dry, or nothing is connected.
    person.press("leak", "wet")
    assert person.work.state("leak") == "wrong"
    assert "Is one wire at D2" in person.advice("leak")
    person.rig.board.fault("leak", "wet")
    person.press("leak", "dry")
    assert "Dry the ends well" in person.advice("leak")
    person.wet()
    assert person.work.state("leak") == "done"


def test_a_held_motor_stays_stopped_after_stop_until_its_button_is_pressed_anew(begin: Begin) -> None:
    person = begin()
    person.press("motor_1", "turn")
    person.bench.host.run(0.2)
    assert abs(person.rig.board.fins().speeds[1]) > 1
    person.work.stop()
    for _ in range(3):
        with pytest.raises(RefusedError, match="Release the button"):
            person.press("motor_1", "turn", on=1)
        person.bench.host.run(HOLD)
    assert person.rig.board.fins().speeds == pytest.approx((0, 0, 0, 0), abs=0.05)
    # Its release is no press.
    person.press("motor_1", "turn", stop=1)
    with pytest.raises(RefusedError, match="Release the button"):
        person.press("motor_1", "turn", on=1)
    person.press("motor_1", "turn")
    person.press("motor_1", "turn", on=1)
    person.bench.host.run(0.2)
    assert abs(person.rig.board.fins().speeds[1]) > 1


def test_what_is_wrong_when_it_is_repeated_is_no_longer_done(begin: Begin) -> None:
    person = begin()
    for fin in range(FIN_COUNT):
        person.do(f"fin_{fin}")
    person.do("beacons")
    assert {"fins", "beacons"} <= set(person.work.calibration().done)
    # Nobody has turned it.
    person.rig.board.turn(1, ALONG)
    person.press("fin_1", "down")
    # Nobody holds a lamp.
    person.press("beacons", "left")
    assert (person.work.state("fin_1"), person.work.state("beacons")) == ("wrong", "wrong")
    assert not {"fins", "beacons"} & set(person.work.calibration().done)
    person.do("fin_1")
    person.change(lamp="left")
    person.press("beacons", "left")
    assert (person.work.state("fin_1"), person.work.state("beacons")) == ("done", "done")
    assert {"fins", "beacons"} <= set(person.work.calibration().done)
