"""The water and its bounds: the surface with its waves, the flow under it, floor and walls."""

from math import cos, exp, pi, sin, sqrt, tanh
from typing import NamedTuple

from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import Basin, Current, Waves

BREAKING = 0.142
"""Height over length, for each tanh(kh), at which a wave breaks (Miche 1944)."""
NOWHERE: Vector = (0.0, 0.0, 0.0)


class Flow(NamedTuple):
    """The water's motion at one position and moment, in world axes."""

    velocity: Vector
    """m/s north, east, down."""
    acceleration: Vector
    """m/s², of the water that is there: ∂u/∂t + (u·∇)u."""
    rise: float
    """m, elevation of the surface above still water."""


class World:
    """Water between surface and floor, with a current and one regular wave.

    Waves are those of Airy's linear theory over a level floor (R. G. Dean and R. A. Dalrymple, Water Wave
    Mechanics for Engineers and Scientists, 1991, chapter 3). With amplitude a, angular frequency ω, water
    depth h, depth z below still water, and phase θ = kx - ωt along its direction x, the surface is at
    η = a·cos θ, the water moves along x with aω·cosh k(h-z)/sinh kh·cos θ and downwards with
    -aω·sinh k(h-z)/sinh kh·sin θ, and its pressure is higher by ρga·cosh k(h-z)/cosh kh·cos θ, where k
    follows from ω² = gk·tanh kh. In deep water all these decay with e^(-kz). Above still water they are
    taken as at it. Current and waves do not interact.

    The hull counts as an upright box: its part above the surface has no buoyancy, and while it breaks the
    surface it loses energy to waves of its own. Fins work everywhere alike.
    """

    def __init__(self, parameters: SimulationParameters) -> None:
        self._gravity = parameters.gravity
        self._specific_weight = parameters.density * parameters.gravity
        self._surface_pressure = parameters.surface_pressure
        self._height = parameters.height
        self._damping = parameters.surface_damping
        self.basin = Basin(parameters.floor)
        self.waves = Waves()
        self.set_current(Current())
        self._tune_waves(self._wave_number(self.waves, self.basin))

    def set_current(self, current: Current, time: float = 0.0) -> None:
        """Set the current from `time` (s) on."""
        self.current = current
        self._since = time
        self._calm = Flow((current.north, current.east, current.down), NOWHERE, 0.0)

    def set_waves(self, waves: Waves) -> None:
        """Set the waves. Raise ValueError if they would break in water of this depth."""
        number = self._wave_number(waves, self.basin)
        self.waves = waves
        self._tune_waves(number)

    def set_basin(self, basin: Basin) -> None:
        """Set floor and walls. Raise ValueError if the present waves would break there."""
        number = self._wave_number(self.waves, basin)
        self.basin = basin
        self._tune_waves(number)

    def flow(self, time: float, position: Vector) -> Flow:
        """Return the motion of the water at this time (s) and position (m)."""
        if not self.waves.amplitude and not self.current.turning:
            return self._calm
        (north, east, down), (north_rate, east_rate, down_rate) = self._drift(time)
        if not self.waves.amplitude:
            return Flow((north, east, down), (north_rate, east_rate, down_rate), 0.0)
        (near, far), phase = self._decay(time, position)
        x, y = self._direction
        swing, bob = cos(phase), sin(phase)
        level, upright = self._speed * (near + far), self._speed * (near - far)
        ahead, under = level * swing, -upright * bob
        # Phase and decay change with the motion of the water itself: θ by k·u less ω, e^(-kz) with its depth.
        passing = self._frequency - self._number * (north * x + east * y + ahead)
        sinking = self._number * (down + under)
        ahead_rate = passing * level * bob - sinking * upright * swing
        under_rate = passing * upright * swing + sinking * level * bob
        velocity = (north + ahead * x, east + ahead * y, down + under)
        acceleration = (north_rate + ahead_rate * x, east_rate + ahead_rate * y, down_rate + under_rate)
        return Flow(velocity, acceleration, self.waves.amplitude * swing)

    def pressure(self, time: float, position: Vector) -> float:
        """Return the absolute pressure, Pa: hydrostatic and of the wave; in air that of the surface."""
        head = position[2]
        if self.waves.amplitude:
            deep, phase = self._decay(time, position)
            head += self.waves.amplitude * cos(phase) * (deep[0] + deep[1]) / (1 + self._echo)
        return self._surface_pressure + self._specific_weight * max(head, 0.0)

    def floating_depth(self, buoyancy: float) -> float:
        """Return the depth (m) of the centre of a floating hull at rest; a sinking one is just covered."""
        return min(self._height / buoyancy, self._height) - self._height / 2

    def submerged(self, depth: float) -> float:
        """Return the share of the hull under water, 0 to 1, with its centre at this depth (m)."""
        return min(max(depth / self._height + 0.5, 0.0), 1.0)

    def wave_drag(self, depth: float, sinking: float) -> float:
        """Return the force (N, downwards) of the waves of a hull that sinks through the surface (m/s)."""
        half = self._height / 2
        return -self._damping * sinking if -half < depth < half else 0.0

    def _drift(self, time: float) -> tuple[Vector, Vector]:
        """Return velocity and acceleration of the current."""
        current = self.current
        if not current.turning:
            return self._calm.velocity, NOWHERE
        angle = current.turning * (time - self._since)
        c, s = cos(angle), sin(angle)
        north, east = current.north * c - current.east * s, current.north * s + current.east * c
        return (north, east, current.down), (-current.turning * east, current.turning * north, 0.0)

    def _decay(self, time: float, position: Vector) -> tuple[tuple[float, float], float]:
        """Return e^(-kz) and e^(-k(2h-z)), from which all decays follow, and the phase (rad)."""
        depth = min(max(position[2], 0.0), self.basin.depth)
        deep = exp(-self._number * depth), exp(-self._number * (2 * self.basin.depth - depth))
        x, y = self._direction
        return deep, self._number * (position[0] * x + position[1] * y) - self._frequency * time

    def _wave_number(self, waves: Waves, basin: Basin) -> float:
        """Return k (rad/m) of ω² = gk·tanh kh, by Newton's method. Raise ValueError if the wave breaks."""
        frequency = 2 * pi / waves.period
        deep = frequency**2 / self._gravity
        number = deep / sqrt(tanh(deep * basin.depth))
        for _ in range(20):
            level = tanh(number * basin.depth)
            slope = level + number * basin.depth * (1 - level * level)
            number -= (number * level - deep) / slope
        highest = BREAKING * pi / number * tanh(number * basin.depth)
        if waves.amplitude > highest:
            raise ValueError(
                f"waves of {waves.amplitude:g} m amplitude and {waves.period:g} s period break in water of "
                f"{basin.depth:g} m; {highest:.2g} m is the most there: choose lower or longer waves"
            )
        return number

    def _tune_waves(self, number: float) -> None:
        waves = self.waves
        self._number = number
        self._frequency = 2 * pi / waves.period
        self._direction = cos(waves.direction), sin(waves.direction)
        self._echo = exp(-2 * number * self.basin.depth)
        self._speed = waves.amplitude * self._frequency / (1 - self._echo)
