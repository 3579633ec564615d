"""The greatest depth: no set point of anything lies below it, and a robot that does is stopped."""

from collections.abc import Iterator

import pytest

from robot_runtime.contract.documents import Detection, Mode
from robot_runtime.contract.topics import DETECTION
from robot_runtime.control.fault_detector import TOO_DEEP
from robot_runtime.control.loop import ControlLoop, LoopOverride
from robot_runtime.errors import RefusedError
from tests.runtime.control.flight import Flight

POOL = "set_point_detected = 0.65\ndeepest = 0.7"
"""Lines of a flight's `[control]`, whose set point is 0.6 m."""


@pytest.fixture(scope="module")
def pool() -> Iterator[Flight]:
    """A flight in a shallow pool, which the tests leave disarmed."""
    with Flight(more=POOL) as flight:
        yield flight


@pytest.mark.parametrize(
    ("name", "question"),
    [
        ("set_points", {"default": 0.8}),
        ("set_points", {"detected": 0.8}),
        ("loop", {"name": "depth", "set_point": 0.8}),
        ("parameters", {"values": {"control.set_point": 0.8}}),
    ],
)
def test_a_command_for_a_deeper_set_point_is_refused(
    pool: Flight, name: str, question: dict[str, object]
) -> None:
    with pytest.raises(RefusedError, match=r"0\.8.*0\.7"):
        pool._commands[name](question)
    assert (pool.robot.control.set_point_default, pool.robot.control.set_point_detected) == (0.6, 0.65)


def test_a_vision_action_that_is_deeper_is_refused(pool: Flight) -> None:
    table = pool.robot.vision.settings.table()
    with pytest.raises(RefusedError, match=r"0\.8 is not between 0 and 0\.7 m"):
        pool.command("vision_settings", **table | {"actions": {"green": 0.8}})
    assert pool.robot.vision.settings.actions == {}


def test_an_experiment_beyond_it_is_refused(pool: Flight) -> None:
    pool.arm()
    limits = {"number": 1, "loop": "depth", "low": 0.0, "high": 2.0, "duration": 10}
    with pytest.raises(RefusedError, match=r"0\.9 is not between"):
        pool.command("step_experiment", **limits, start=0.3, target=0.9, tolerance=0.1, settle=5)
    with pytest.raises(RefusedError, match=r"0\.9 is not between"):
        pool.command("relay_experiment", **limits, set_point=0.9, amplitude=0.5, hysteresis=0.1, cycles=3)
    pool.supervisor.stop("Done.")


def test_a_mission_goes_no_deeper(pool: Flight) -> None:
    assert pool.robot.missions.limits.depth == 0.7


def test_the_state_has_it(pool: Flight) -> None:
    assert pool.robot.state().deepest == 0.7


def test_no_override_takes_a_loop_below_it() -> None:
    loop = ControlLoop("depth", "z")
    loop.override = LoopOverride(set_point=99.0)
    assert loop.set_point_in_force == 10.0


def test_a_configured_set_point_below_it_forbids_arming_and_is_not_held() -> None:
    with Flight(more=POOL.replace("0.7", "0.63")) as flight:
        (reason,) = flight.supervisor.refusals()
        assert reason == (
            "The set point while the colour is seen is 0.65 m, and the greatest depth 0.63 m "
            "([control] deepest). Choose one that is less deep."
        )
        # The other one may be changed all the same, and the wrong one mended.
        flight.command("set_points", default=0.2)
        flight.command("set_points", detected=0.3)
        assert flight.supervisor.refusals() == []


def test_what_the_camera_sees_takes_the_robot_no_deeper(pool: Flight) -> None:
    pool.arm()
    seen = Detection(
        time=pool.now,
        taken=pool.now,
        colour="green",
        box=None,
        area=0.1,
        processing=0.0,
        target="green",
        set_point=5.0,
    )
    pool.robot.bus.publish_document(DETECTION, seen)
    pool.run(0.2)
    assert pool.robot.control.depth.set_point == 0.7
    text = "Set point 0.70 m: green is seen; it is the greatest depth."
    assert text in [event.text for event in pool.events]
    pool.supervisor.stop("Done.")


@pytest.mark.parametrize("mode", ["automatic", "manual"])
def test_deeper_than_it_the_robot_is_stopped_in_every_mode(mode: Mode) -> None:
    with Flight(more=POOL) as flight:
        flight.sticks = [0.0] * 6 if mode == "manual" else None
        flight.arm(mode)
        flight.run(3.0)
        assert flight.supervisor.armed
        flight.break_("pressure", "drift", speed=20_000.0)
        flight.until(lambda: not flight.supervisor.armed, 5.0)
        depth = flight.supervisor.detector._depth
        assert flight.supervisor.mode == "failsafe"
        assert flight.alarm("too_deep")
        assert not flight.alarm("depth_range")
        # At two metres a second, within its half second.
        assert 0.7 + TOO_DEEP < depth < 0.7 + TOO_DEEP + 2.1 * 0.5


def test_a_robot_that_is_too_deep_is_not_armed() -> None:
    with Flight(more=POOL) as flight:
        flight.break_("pressure", "drift", speed=20_000.0)
        flight.run(2.0)
        assert any("deeper than [control] deepest" in reason for reason in flight.supervisor.refusals())
