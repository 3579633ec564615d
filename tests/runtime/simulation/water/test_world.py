"""The surface and the floor."""

from math import pi

import pytest

from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.world import World
from tests.runtime.simulation.water.harness import STILL, Flapping, drift, finned, pushed

PARAMETERS = SimulationParameters()
TOP = PARAMETERS.height / 2


def test_starts_floating_at_rest() -> None:
    body = finned(PARAMETERS, World(PARAMETERS).floating_depth(PARAMETERS.buoyancy))
    start = body.state
    state = drift(body, 10, 0.005)
    assert state.position == pytest.approx(start.position, abs=1e-9)
    assert TOP - 0.001 < state.position[2] < TOP


def test_rises_from_below_and_comes_to_rest_at_the_surface() -> None:
    body = pushed(PARAMETERS, depth=0.5)
    depths = []
    for _ in range(8000):
        body.step(0.005, STILL, STILL)
        depths.append(body.state.position[2])
    assert min(depths) > TOP - 0.02
    assert depths[-1] == pytest.approx(World(PARAMETERS).floating_depth(PARAMETERS.buoyancy), abs=1e-3)


def test_does_not_fly_out_however_hard_it_swims_upwards() -> None:
    body = finned(PARAMETERS, depth=1.0)
    down = pi / 2
    highest = 1.0
    flapping = Flapping((down, down, down, down))
    for second in range(20):
        highest = min(highest, flapping.swim(body, 1.0, start=second).position[2])
    assert TOP - 0.05 < highest < TOP


def test_falls_back_when_it_is_held_above_the_water() -> None:
    body = pushed(PARAMETERS, depth=-1.0)
    body.step(0.001, STILL, STILL)
    # The model keeps the added mass in air, so that it falls slower than a stone.
    expected = 9.81 * PARAMETERS.mass / PARAMETERS.total_mass[2] * 0.001
    assert body.state.velocity[2] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("depth", "share"), [(-1, 0), (-0.05, 0), (0, 0.5), (0.025, 0.75), (0.05, 1), (2, 1)]
)
def test_share_under_water(depth: float, share: float) -> None:
    assert World(PARAMETERS).submerged(depth) == pytest.approx(share)


def test_waves_take_speed_only_where_the_hull_breaks_the_surface() -> None:
    world = World(PARAMETERS)
    assert world.wave_drag(0.04, 0.1) == pytest.approx(-4.0)
    assert world.wave_drag(0.04, -0.1) == pytest.approx(4.0)
    assert world.wave_drag(0.06, 0.1) == 0
    assert world.wave_drag(-0.06, 0.1) == 0


@pytest.mark.parametrize(
    "wrong", [{"mass": 0.0}, {"inertia": (0.0, 1.0, 1.0)}, {"added_mass": (-1.0,) * 6}, {"floor": 0.05}]
)
def test_invalid_parameters_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"must be above 0|leaves no room"):
        SimulationParameters(**wrong)  # type: ignore[arg-type]
