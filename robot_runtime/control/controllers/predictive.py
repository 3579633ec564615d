"""The model-based controller of the depth."""

from collections.abc import Mapping
from math import copysign, exp, inf, sqrt
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits, braking_speed
from robot_runtime.control.controllers.heave import BLADE, CENTRE, LINEAR, TINY, Heave, Motion
from robot_runtime.control.controllers.heave_observer import (
    ACCELERATION_AGE,
    AGE,
    LAG,
    HeaveObserver,
    InertialHeave,
)

_LOST = 1.0
"""s without a step after which the estimate of the motion is discarded."""
_DRIFT_SURE = 0.006
"""m/s² that a drift the other way must exceed before home changes sides."""
_TICK = 0.1
"""s between two steps of a plan."""
_HORIZON = 30
"""Ticks of a plan."""
_AWAY_MORE = (1, 2, 3, 5, 8, 12)
_AWAY_FROM_HOME = (7, 8, 9, 10, 12, 14, 17)
"""Ticks for which a plan may keep the fins away from home; turning there takes seven."""
_FINE, _COARSE = 0.05, 0.1
"""s: steps of the model while the fins turn, and else."""
_PAST, _REACHED = 0.007, 0.003
"""m past the set point that are aimed at first, and that count as reached; the depth's error is smaller."""
_FAST = 0.06
"""m/s that turning the fins round gives a hull at rest; a slower hull is not braked by turning them."""
_FAR, _NEAR, _BESIDE = 0.08, 0.05, 0.04
"""m: beyond the first, full speed; within the second, drifting only; within the third, no leaving of home."""
_OVER = 0.01
"""m past the set point within which coasting may end."""
_SPEED_MAX = 0.4
"""m/s."""
_DRIFT_LEAST, _DRIFT_USED = 0.004, 0.7
"""Deceleration by the drift on the way home: its least value, m/s², and the share of the drift."""
_LONGER = 1.16
"""Factor on the stopping distance: the phase of the fins' stroke is unknown, and overshoot is worse."""
_BRAKING = 0.3
"""Share of the fins' thrust that braking against home assumes."""


