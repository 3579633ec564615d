"""The arrays' equations are the simulator's, term by term."""

from random import Random

import numpy as np
import pytest

from robot_runtime.contract.craft import Craft, Six, Vector
from robot_runtime.experiments.identification.bodies import Bodies, FinMotions
from robot_runtime.simulation.water.body import Body
from robot_runtime.simulation.water.fins import Fins, Four
from robot_runtime.simulation.water.geometry import BodyState, rotation, to_body, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.world import World

STEP, STEPS = 0.01, 60
CRAFTS = (
    Craft(),
    Craft(
        mass=3.3,
        buoyancy=1.02,
        buoyancy_forward=0.002,
        buoyancy_right=-0.003,
        buoyancy_height=0.014,
        added_mass=(1.2, 2.0, 4.0, 0.005, 0.01, 0.013),
        damping_linear=(0.4, 1.9, 1.1, 0.005, 0.007, 0.004),
        damping_quadratic=(14.0, 20.0, 45.0, 0.03, 0.04, 0.07),
        fin_drag=0.2,
        fin_normal=2.6,
        pressure_position=(0.01, 0.02, -0.04),
    ),
)


def flapping(random: Random) -> tuple[np.ndarray, np.ndarray]:
    """Angles and speeds at every half step, of shape (half steps, fins)."""
    time = np.arange(2 * STEPS + 1)[:, None] * STEP / 2
    middle = np.array([random.uniform(-3, 3) for _ in range(4)])
    phase = np.array([random.uniform(-3, 3) for _ in range(4)])
    swing = 0.8 * np.sin(8 * time + phase)
    return middle + swing, 6.4 * np.cos(8 * time + phase)


@pytest.mark.parametrize("craft", CRAFTS, ids=["default", "another"])
def test_a_window_moves_as_the_simulator_s_body_does(craft: Craft) -> None:
    random = Random(4)
    angles, speeds = flapping(random)
    roll, pitch = 0.3, -0.2
    start = [2.0, 0.2, -0.1, 0.15, roll, pitch, 0.4, -0.3, 0.5]
    motion = FinMotions(angles[:, :, None], speeds[:, :, None])
    result = Bodies([craft], [motion], [0]).simulate(np.array(start)[:, None, None], STEP, 1)[:, :, 0, 0]

    parameters = SimulationParameters.of(craft)
    body = Body(parameters, HalfSteps(parameters, angles, speeds), World(parameters))
    cr, sr, cp, sp = np.cos(roll / 2), np.sin(roll / 2), np.cos(pitch / 2), np.sin(pitch / 2)
    attitude = (float(cr * cp), float(sr * cp), float(cr * sp), float(-sr * sp))
    body.state = BodyState((0.0, 0.0, 2.0), attitude, (0.2, -0.1, 0.15), (0.4, -0.3, 0.5))
    for index in range(STEPS + 1):
        assert result[:, index] == pytest.approx(measured(body, parameters), abs=1e-9)
        body.step(STEP, (0.0,) * 4, (0.0,) * 4)


class HalfSteps(Fins):
    """Fins with their motion given at every half step: one derivative is asked for at each."""

    def __init__(self, parameters: SimulationParameters, angles: np.ndarray, speeds: np.ndarray) -> None:
        super().__init__(parameters)
        self._motion = list(zip(angles.tolist(), speeds.tolist(), strict=True))
        self.half = 0

    def push(self, angles: Four, speeds: Four, velocity: Vector, rate: Vector) -> Six:
        del angles, speeds
        (a, b, c, d), (e, f, g, h) = self._motion[min(self.half, len(self._motion) - 1)]
        self.half += 1
        return super().push((a, b, c, d), (e, f, g, h), velocity, rate)


def measured(body: Body, parameters: SimulationParameters) -> list[float]:
    """Return the channels from the body's own derivative."""
    fins = body._fins
    assert isinstance(fins, HalfSteps)
    half = fins.half
    slope = body.derivative(body.state, (0.0,) * 4, (0.0,) * 4)
    fins.half = half
    matrix = rotation(body.state.attitude)
    u, v, w = body.state.velocity
    p, q, r = body.state.rate
    x, y, z = slope.velocity
    gravity = to_body(matrix, (0.0, 0.0, parameters.gravity))
    force = (x + q * w - r * v - gravity[0], y + r * u - p * w - gravity[1], z + p * v - q * u - gravity[2])
    depth = body.state.position[2] + to_world(matrix, parameters.pressure_position)[2]
    return [depth, p, q, r, *force]
