"""The model-based controller of the depth."""

from collections.abc import Mapping
from math import copysign, exp, inf, sqrt
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits, braked
from robot_runtime.control.controllers.heave import TINY, Heave, Motion
from robot_runtime.control.controllers.heave_observer import LAG, HeaveObserver, InertialHeave

_LOST = 1.0
"""s without a step after which what was known of the motion is worth nothing."""
_DRIFT = -0.01
"""m/s²; a hull of which nothing is known floats up by so much."""
_DRIFT_SURE = 0.006
"""m/s²; a drift the other way must be stronger before it counts."""
_TICK = 0.1
"""s between two steps of a plan."""
_HORIZON = 30
"""Ticks of a plan."""
_AWAY_MORE = (1, 2, 3, 5, 8, 12)
_AWAY_FROM_HOME = (7, 8, 9, 10, 12, 14, 17)
"""Ticks that a plan may keep the fins away from home; to turn there takes seven."""
_FINE, _COARSE = 0.05, 0.1
"""s: steps of the model while the fins turn, and else."""
_PAST, _REACHED = 0.007, 0.003
"""m past the set point to which it goes at first, so as to reach it, and that are taken for having done so:
more than it may be wrong about its depth."""
_FAST = 0.06
"""m/s that turning the fins round gives a hull at rest; one that is slower is not braked by that."""
_FAR, _NEAR, _BESIDE = 0.08, 0.05, 0.04
"""m: farther, it swims as fast as it can; nearer, it only drifts to the point; less than that, it does not
leave home for."""
_OVER = 0.01
"""m past the set point up to which coasting there is good enough."""
_SPEED_MAX = 0.4
"""m/s."""
_DRIFT_LEAST, _DRIFT_USED = 0.004, 0.7
"""m/s² of braking by the drift, and the share of the drift, on which the way home counts."""
_LONGER = 1.16
"""Share by which the way of braking is taken to be longer, as in which part of their stroke the fins stop is
not known, and past the set point is worse."""
_BRAKING = 0.3
"""Share of the fins' thrust on which the way against home counts."""


