"""The model-based depth controller: its model, its parts, and what it reaches in the simulated water."""

from math import pi

import pytest

from bench.control import BEST, THESIS, crossing_ratio, perform, variants
from robot_runtime.control.controllers import Predictive
from robot_runtime.control.controllers.heave import DOWN, TURNING_ROUND, Heave, Motion

SECONDS = 0.1


def heave(**more: float) -> Heave:
    return Heave(0.25, 6.0, **more)


def test_full_command_brings_the_terminal_speed_of_the_models_quadratic() -> None:
    there = heave().advance(Motion(0.0, 0.0, DOWN, 1.6), 1.0, 20.0, 0.02)
    assert there.speed == pytest.approx((-0.25 + (0.25**2 + 4 * 6.0 * 0.25) ** 0.5) / (2 * 6.0), rel=1e-3)


def test_turning_the_fins_round_pushes_to_the_new_side_and_takes_its_time() -> None:
    there = heave().advance(Motion(0.0, 0.0, DOWN), -0.01, TURNING_ROUND, 0.01)
    assert there.direction == pytest.approx(-DOWN)
    assert -0.12 < there.speed < -0.05
    assert pi / TURNING_ROUND == pytest.approx(80 / 1024 * 2 * pi / 0.1)


@pytest.mark.parametrize("push", [-0.25, -0.1, -0.01, 0.01, 0.1, 0.25])
def test_the_command_for_a_push_brings_it(push: float) -> None:
    model = heave()
    command = model.command(push)
    motion = Motion(0.0, 0.0, DOWN if push > 0 else -DOWN, 1.6 * abs(command))
    model.advance(motion, command, 0.01, 0.01)
    assert model.pushed == pytest.approx(push, rel=1e-6)


def test_a_coasting_hull_goes_less_far_against_its_drift() -> None:
    ways = [heave(drift=drift).coast(0.15) for drift in (-0.02, -0.01, 0.0)]
    assert 0.1 < ways[0] < ways[1] < ways[2]
    assert heave().coast(-0.1) == 0.0


def test_what_is_unexplained_is_drift_while_the_fins_rest_and_strength_while_they_push() -> None:
    resting, pushing = heave(), heave()
    resting.learn(-0.005, 70.0)
    pushing.pushed = 0.25
    pushing.learn(-0.05, 70.0)
    assert (resting.drift, resting.strength) == (-0.005, 1.0)
    assert pushing.strength == pytest.approx(0.8, abs=0.01)
    assert abs(pushing.drift) < 0.001


@pytest.mark.parametrize(("drift", "within"), [(-0.012, 0.01), (0.0, 0.08), (0.012, 0.01)])
def test_it_rests_at_the_set_point_in_the_water_of_its_model(drift: float, within: float) -> None:
    """Also a hull that sinks by itself, whose home is the other side; neutral it rests less near."""
    water, controller = heave(drift=drift), Predictive()
    motion, depths, turns = Motion(0.2, 0.0), [], 0
    for _ in range(600):
        command = controller.step(0.6, motion.depth - motion.speed * SECONDS / 2, SECONDS)
        before = motion.direction
        motion = water.advance(motion, command, SECONDS, 0.01)
        depths.append(motion.depth)
        turns += len(depths) > 300 and abs(motion.direction - before) > 0.1
    assert depths[-200:] == pytest.approx([0.6] * 200, abs=within)
    assert turns == 0


def test_after_a_pause_it_begins_anew() -> None:
    used, fresh = Predictive(), Predictive()
    for _ in range(50):
        used.step(1.0, 0.2, SECONDS)
    used.start()
    assert used.step(1.0, 0.4, SECONDS) == fresh.step(1.0, 0.4, SECONDS)


@pytest.mark.parametrize("craft", ["nominal", "thrust -30 %", "mass -30 %"])
def test_in_the_simulated_water_it_rests_where_the_thesiss_controller_swings(craft: str) -> None:
    """The worst two of docs/control.md's table, and the nominal one."""
    robot = variants()[craft]
    found = perform(BEST, robot, sine=False)
    assert found.steady <= 0.02
    assert found.overshoot <= 0.12
    if craft == "nominal":
        thesis = perform(THESIS, robot, sine=False)
        assert thesis.steady > 0.14
        assert crossing_ratio(found, thesis) <= 1.2
