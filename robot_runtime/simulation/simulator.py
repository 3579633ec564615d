"""The whole simulated robot apart from its board: fins in, sensor readings out."""

import threading
from math import ceil, hypot
from typing import NamedTuple

from robot_runtime.samples import Truth
from robot_runtime.simulation.body import Body
from robot_runtime.simulation.fins import Fins, Four
from robot_runtime.simulation.geometry import rotation, to_world
from robot_runtime.simulation.parameters import Parameters, Vector
from robot_runtime.simulation.sensors import Reading, Sensors
from robot_runtime.simulation.world import World

STEP_MAX = 0.005
"""s; at this step a position is off by less than 0.1 mm after 10 s of swimming."""
CURRENT_MAX = 2.0
"""m/s; ten times what the robot swims."""
DRIVE_MAX = 63
"""The H-bridges' command at full voltage."""


class FinMotion(NamedTuple):
    """The fins at one moment, as the board tells of them."""

    angles: Four
    """rad."""
    speeds: Four
    """rad/s."""
    drives: Four
    """H-bridge commands, -63 to 63."""
    powered: bool
    """Whether the motors have power."""


class Simulator:
    """Body, world and sensors together. Its methods may be called from any thread."""

    def __init__(self, parameters: Parameters, seed: int) -> None:
        self._parameters = parameters
        self._world = World(parameters)
        self._body = Body(parameters, Fins(parameters), self._world)
        self._sensors = Sensors(parameters, seed)
        self._battery = parameters.battery_full
        self._angles: Four = (0.0, 0.0, 0.0, 0.0)
        self._lock = threading.Lock()

    def advance(self, period: float, fins: FinMotion) -> Reading:
        """Let `period` (s) pass, at whose end the fins are as given, and read the sensors."""
        with self._lock:
            before = self._velocity()
            steps = ceil(period / STEP_MAX)
            duration = period / steps
            a, b, c, d = fins.angles
            e, f, g, h = fins.speeds
            for step in range(steps):
                left = period - step * duration
                start = (a - e * left, b - f * left, c - g * left, d - h * left)
                self._body.step(duration, start, fins.speeds)
            self._angles = fins.angles
            self._drain(period, fins)
            after = self._velocity()
            # The mean over the period, so that the blow of reaching the floor is felt.
            acceleration = (
                (after[0] - before[0]) / period,
                (after[1] - before[1]) / period,
                (after[2] - before[2]) / period,
            )
            return self._sensors.read(self._body.state, acceleration, self._battery)

    def reset(self) -> None:
        """Back to the start: at rest at the surface, looking north, with a full battery."""
        with self._lock:
            self._body.state = Body.at_rest(self._world.floating_depth)
            self._battery = self._parameters.battery_full

    def set_current(self, north: float, east: float, down: float) -> None:
        """Let the water flow at this speed (m/s). Raises ValueError beyond 2 m/s."""
        parts = (north, east, down)
        if not all(abs(part) <= CURRENT_MAX for part in parts) or hypot(*parts) > CURRENT_MAX:
            raise ValueError(f"a current must be finite and at most {CURRENT_MAX:g} m/s in all")
        with self._lock:
            self._body.current = parts

    def truth(self) -> Truth:
        """What the body really does now."""
        with self._lock:
            position, attitude, velocity, rate = self._body.state
            return Truth(
                position=position, attitude=attitude, velocity=velocity, rate=rate, fins=self._angles
            )

    def _velocity(self) -> Vector:
        state = self._body.state
        return to_world(rotation(state.attitude), state.velocity)

    def _drain(self, period: float, fins: FinMotion) -> None:
        parameters = self._parameters
        effort = sum(map(abs, fins.drives)) / (DRIVE_MAX * len(fins.drives)) if fins.powered else 0.0
        loss = parameters.battery_idle + parameters.battery_motors * effort
        self._battery = max(self._battery - loss * period, 0.0)
