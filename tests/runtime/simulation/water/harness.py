"""Bodies for experiments: pushed by a steady force, in deep water, with parts of the physics removed."""

from dataclasses import replace
from math import cos, pi, sin

from robot_runtime.simulation.water.body import Body
from robot_runtime.simulation.water.fins import Fins, Four
from robot_runtime.simulation.water.geometry import BodyState, at_rest
from robot_runtime.simulation.water.parameters import SensorQuality, SimulationParameters, Six, Vector
from robot_runtime.simulation.water.world import World

PERFECT = SensorQuality()
QUIET = SimulationParameters(
    pressure=PERFECT,
    gyroscope=PERFECT,
    accelerometer=PERFECT,
    encoder=PERFECT,
    beacon_right=PERFECT,
    beacon_left=PERFECT,
    battery=PERFECT,
)
"""The default robot with sensors that tell just what they feel."""
STILL: Four = (0.0, 0.0, 0.0, 0.0)
NEUTRAL = SimulationParameters(buoyancy=1.0, floor=1000.0)
UNDAMPED = replace(NEUTRAL, damping_linear=(0.0,) * 6, damping_quadratic=(0.0,) * 6)


class SteadyPush(Fins):
    """Fins with a constant wrench."""

    def __init__(self, wrench: Six = (0.0,) * 6) -> None:
        super().__init__(NEUTRAL)
        self.wrench = wrench

    def push(self, angles: Four, speeds: Four, velocity: Vector, rate: Vector) -> Six:
        del angles, speeds, velocity, rate
        return self.wrench


def pushed(parameters: SimulationParameters, wrench: Six = (0.0,) * 6, depth: float = 100.0) -> Body:
    """Return a body at rest under a steady push."""
    body = Body(parameters, SteadyPush(wrench), World(parameters))
    body.state = at_rest(depth)
    return body


def finned(parameters: SimulationParameters = NEUTRAL, depth: float = 100.0) -> Body:
    """Return a body at rest with its fins."""
    body = Body(parameters, Fins(parameters), World(parameters))
    body.state = at_rest(depth)
    return body


def drift(body: Body, seconds: float, duration: float = 0.002) -> BodyState:
    """Return the state after this time with fins at rest."""
    for _ in range(round(seconds / duration)):
        body.step(duration, STILL, STILL)
    return body.state


class Flapping:
    """Fins that flap as the firmware moves them, zero + A/2 · sin(2πft + phase); the others rest."""

    def __init__(
        self,
        zeros: Four,
        phases: Four = (0.0, 0.0, 0.0, 0.0),
        amplitude: float = 1.6,
        frequency: float = 1.3,
        fins: tuple[int, ...] = (0, 1, 2, 3),
    ) -> None:
        self.zeros = zeros
        self.phases = phases
        self.halves = [amplitude / 2 if fin in fins else 0.0 for fin in range(4)]
        self.omega = 2 * pi * frequency

    def at(self, time: float) -> Four:
        """Angles in rad at this time."""
        a, b, c, d = (
            zero + half * sin(self.omega * time + phase)
            for zero, half, phase in zip(self.zeros, self.halves, self.phases, strict=True)
        )
        return a, b, c, d

    def speeds_at(self, time: float) -> Four:
        """Speeds in rad/s at this time."""
        a, b, c, d = (
            half * self.omega * cos(self.omega * time + phase)
            for half, phase in zip(self.halves, self.phases, strict=True)
        )
        return a, b, c, d

    def swim(self, body: Body, seconds: float, duration: float = 0.002, start: float = 0.0) -> BodyState:
        """Move the body through the water; return the state after it."""
        for index in range(round(seconds / duration)):
            before, after = self.at(start + index * duration), self.at(start + (index + 1) * duration)
            a, b, c, d = ((late - early) / duration for early, late in zip(before, after, strict=True))
            body.step(duration, before, (a, b, c, d))
        return body.state
