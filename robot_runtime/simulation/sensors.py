"""What the robot's sensors feel of the simulated motion."""

from math import cos, hypot, sin
from random import Random
from typing import NamedTuple

from robot_runtime.simulation.body import State
from robot_runtime.simulation.geometry import Matrix, rotation, to_body, to_world
from robot_runtime.simulation.parameters import Parameters, Vector


class Reading(NamedTuple):
    """All sensors at one moment."""

    pressure: float
    """Pa, absolute."""
    temperature: float
    """°C."""
    force: Vector
    """m/s², specific force in body axes: (0, 0, -9.81) on an upright hull at rest."""
    rate: Vector
    """rad/s, in body axes."""
    beacon_right: bool
    beacon_left: bool
    battery: float
    """V."""


class Sensors:
    """Reads the hull's state. The IMU's noise is Gaussian and the same for the same seed."""

    def __init__(self, parameters: Parameters, seed: int) -> None:
        self._parameters = parameters
        self._random = Random(seed)

    def read(self, state: State, acceleration: Vector, battery: float) -> Reading:
        """What the sensors show; `acceleration` is that over ground in world axes (m/s²), `battery` in V."""
        parameters, noise = self._parameters, self._random.gauss
        matrix = rotation(state.attitude)
        north, east, down = acceleration
        x, y, z = to_body(matrix, (north, east, down - parameters.gravity))
        p, q, r = state.rate
        force_noise, rate_noise = parameters.force_noise, parameters.rate_noise
        right, left = self._beacons(state, matrix)
        return Reading(
            pressure=self._pressure(state, matrix),
            temperature=parameters.temperature,
            force=(x + noise(0, force_noise), y + noise(0, force_noise), z + noise(0, force_noise)),
            rate=(p + noise(0, rate_noise), q + noise(0, rate_noise), r + noise(0, rate_noise)),
            beacon_right=right,
            beacon_left=left,
            battery=battery,
        )

    def _pressure(self, state: State, matrix: Matrix) -> float:
        parameters = self._parameters
        depth = state.position[2] + to_world(matrix, parameters.pressure_position)[2]
        return parameters.surface_pressure + parameters.density * parameters.gravity * max(depth, 0.0)

    def _beacons(self, state: State, matrix: Matrix) -> tuple[bool, bool]:
        """Whether the right and the left detector see the beacon: it is near enough and within their view."""
        parameters = self._parameters
        north, east, down = (a - b for a, b in zip(parameters.beacon, state.position, strict=True))
        distance = hypot(north, east, down)
        if distance > parameters.beacon_range:
            return False, False
        if distance == 0:
            return True, True
        forward, right, _ = to_body(matrix, (north, east, down))
        ahead = cos(parameters.beacon_detector) * forward / distance
        aside = sin(parameters.beacon_detector) * right / distance
        edge = cos(parameters.beacon_view)
        return ahead + aside >= edge, ahead - aside >= edge
