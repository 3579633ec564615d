"""The leaves that move the robot."""

from dataclasses import field
from math import atan2, cos, degrees, inf, pi, sin
from typing import Annotated, ClassVar

from robot_runtime.contract.limits import SET_POINT, Range
from robot_runtime.contract.missions import MissionSeconds
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.missions.leaf import Claim, Leaf, MissionRobot, mission_node

STEADY = 1.0
"""s for which a value must stay near its target."""
LOOKAHEAD = 0.6
"""m; the point of its line that it swims to is this far ahead."""
ALIGNED = 0.8
"""rad beside its course up to which it swims forwards; farther beside it turns on the spot first."""
VERTICAL_SPEED = 0.17
"""m/s up or down of the default craft, on trials in simulated water; for plans, as the next two."""
TURN_RATE = 0.7
"""rad/s on the spot."""
FORWARD_SPEED = 0.18
"""m/s with the full command forwards."""
_TIMEOUT = {"description": "after which it fails", "unit": "s"}


class Steady:
    """Detector of a value that has been near its target for a time (s)."""

    def __init__(self, seconds: float = STEADY) -> None:
        self._seconds = seconds
        self._since = inf

    def see(self, near: bool, now: float) -> bool:
        """Return True if the value has been near for long enough at `now` (s)."""
        self._since = min(self._since, now) if near else inf
        return now - self._since >= self._seconds


@mission_node("dive")
class DiveLeaf(Leaf):
    """Goes to a depth, up or down, and stays within a distance of it for a second."""

    claims: ClassVar[frozenset[Claim]] = frozenset({"depth"})
    depth: Annotated[float, SET_POINT] = field(metadata={"unit": "m"})
    within: Annotated[float, Range(0.01, 1)] = field(
        default=0.1, metadata={"description": "distance that counts as there", "unit": "m"}
    )
    timeout: MissionSeconds = field(default=30.0, metadata=_TIMEOUT)

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Dive to {self.depth:g} m"

    @property
    def deepest(self) -> float:
        """The depth."""
        return self.depth

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return the way's duration and a steady second."""
        return abs(self.depth - depth) / VERTICAL_SPEED + STEADY, self.depth

    def begin(self, robot: MissionRobot) -> None:
        """Hold the depth from now on."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Wait for the depth anew."""
        self._steady = Steady()
        robot.hold_depth(self.depth)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True at the depth; fail after the timeout."""
        if self._steady.see(abs(robot.depth - self.depth) <= self.within, robot.now):
            return True
        if robot.now - self._began < self.timeout:
            return False
        return f"After {self.timeout:g} s it was at {robot.depth:.2f} m, not at {self.depth:g} m."


@mission_node("hold")
class HoldLeaf(Leaf):
    """Stays at the depth that it holds. It fails outside of a distance of it."""

    claims: ClassVar[frozenset[Claim]] = frozenset({"depth"})
    seconds: MissionSeconds = field(metadata={"unit": "s"})
    within: Annotated[float, Range(0.05, 10)] = field(
        default=0.5, metadata={"description": "distance beyond which it fails", "unit": "m"}
    )

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Hold the depth for {self.seconds:g} s"

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Return to the depth first, if somebody moved the robot."""
        self._inside = abs(robot.depth - robot.depth_held) <= self.within

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when the time is over."""
        inside = abs(robot.depth - robot.depth_held) <= self.within
        if self._inside and not inside:
            return f"It was at {robot.depth:.2f} m, over {self.within:g} m from {robot.depth_held:.2f} m."
        self._inside = inside
        return robot.now - self._began >= self.seconds


@mission_node("turn")
class TurnLeaf(Leaf):
    """Turns to a heading, or by an angle, and holds it. It needs one of the two.

    The fins hold a heading within 0.4 rad or so, in a limit cycle.
    """

    claims: ClassVar[frozenset[Claim]] = frozenset({"heading"})
    heading: Annotated[float | None, Range(-pi, pi)] = field(
        default=None, metadata={"description": "0 is north, positive to the east", "unit": "rad"}
    )
    by: Annotated[float | None, Range(-pi, pi)] = field(
        default=None, metadata={"description": "positive to the right", "unit": "rad"}
    )
    within: Annotated[float, Range(0.02, pi)] = field(
        default=0.5, metadata={"description": "angle that counts as there", "unit": "rad"}
    )
    timeout: MissionSeconds = field(default=20.0, metadata=_TIMEOUT)

    def __post_init__(self) -> None:
        Leaf.__post_init__(self)
        if (self.heading is None) == (self.by is None):
            raise ValueError("needs heading or by, one of the two")

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        if self.by is not None:
            return f"Turn by {degrees(self.by):.0f}°"
        return f"Turn to {degrees(self.heading or 0.0):.0f}°"

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return the turn's duration and a steady second; of a heading, of the half of a half turn."""
        angle = pi / 2 if self.by is None else abs(self.by)
        return max(angle - self.within, 0.0) / TURN_RATE + STEADY, depth

    def begin(self, robot: MissionRobot) -> None:
        """Hold the heading from now on."""
        self._began = robot.now
        self._target = self.heading if self.heading is not None else 0.0
        if self.by is not None:
            held = robot.heading_held
            self._target = wrap_angle((robot.heading if held is None else held) + self.by)
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Turn to the same heading again."""
        self._steady = Steady()
        robot.hold_heading(self._target)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True at the heading; fail after the timeout."""
        error = abs(wrap_angle(robot.heading - self._target))
        if self._steady.see(error <= self.within, robot.now):
            return True
        if robot.now - self._began < self.timeout:
            return False
        return f"After {self.timeout:g} s it was {degrees(error):.0f}° beside {degrees(self._target):.0f}°."


