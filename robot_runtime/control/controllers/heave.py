"""What the craft's four fins do to its depth: the model by which `Predictive` thinks ahead.

Depth z (m) and its speed v (m/s) count downwards, forces are accelerations of the hull with the water that it
takes along. The numbers are those of the simulated robot (docs/simulation.md), which are as good as what was
published: thrust of a flapping fin ∝ 1 - cos A, where A is its amplitude from peak to peak; a fin that turns
round pushes like a paddle, and the water along its blade, as in `simulation/fins.py`.
"""

from dataclasses import dataclass
from math import acos, copysign, cos, pi, sin
from typing import NamedTuple

TINY = 1 / 127
"""The least command: it turns the fins round, and hardly flaps them."""
DOWN = pi / 2
"""rad: where the fins point when they push the hull down; -DOWN when up."""
_AMPLITUDE = 1.6
_AMPLITUDE_RATE = _AMPLITUDE / 0.12
_TURN_RATE = 80 / 1024 * 2 * pi / 0.1
"""rad/s; the firmware turns fins by at most 80 ticks of 1024 in 100 ms, and flaps them harder in 120 ms."""
TURNING_ROUND = 2 * DOWN / _TURN_RATE
"""s."""
_FULL = 1 - cos(_AMPLITUDE)
_BLADE = 2.94
"""1/m: 4 · ½ρ·C_N·S over the mass, of the blades across their motion."""
_SWEEP = 0.045 * _TURN_RATE
"""m/s of the blades' centres while the fins turn round."""
_SWEEP_THRUST = 0.306
"""m/s²: 4 · ½ρ·C_T·S·(r_c·θ̇)² over the mass, of fins that turn round."""
_LINEAR = 0.25
"""1/s: linear damping over the mass."""
_STILL = 0.02
"""m/s² below which a push says nothing of its own strength."""

_DRIFT_MAX = 0.012
"""m/s²; in water that is still."""
_DOUBT = 0.4
"""Share by which the fins may be stronger or weaker than the model's."""


class Motion(NamedTuple):
    """The hull and its fins: depth, speed, direction of the fins (rad), their amplitude (rad)."""

    depth: float
    speed: float
    direction: float = 0.0
    amplitude: float = 0.0


@dataclass(slots=True)
class Heave:
    """The model with what is learnt of this craft; accelerations in m/s²."""

    thrust: float
    """Of all fins at full command."""
    drag: float
    """1/m: quadratic drag over the mass."""
    strength: float = 1.0
    """Of the fins' thrust, as a share of the model's."""
    drift: float = 0.0
    """What else pushes the hull down: buoyancy, below 0 where it floats."""
    pushed: float = 0.0
    """The fins' mean thrust over the last `advance`, by the model."""

    def advance(self, motion: Motion, command: float, seconds: float, step: float) -> Motion:
        """The motion after `seconds` under this command, in steps of about `step` s (explicit Euler)."""
        depth, speed, direction, amplitude = motion
        count = max(round(seconds / step), 1)
        step = seconds / count
        goal, wanted = copysign(DOWN, command) if command else direction, _AMPLITUDE * abs(command)
        total = 0.0
        for _ in range(count):
            push, paddle = self.thrust * (1 - cos(amplitude)) / _FULL * sin(direction), 0.0
            if direction != goal:
                across, side = cos(direction), copysign(1.0, goal - direction)
                flow = _SWEEP - side * speed * across
                paddle = side * _BLADE * across * flow * abs(flow)
                push += _SWEEP_THRUST * sin(direction)
                direction += _limit(goal - direction, _TURN_RATE * step)
            amplitude += _limit(wanted - amplitude, _AMPLITUDE_RATE * step)
            total += push
            speed += (self.strength * push + paddle - self.resistance(speed) + self.drift) * step
            depth += speed * step
        self.pushed = total / count
        return Motion(depth, speed, direction, amplitude)

    def resistance(self, speed: float) -> float:
        """Drag against this speed."""
        return (_LINEAR + self.drag * abs(speed)) * speed

    def coast(self, speed: float) -> float:
        """How far a hull of this speed (m/s, above 0) goes on with resting fins, downwards, m."""
        way = 0.0
        for _ in range(30):
            speed += (self.drift - self.resistance(speed)) * 0.1
            if speed <= 0:
                break
            way += speed * 0.1
        return way

    def command(self, push: float) -> float:
        """The command, -1 to 1, with which the fins push so (m/s²), once they point there."""
        share = min(abs(push) / (self.thrust * self.strength), 1.0)
        return copysign(acos(1 - share * _FULL) / _AMPLITUDE, push)

    def learn(self, unexplained: float, weight: float) -> None:
        """Take an acceleration that was not expected for drift, or for fins of another strength.

        The harder the fins push, the more of it is theirs: least squares with the doubts of both, `weight`
        being the ratio of the fins' doubt (as a share) to the drift's (m/s²).
        """
        theirs = (self.pushed * weight) ** 2
        theirs /= theirs + 1
        self.drift = _limit(self.drift + (1 - theirs) * unexplained, _DRIFT_MAX)
        if abs(self.pushed) > _STILL:
            strength = self.strength + theirs * unexplained / self.pushed
            self.strength = min(max(strength, 1 - _DOUBT), 1 + _DOUBT)


def _limit(value: float, most: float) -> float:
    return min(max(value, -most), most)
