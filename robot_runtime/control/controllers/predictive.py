"""The model-based controller of the depth."""

from collections.abc import Mapping
from math import copysign, exp, sqrt
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits
from robot_runtime.control.controllers.heave import DOWN, TINY, TURNING_ROUND, Heave, Motion

_LOST = 1.0
"""s without a step after which what was known of the motion is worth nothing."""
_FINE, _COARSE = 0.02, 0.04
"""s: steps in which the model is carried on to now, and ahead."""
_ARRIVED = 1e-6
_SPEED_MAX = 0.3
"""m/s."""
_DRIFT_SURE = 0.006
"""m/s²; a drift the other way must be stronger before it counts."""
_QUIET = 0.02
"""m/s²; while the fins push harder, what is unexplained may be theirs."""
_FINISH = 0.006
"""m/s²: with this braking, less than the drift's, the last centimetre towards home is swum."""
_WEIGHT = 70.0
_AHEAD = 0.036
"""s from the step to when the fins have followed."""


class Predictive(Controller):
    """Thinks ahead with a model of hull and fins, and so turns the fins round only where that pays.

    Three parts. An *observer* carries the model on and corrects depth, speed and what is unexplained by the
    readings (fading memory, P. Zarchan and H. Musoff, Fundamentals of Kalman Filtering, 2009, 7; as an
    extended state observer, J. Han, From PID to Active Disturbance Rejection Control, 2009); the unexplained
    is drift, or fins of another strength. A *speed* is wanted for each distance from the set point, as
    braking allows it (√(2·a·distance), time-optimal; linear where that would be too steep: a boundary layer,
    J.-J. Slotine and W. Li, Applied Nonlinear Control, 1991, 7.2), and the push that brings it follows from
    the model. The *direction* of the fins: turning them round takes 0.64 s and is itself a blow, so that at
    rest they stay on the side that holds against the drift (home), and the push is modulated there. They
    leave home to swim the other way, or to brake what coasting would not stop in time, at the last moment at
    which turning there and back is enough; they turn home once the motion after that is the wanted one.
    """

    name = "predictive"
    title = "Model-based"
    averages = True
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "observer": GainLimits(0.8, 0.2, 10.0, "1/s", "how fast the estimate follows what is measured"),
        "response": GainLimits(2.4, 0.5, 10.0, "1/s", "how fast the wanted speed is taken up"),
        "approach": GainLimits(0.88, 0.2, 10.0, "1/s", "wanted speed for each metre from the set point"),
        "braking": GainLimits(0.28, 0.01, 1.0, "m/s²", "deceleration that is counted on while approaching"),
        "thrust": GainLimits(0.25, 0.05, 2.0, "m/s²", "acceleration by all fins at full command"),
        "drag": GainLimits(6.0, 0.5, 50.0, "1/m", "deceleration by drag for each (m/s)²"),
    }
    _observer_pushed = 6.8  # 1/s for each m/s² of push: faster while much happens
    _return, _return_braking = 2.3, 0.54  # 1/s and m/s², against the drift, where fins at home brake
    _leave_speed, _leave_way = 0.067, 0.08  # m/s, m: below, the fins stay at home
    _leave_over, _turn_over, _return_over = 0.01, 0.016, 0.005  # m past the set point

    def __init__(self) -> None:
        super().__init__()
        self.start()

    def start(self) -> None:
        """Forget motion and drift."""
        self._heave = Heave(self.gains["thrust"], self.gains["drag"], drift=-0.01)
        self._motion: Motion | None = None
        self._command = 0.0
        self._home = 1.0

    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """Estimate, decide; `measured` is the mean of the time since the last step."""
        self._heave.thrust, self._heave.drag = self.gains["thrust"], self.gains["drag"]
        if self._motion is None or seconds > _LOST:
            self._motion = Motion(measured, 0.0)
        elif seconds > 0:
            self._motion = self._observe(self._motion, measured, seconds)
        self._command = self._decide(set_point, self._motion)
        return self._command

    def _observe(self, motion: Motion, measured: float, seconds: float) -> Motion:
        heave = self._heave
        motion = heave.advance(motion, self._command, seconds, _FINE)
        memory = exp(-(self.gains["observer"] + self._observer_pushed * abs(heave.pushed)) * seconds)
        new = 1 - memory
        wrong = measured - (motion.depth - motion.speed * seconds / 2)
        heave.learn(new**3 / seconds**2 * wrong, _WEIGHT)
        return motion._replace(
            depth=motion.depth + (1 - memory**3) * wrong,
            speed=motion.speed + 1.5 * new**2 * (1 + memory) / seconds * wrong,
        )

    def _decide(self, set_point: float, motion: Motion) -> float:
        heave = self._heave
        if heave.drift * self._home > _DRIFT_SURE and abs(heave.pushed) < _QUIET:
            self._home = -self._home
        motion = motion._replace(depth=motion.depth + motion.speed * _AHEAD)
        turning = self._command != 0 and abs(motion.direction) < DOWN - _ARRIVED
        side = copysign(1.0, (self._command if turning else motion.direction) or set_point - motion.depth)
        then = motion
        if turning or motion.direction == 0:
            left = abs(side * DOWN - motion.direction) / (2 * DOWN) * TURNING_ROUND
            then = heave.advance(motion._replace(amplitude=0.0), side * TINY, left, _COARSE)
        if side == self._home:
            leave = not turning and self._must_leave(set_point, then)
            push = 0.0 if leave else max(self._wanted(set_point, then) * side, 0.0)
        else:
            back = self._turn(then)
            push = max(self._wanted(set_point, back) * side, 0.0)
            leave = not turning and self._may_return(set_point, back)
        if leave:
            return -side * TINY
        if turning and motion.direction * side < 0:
            return side * TINY
        command = abs(heave.command(push))
        return side * max(command, TINY) if turning or command else 0.0

    def _must_leave(self, set_point: float, motion: Motion) -> bool:
        """Whether fins at home must turn round now: to swim far against it, or to brake."""
        if (motion.depth - set_point) * self._home > self._leave_way:
            return True
        if motion.speed * self._home <= self._leave_speed:
            return False
        if self._stops_past(set_point, motion) <= self._leave_over:
            return False
        return self._stops_past(set_point, self._turn(self._turn(motion))) > self._turn_over

    def _may_return(self, set_point: float, back: Motion) -> bool:
        """Whether fins may turn home now, after which the motion is `back`."""
        if back.speed * self._home <= 0:
            return self._wanted(set_point, back) * self._home > 0
        return self._stops_past(set_point, back) < self._return_over

    def _turn(self, motion: Motion) -> Motion:
        """The motion once the fins have turned round from where they are."""
        return self._heave.advance(motion, -copysign(TINY, motion.direction), TURNING_ROUND, _COARSE)

    def _stops_past(self, set_point: float, motion: Motion) -> float:
        """m past the set point, seen towards home, where it stops with its fins at rest."""
        heave, home = self._heave, self._home
        seen = Heave(heave.thrust, heave.drag, heave.strength, heave.drift * home)
        return (motion.depth - set_point) * home + seen.coast(motion.speed * home)

    def _wanted(self, set_point: float, motion: Motion) -> float:
        """The push (m/s²) that gives the hull the speed that it should have there."""
        error = set_point - motion.depth
        if error * self._home < 0:
            braking, slope = self._return_braking, self._return
        else:
            braking, slope = self.gains["braking"], self.gains["approach"]
        if abs(error) < braking / slope**2:
            speed = slope * error
        else:
            speed = min(sqrt(2 * braking * (abs(error) - braking / (2 * slope**2))), _SPEED_MAX)
            speed = copysign(speed, error)
        if error * self._home > 0:
            speed = copysign(max(abs(speed), sqrt(2 * _FINISH * abs(error))), error)
        gain = self.gains["response"]
        return gain * (speed - motion.speed) + self._heave.resistance(motion.speed) - self._heave.drift