@mission_node("swim")
class SwimLeaf(Leaf):
    """Swims for a time. Without a turn it keeps the heading that a step before it turned to."""

    claims: ClassVar[frozenset[Claim]] = frozenset({"course", "heading"})
    x: Annotated[float, Range(-1, 1)] = field(
        default=0.0, metadata={"description": "share of the full command, forwards"}
    )
    yaw: Annotated[float, Range(-1, 1)] = field(
        default=0.0, metadata={"description": "share of the full command, to the right"}
    )
    seconds: MissionSeconds = field(metadata={"unit": "s"})

    def __post_init__(self) -> None:
        Leaf.__post_init__(self)
        if not self.x and not self.yaw:
            raise ValueError("needs x, yaw or both")

    @property
    def steers(self) -> frozenset[Claim]:
        """The course, and with a turn the heading."""
        return self.claims if self.yaw else frozenset({"course"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        way = "forwards" if self.x > 0 else "backwards" if self.x else "round"
        return f"Swim {way} for {self.seconds:g} s"

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when the time is over."""
        if robot.now - self._began >= self.seconds:
            return True
        if self.yaw:
            robot.hold_heading(None)
        robot.swim(self.x, self.yaw)
        return False


@mission_node("go")
class GoLeaf(Leaf):
    """Goes a distance on a heading by dead reckoning.

    It keeps to the line that begins where the step does. No position is measured: in a current, and with
    the time, it misses the line's end by more and more. The topic `track` has the estimate.
    """

    claims: ClassVar[frozenset[Claim]] = frozenset({"course", "heading"})
    distance: Annotated[float, Range(0.2, 50)] = field(metadata={"unit": "m"})
    heading: Annotated[float, Range(-pi, pi)] = field(
        metadata={"description": "0 is north, positive to the east", "unit": "rad"}
    )
    x: Annotated[float, Range(0.1, 1)] = field(
        default=0.5, metadata={"description": "share of the full command, forwards"}
    )
    timeout: MissionSeconds = field(metadata=_TIMEOUT)

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Go {self.distance:g} m at {degrees(self.heading):.0f}° by dead reckoning"

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return the duration of the way."""
        return self.distance / (FORWARD_SPEED * self.x), depth

    def begin(self, robot: MissionRobot) -> None:
        """Begin the line where the robot is."""
        self._began = robot.now
        self._start = robot.way

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True at the line's end; fail after the timeout."""
        north, east = (now - start for now, start in zip(robot.way, self._start, strict=True))
        along = north * cos(self.heading) + east * sin(self.heading)
        aside = east * cos(self.heading) - north * sin(self.heading)
        if along >= self.distance:
            return True
        if robot.now - self._began >= self.timeout:
            return f"After {self.timeout:g} s it had gone {along:.1f} m of {self.distance:g} m, by estimate."
        # Line-of-sight guidance (Fossen 2011, 10.3.2): towards a point of the line ahead.
        course = wrap_angle(self.heading - atan2(aside, LOOKAHEAD))
        robot.hold_heading(course)
        if abs(wrap_angle(robot.heading - course)) <= ALIGNED:
            robot.swim(self.x, 0.0)
        return False


@mission_node("to_light")
class ToLightLeaf(Leaf):
    """Swims to the light for a time.

    It cannot detect its arrival. It fails when no light is seen for too long.
    """

    claims: ClassVar[frozenset[Claim]] = frozenset({"course", "heading"})
    timeout: MissionSeconds = field(metadata={"description": "after which it is done", "unit": "s"})
    lost: MissionSeconds = field(
        default=25.0, metadata={"description": "without a light after which it fails", "unit": "s"}
    )

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Swim to the light for {self.timeout:g} s"

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return its time: it is done after it."""
        return self.timeout, depth

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Search the light anew."""
        self._seen = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when the time is over."""
        if robot.light:
            self._seen = robot.now
        if robot.now - self._began >= self.timeout:
            return True
        if robot.now - self._seen >= self.lost:
            return f"It saw no light for {self.lost:g} s."
        robot.hold_heading(None)
        robot.swim_to_light()
        return False


@mission_node("surface")
class SurfaceLeaf(Leaf):
    """STOP: ends the mission as a success. The fins stop, and the robot rises by itself."""

    claims: ClassVar[frozenset[Claim]] = frozenset({"depth", "heading", "course"})

    def tick(self, robot: MissionRobot) -> bool | str:
        """Succeed at once."""
        robot.surface()
        return True