class Predictive(Controller):
    """Thinks ahead with a model of hull and fins, and so turns the fins round only where that pays.

    `HeaveObserver` learns the craft, and `InertialHeave` tells the motion. Turning the fins round takes
    0.64 s and is itself a blow, so that at rest they stay on the side that holds against the drift (*home*),
    and their push is modulated there. On the way to the set point they are turned for two things.

    To *brake* a fast hull, as late as it can be: one step before turning would bring it to rest behind the
    set point. They stop flapping first, and pause in their turn where that brings the hull nearer.

    To *swim* away from home. When to go and when to come back is found by trying some plans on the model: so
    long away, then home, and the least sum of distances over the next 3 s, those past the set point counted
    several times (receding horizon, J. M. Maciejowski, Predictive Control with Constraints, 2002, 1.3).

    At home a speed is wanted for each distance: towards it the one that drift and drag stop there,
    √(a/q·(e^(2·q·distance) - 1)); against it √(2·a·distance), linear where that would be too steep (a
    boundary layer, J.-J. Slotine and W. Li, Applied Nonlinear Control, 1991, 7.2).
    """

    name = "predictive"
    title = "Model-based"
    averages = True
    needs_heave_acceleration = True
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "noise": GainLimits(0.0022, 0.0005, 0.05, "m", "standard deviation of the depth that a step is told"),
        "response": GainLimits(2.4, 0.5, 10.0, "1/s", "how fast the wanted speed is taken up"),
        "approach": GainLimits(2.3, 0.2, 10.0, "1/s", "wanted speed for each metre against the drift"),
        "overshoot": GainLimits(4.0, 1.0, 20.0, "", "how many times a metre past the set point counts"),
        "thrust": GainLimits(0.268, 0.05, 2.0, "m/s²", "acceleration by all fins at full command"),
        "drag": GainLimits(5.65, 0.5, 50.0, "1/m", "deceleration by drag for each (m/s)²"),
    }

    def __init__(self) -> None:
        super().__init__()
        self.start()

    def start(self) -> None:
        """Forget motion and craft."""
        self._heave = Heave(self.gains["thrust"], self.gains["drag"], drift=_DRIFT)
        self._observer = HeaveObserver(self._heave)
        self._motion: Motion | None = None
        self._inertial: InertialHeave | None = None
        self._command = 0.0
        self._home = 1.0
        self._side = 0.0
        """Where the fins point, or turn to; 0 before they have been turned."""
        self._braking = False
        self._set_point: float | None = None
        self._came = 1.0
        self._past = 0.0

    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """Estimate, decide; `measured` is the mean of the time since the last step."""
        self._heave.thrust, self._heave.drag = self.gains["thrust"], self.gains["drag"]
        if self._motion is None or seconds > _LOST:
            self._motion, self._side, self._inertial = Motion(measured, 0.0), 0.0, None
        elif seconds > 0:
            noise = self.gains["noise"]
            self._motion = self._observer.observe(self._motion, self._command, measured, noise, seconds)
        # What is decided now will act only then.
        motion = self._heave.advance(self._refine(measured, seconds), self._command, LAG, _FINE)
        self._command = self._decide(self._find_goal(set_point, motion), motion)
        return self._command

    def _refine(self, measured: float, seconds: float) -> Motion:
        """Returns the motion, corrected by the measured acceleration if there is one."""
        assert self._motion is not None
        if self.heave_acceleration is None or seconds <= 0:
            self._inertial = None
            return self._motion
        if self._inertial is None:
            self._inertial = InertialHeave(self._motion.depth, self._motion.speed)
            return self._motion
        depth, speed = self._inertial.observe(self.heave_acceleration, measured, self.gains["noise"], seconds)
        return self._motion._replace(depth=depth, speed=speed)

    def _find_goal(self, set_point: float, motion: Motion) -> float:
        if set_point != self._set_point:
            self._set_point, self._came = set_point, copysign(1.0, set_point - motion.depth)
            self._past = self._came * _PAST
        if (motion.depth - set_point) * self._came > _REACHED:
            self._past = 0.0
        return set_point + self._past

    def _decide(self, goal: float, motion: Motion) -> float:
        if self._heave.drift * self._home > _DRIFT_SURE:
            self._home = -self._home
        home, left = self._home, goal - motion.depth
        if not self._side:
            self._side = home if left * home > -_BESIDE else -home
        if not motion.pointing(self._side):
            self._braking = self._braking and motion.speed * self._side < 0
            return self._brake(left, motion) if self._braking else self._side * TINY
        self._braking = False
        at_home = self._side == home
        fast = motion.speed * left > 0 and abs(motion.speed) > _FAST
        if fast and motion.speed * self._side > 0 and self._overshoots(left * home, motion, at_home):
            rest = self._heave.advance(motion, 0.0, _TICK, _FINE)
            way = abs(rest.depth - motion.depth) + self._way(rest, -self._side)
            if way + abs(motion.speed) * _TICK <= abs(left):
                return self._side
            self._side, self._braking = -self._side, True
            return 0.0
        beside = left * home > -_BESIDE and motion.speed * home < _FAST
        if not (at_home and (left * home > 0 or beside)):
            self._side = -home if self._pays_away(goal, motion, at_home) else home
        if self._side == home and left * home > _FAR:
            return home * (1.0 if motion.pointing(home) else TINY)
        return self._swim(goal, motion, self._side)

    def _overshoots(self, left: float, motion: Motion, at_home: bool) -> bool:
        """True if a fast hull would overshoot unless the fins turn; `left` counts towards home, m."""
        if not at_home:
            return -left > _NEAR
        return self._heave.coast(motion.speed * self._home, self._heave.drift * self._home) > left + _OVER

    def _brake(self, left: float, motion: Motion) -> float:
        """Turn on, or pause for a step, whichever lets the hull stop nearer."""
        left *= -self._side
        paused = self._heave.advance(motion, 0.0, _TICK, _FINE)
        later = abs(paused.depth - motion.depth) + self._way(paused, self._side)
        pause = self._badness(left - later) < self._badness(left - self._way(motion, self._side))
        return 0.0 if pause else self._side * TINY

    def _badness(self, left: float) -> float:
        """Of being so far from the set point, m; below 0 past it."""
        return left if left >= 0 else -left * self.gains["overshoot"]

    def _way(self, motion: Motion, side: float) -> float:
        """m that it goes on until fins that turn to this side, and then push fully, have stopped it."""
        start = motion.depth
        for _ in range(_HORIZON):
            if motion.speed * side >= 0:
                break
            command = side if motion.pointing(side) else side * TINY
            motion = self._heave.advance(motion, command, _TICK, _FINE)
        return _LONGER * abs(motion.depth - start)

    def _pays_away(self, goal: float, motion: Motion, at_home: bool) -> bool:
        """True if the best plan keeps the fins away from home now."""
        stay, before = self._cost(goal, motion, 0), inf
        for ticks in _AWAY_FROM_HOME if at_home else _AWAY_MORE:
            cost = self._cost(goal, motion, ticks)
            if cost < stay:
                return True
            if cost > before:
                break
            before = cost
        return False

    def _cost(self, goal: float, motion: Motion, away: int) -> float:
        """Of a plan: so many ticks away from home, then at home; the sum of its distances."""
        total = 0.0
        for tick in range(_HORIZON):
            side = -self._home if tick < away else self._home
            turning = not motion.pointing(side)
            command = self._swim(goal, motion, side)
            motion = self._heave.advance(motion, command, _TICK, _FINE if turning else _COARSE)
            left = goal - motion.depth
            total += self._badness(left * self._came)
        return total

    def _swim(self, goal: float, motion: Motion, side: float) -> float:
        """The command on this side: to turn there, full away from home, the wanted push at home."""
        if not motion.pointing(side):
            return side * TINY
        if side != self._home:
            return side
        command = self._heave.command(self._push(goal, motion))
        return side * max(command, TINY) if command else 0.0

    def _push(self, goal: float, motion: Motion) -> float:
        """The push towards home (m/s²) that brings the wanted speed."""
        heave, home = self._heave, self._home
        left, speed, drift = (goal - motion.depth) * home, motion.speed * home, heave.drift * home
        if left >= 0:
            braking, drag = max(-drift, _DRIFT_LEAST) * _DRIFT_USED, heave.hull * heave.drag
            goal_speed = min(sqrt(braking / drag * (exp(min(2 * drag * left, 6.0)) - 1)), _SPEED_MAX)
            # Along that curve drag brakes by itself.
            return self.gains["response"] * (goal_speed - speed) - drift - braking
        braking = _BRAKING * heave.thrust * heave.strength
        goal_speed = max(braked(left, braking, self.gains["approach"]), -_SPEED_MAX)
        return self.gains["response"] * (goal_speed - speed) + heave.resistance(goal_speed) - drift
