"""A model of heave motion driven by four fins, which `Predictive` uses for its predictions.

Depth z (m) and its speed v (m/s) count downwards; forces are accelerations of the hull with its added mass.
The numbers are those of the simulated robot (docs/reference/craft.md): the thrust of a flapping fin is
∝ 1 - cos A, where A is its amplitude from peak to peak; a fin that turns round pushes like a paddle, as in
`simulation/water/fins.py`.
"""

from dataclasses import dataclass, field
from math import acos, copysign, cos, pi, sin
from typing import NamedTuple

TINY = 1 / 127
"""The least command: it turns the fins round and hardly flaps them. A command of 0 stops their turning."""
DOWN = pi / 2
"""rad: direction of fins that push the hull down; -DOWN of fins that push it up."""
_AMPLITUDE = 1.6
_AMPLITUDE_RATE = _AMPLITUDE / 0.12
_TURN_RATE = 80 / 1024 * 2 * pi / 0.1
"""rad/s; the firmware turns fins by at most 80 ticks of 1024 in 100 ms, and flaps them harder in 120 ms."""
TURNING_ROUND = 2 * DOWN / _TURN_RATE
"""s that the fins take to turn round."""
_FULL = 1 - cos(_AMPLITUDE)
_STROKES = 1.3
"""Hz."""
_SWEEP_THRUST = 0.306 / 0.268
"""Thrust of fins that turn round, 4 · ½ρ·C_T·S·(r_c·θ̇)², over that of the full command."""
LINEAR, BLADE, CENTRE = 0.25, 2.9, 0.045
"""Defaults of the model's numbers."""


class Motion(NamedTuple):
    """The hull and its fins: depth, speed, direction of the fins (rad), their amplitude (rad)."""

    depth: float
    speed: float
    direction: float = 0.0
    amplitude: float = 0.0

    def pointing(self, side: float) -> bool:
        """Return True if the fins point to this side, 1 down and -1 up."""
        return self.direction * side > DOWN - 1e-6


@dataclass(slots=True)
class Heave:
    """The model with the parameters estimated for this craft; accelerations in m/s²."""

    thrust: float
    """Acceleration by all fins at full command."""
    drag: float
    """1/m: quadratic drag over the mass."""
    linear: float = LINEAR
    """1/s: linear damping over the mass."""
    blade: float = BLADE
    """1/m: 4 · ½ρ·C_N·S over the mass, of the blades across their motion."""
    centre: float = CENTRE
    """m from the shaft to the middle of a blade."""
    strength: float = 1.0
    """The fins' thrust as a share of the model's; likewise the next two."""
    blades: float = 1.0
    """The water's force across the blades."""
    hull: float = 1.0
    """The drag of the hull."""
    drift: float = 0.0
    """Any other push downwards: buoyancy, below 0 where the hull floats."""
    slopes: tuple[float, float, float, float] = field(default=(0.0, 0.0, 0.0, 0.0), init=False)
    """Derivatives of the speed after the last `advance` by strength, blades, hull and the speed before."""

    def advance(self, motion: Motion, command: float, seconds: float, step: float) -> Motion:
        """Return the motion after `seconds` under this command, computed in steps of about `step` s."""
        depth, speed, direction, amplitude = motion
        count = max(round(seconds / step), 1)
        step = seconds / count
        goal, goal_amplitude = copysign(DOWN, command) if command else direction, _AMPLITUDE * abs(command)
        pushed = across_blades = resisted = steepness = 0.0
        # The mean of 2 · blade · |r_c·θ̇| · cos²θ over a stroke about ±DOWN is this times A - sin A.
        flapping = 2 * self.blade * self.centre * _STROKES
        sweep, sweep_thrust = self.centre * _TURN_RATE, self.thrust * _SWEEP_THRUST
        for _ in range(count):
            push = self.thrust * (1 - cos(amplitude)) / _FULL
            blades = -flapping * (amplitude - sin(amplitude)) * speed
            if direction != goal or abs(direction) < DOWN:
                turn = _limit(goal - direction, _TURN_RATE * step)
                middle, share = direction + turn / 2, turn / (_TURN_RATE * step)
                across = cos(middle)
                flow = share * sweep - speed * across
                blades += self.blade * across * flow * abs(flow)
                push = (push + sweep_thrust * abs(share)) * sin(middle)
                direction += turn
            elif direction < 0:
                push = -push
            resistance = (self.linear + self.drag * abs(speed)) * speed
            pushed, across_blades, resisted = pushed + push, across_blades + blades, resisted + resistance
            steepness += self.linear + 2 * self.drag * abs(speed)
            amplitude += _limit(goal_amplitude - amplitude, _AMPLITUDE_RATE * step)
            before = speed
            speed += (
                self.strength * push + self.blades * blades - self.hull * resistance + self.drift
            ) * step
            depth += (before + speed) / 2 * step
        self.slopes = pushed * step, across_blades * step, -resisted * step, 1 - self.hull * steepness * step
        return Motion(depth, speed, direction, amplitude)

    def resistance(self, speed: float) -> float:
        """Return the hull's deceleration by drag at this speed, m/s², with resting fins."""
        return self.hull * (self.linear + self.drag * abs(speed)) * speed

    def coast(self, speed: float, drift: float) -> float:
        """Return the distance, m, of coasting for 3 s from this speed (m/s, above 0), fins at rest."""
        way = 0.0
        for _ in range(30):
            speed += (drift - self.resistance(speed)) * 0.1
            if speed <= 0:
                break
            way += speed * 0.1
        return way

    def command(self, push: float) -> float:
        """Return the command, 0 to 1, for this push of the fins (m/s²); 0 for a negative one."""
        share = min(max(push, 0.0) / (self.thrust * self.strength), 1.0)
        return acos(1 - share * _FULL) / _AMPLITUDE


def _limit(value: float, most: float) -> float:
    return min(max(value, -most), most)