class Predictive(Controller):
    """Control of the depth by a model of hull and fins that turns the fins round only where that pays.

    `HeaveObserver` learns the model, `InertialHeave` estimates the motion. Turning the fins round takes
    0.64 s and disturbs the hull. So at rest they stay on the side that holds against the drift (*home*), and
    their thrust is modulated there. On the way to the set point there are two reasons to turn them.

    To *brake* a fast hull, as late as possible: one step before turning would stop it past the set point.
    The fins stop flapping first, and pause in their turn where that brings the hull nearer.

    To *swim* away from home. The times to leave and to return come from plans on the model: some time away,
    then home, and the least sum of distances over the next 3 s, with those past the set point weighted
    (receding horizon, J. M. Maciejowski, Predictive Control with Constraints, 2002, 1.3).

    At home each distance has a goal speed: towards home the one that drift and drag stop there,
    √(a/q·(e^(2·q·distance) - 1)); against it `braking_speed`.
    """

    name = "predictive"
    title = "Model-based"
    averages = True
    needs_heave_acceleration = True
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "response": GainLimits(2.4, 0.5, 10.0, "1/s", "how fast the speed approaches its goal"),
        "approach": GainLimits(2.3, 0.2, 10.0, "1/s", "goal speed for each metre against the drift"),
        "noise": GainLimits(0.0022, 0.0005, 0.05, "m", "standard deviation of the depth that a step gets"),
        "overshoot": GainLimits(4.0, 1.0, 20.0, "", "weight of a metre past the set point"),
        "thrust": GainLimits(0.268, 0.05, 2.0, "m/s²", "acceleration by all fins at full command"),
        "drag": GainLimits(5.65, 0.5, 50.0, "1/m", "deceleration by drag for each (m/s)²"),
        "linear": GainLimits(LINEAR, 0.0, 5.0, "1/s", "deceleration by drag for each m/s"),
        "blade": GainLimits(BLADE, 0.1, 50.0, "1/m", "deceleration by all blades across, for each (m/s)²"),
        "centre": GainLimits(CENTRE, 0.011, 0.18, "m", "from a fin's shaft to the middle of its blade"),
        "drift": GainLimits(-0.01, -0.5, 0.5, "m/s²", "drift downwards that is assumed at first"),
        "lag": GainLimits(LAG, 0.0, 0.3, "s", "from a command to the water's answer to the fins"),
        "depth_age": GainLimits(AGE, 0.0, 0.5, "s", "age of a depth when it is used"),
        "acceleration_age": GainLimits(
            ACCELERATION_AGE, 0.0, 0.1, "s", "age of an acceleration when it is used"
        ),
    }

    def __init__(self) -> None:
        super().__init__()
        self.start()

    def start(self) -> None:
        """Reset the motion and the learnt model."""
        self._heave = Heave(self.gains["thrust"], self.gains["drag"], drift=self.gains["drift"])
        self._observer = HeaveObserver(self._heave)
        self._motion: Motion | None = None
        self._inertial: InertialHeave | None = None
        self._command = 0.0
        self._home = 1.0
        self._side = 0.0
        """The side to which the fins point or turn; 0 before they have been turned."""
        self._braking = False
        self._set_point: float | None = None
        self._direction = 1.0
        self._aim_past = 0.0

    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """Estimate the motion and decides; `measured` is the mean since the last step."""
        self._take_gains()
        if self._motion is None or seconds > _LOST:
            self._motion, self._side, self._inertial = Motion(measured, 0.0), 0.0, None
        elif seconds > 0:
            noise = self.gains["noise"]
            self._motion = self._observer.observe(self._motion, self._command, measured, noise, seconds)
        # The decision takes effect only after the lag.
        motion = self._observer.lead(self._refine(measured, seconds), _FINE)
        self._command = self._decide(self._find_goal(set_point, motion), motion)
        return self._command

    def _take_gains(self) -> None:
        heave, observer, gains = self._heave, self._observer, self.gains
        heave.thrust, heave.drag, heave.linear = gains["thrust"], gains["drag"], gains["linear"]
        heave.blade, heave.centre = gains["blade"], gains["centre"]
        observer.lag, observer.age = gains["lag"], gains["depth_age"]

    def _refine(self, measured: float, seconds: float) -> Motion:
        """Return the motion, corrected by the measured acceleration if there is one."""
        assert self._motion is not None
        gains = self.gains
        if self.heave_acceleration is None or seconds <= 0:
            self._inertial = None
            return self._motion
        if self._inertial is None:
            self._inertial = InertialHeave(self._motion.depth, self._motion.speed)
            return self._motion
        self._inertial.age, self._inertial.acceleration_age = gains["depth_age"], gains["acceleration_age"]
        depth, speed = self._inertial.observe(self.heave_acceleration, measured, gains["noise"], seconds)
        return self._motion._replace(depth=depth, speed=speed)

    def _find_goal(self, set_point: float, motion: Motion) -> float:
        if set_point != self._set_point:
            self._set_point, self._direction = set_point, copysign(1.0, set_point - motion.depth)
            self._aim_past = self._direction * _PAST
        if (motion.depth - set_point) * self._direction > _REACHED:
            self._aim_past = 0.0
        return set_point + self._aim_past

    def _decide(self, goal: float, motion: Motion) -> float:
        if self._heave.drift * self._home > _DRIFT_SURE:
            self._home = -self._home
        home, error = self._home, goal - motion.depth
        if not self._side:
            self._side = home if error * home > -_BESIDE else -home
        if not motion.pointing(self._side):
            self._braking = self._braking and motion.speed * self._side < 0
            return self._brake(error, motion) if self._braking else self._side * TINY
        self._braking = False
        at_home = self._side == home
        fast = motion.speed * error > 0 and abs(motion.speed) > _FAST
        if fast and motion.speed * self._side > 0 and self._overshoots(error * home, motion, at_home):
            rest = self._heave.advance(motion, 0.0, _TICK, _FINE)
            way = abs(rest.depth - motion.depth) + self._stopping_distance(rest, -self._side)
            if way + abs(motion.speed) * _TICK <= abs(error):
                return self._side
            self._side, self._braking = -self._side, True
            return 0.0
        beside = error * home > -_BESIDE and motion.speed * home < _FAST
        if not (at_home and (error * home > 0 or beside)):
            self._side = -home if self._leaving_home_pays(goal, motion, at_home) else home
        if self._side == home and error * home > _FAR:
            return home * (1.0 if motion.pointing(home) else TINY)
        return self._swim(goal, motion, self._side)

    def _overshoots(self, error: float, motion: Motion, at_home: bool) -> bool:
        """Return True if a fast hull overshoots unless the fins turn; `error` (m) counts towards home."""
        if not at_home:
            return -error > _NEAR
        return self._heave.coast(motion.speed * self._home, self._heave.drift * self._home) > error + _OVER

    def _brake(self, error: float, motion: Motion) -> float:
        """Return the command to turn on or to pause for a step: the one that stops the hull nearer."""
        error *= -self._side
        paused = self._heave.advance(motion, 0.0, _TICK, _FINE)
        later = abs(paused.depth - motion.depth) + self._stopping_distance(paused, self._side)
        pause = self._penalty(error - later) < self._penalty(
            error - self._stopping_distance(motion, self._side)
        )
        return 0.0 if pause else self._side * TINY

    def _penalty(self, error: float) -> float:
        """Return the penalty of this distance to the set point, m; below 0 the hull is past it."""
        return error if error >= 0 else -error * self.gains["overshoot"]

    def _stopping_distance(self, motion: Motion, side: float) -> float:
        """Return the stopping distance, m, of a hull whose fins turn to this side and then push fully."""
        start = motion.depth
        for _ in range(_HORIZON):
            if motion.speed * side >= 0:
                break
            command = side if motion.pointing(side) else side * TINY
            motion = self._heave.advance(motion, command, _TICK, _FINE)
        return _LONGER * abs(motion.depth - start)

    def _leaving_home_pays(self, goal: float, motion: Motion, at_home: bool) -> bool:
        """Return True if the best plan keeps the fins away from home now."""
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
        """Return the cost of a plan, the sum of its penalties: `away` ticks away from home, then at home."""
        total = 0.0
        for tick in range(_HORIZON):
            side = -self._home if tick < away else self._home
            turning = not motion.pointing(side)
            command = self._swim(goal, motion, side)
            motion = self._heave.advance(motion, command, _TICK, _FINE if turning else _COARSE)
            error = goal - motion.depth
            total += self._penalty(error * self._direction)
        return total

    def _swim(self, goal: float, motion: Motion, side: float) -> float:
        """Return the command on this side: turn there, then full thrust, or at home that of `_push`."""
        if not motion.pointing(side):
            return side * TINY
        if side != self._home:
            return side
        command = self._heave.command(self._push(goal, motion))
        return side * max(command, TINY) if command else 0.0

    def _push(self, goal: float, motion: Motion) -> float:
        """Return the push towards home (m/s²) that gives the goal speed."""
        heave, home = self._heave, self._home
        error, speed, drift = (goal - motion.depth) * home, motion.speed * home, heave.drift * home
        if error >= 0:
            braking, drag = max(-drift, _DRIFT_LEAST) * _DRIFT_USED, heave.hull * heave.drag
            goal_speed = min(sqrt(braking / drag * (exp(min(2 * drag * error, 6.0)) - 1)), _SPEED_MAX)
            # Along that curve drag alone brakes.
            return self.gains["response"] * (goal_speed - speed) - drift - braking
        braking = _BRAKING * heave.thrust * heave.strength
        goal_speed = max(braking_speed(error, braking, self.gains["approach"]), -_SPEED_MAX)
        return self.gains["response"] * (goal_speed - speed) + heave.resistance(goal_speed) - drift
