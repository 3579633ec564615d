"""The leaves that move the robot."""

from dataclasses import field
from math import degrees, inf, pi
from typing import Annotated, ClassVar

from robot_runtime.contract.limits import SET_POINT, Range
from robot_runtime.contract.missions import MissionSeconds
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.missions.leaf import Claim, Leaf, MissionRobot, mission_node

STEADY = 1.0
"""s for which a value must stay near its target."""
_TIMEOUT = {"description": "after which it fails", "unit": "s"}


class Steady:
    """Tells when a value has been near its target for `STEADY` s."""

    def __init__(self) -> None:
        self._since = inf

    def see(self, near: bool, now: float) -> bool:
        """True if the value has been near for long enough at `now` (s)."""
        self._since = min(self._since, now) if near else inf
        return now - self._since >= STEADY


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
    def words(self) -> str:
        """The step in a few words, for a person."""
        return f"Dive to {self.depth:g} m"

    @property
    def deepest(self) -> float:
        """The depth."""
        return self.depth

    def begin(self, robot: MissionRobot) -> None:
        """Holds the depth from now on."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Waits for the depth anew."""
        self._steady = Steady()
        robot.hold_depth(self.depth)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Done at the depth; fails after the timeout."""
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
    def words(self) -> str:
        """The step in a few words, for a person."""
        return f"Hold the depth for {self.seconds:g} s"

    def begin(self, robot: MissionRobot) -> None:
        """Starts the time."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Goes back first, if somebody moved it."""
        self._inside = abs(robot.depth - robot.depth_held) <= self.within

    def tick(self, robot: MissionRobot) -> bool | str:
        """Done when the time is over."""
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
    def words(self) -> str:
        """The step in a few words, for a person."""
        if self.by is not None:
            return f"Turn by {degrees(self.by):.0f}°"
        return f"Turn to {degrees(self.heading or 0.0):.0f}°"

    def begin(self, robot: MissionRobot) -> None:
        """Holds the heading from now on."""
        self._began = robot.now
        self._target = self.heading if self.heading is not None else 0.0
        if self.by is not None:
            held = robot.heading_held
            self._target = wrap_angle((robot.heading if held is None else held) + self.by)
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Turns to the same heading again."""
        self._steady = Steady()
        robot.hold_heading(self._target)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Done at the heading; fails after the timeout."""
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
    def words(self) -> str:
        """The step in a few words, for a person."""
        way = "forwards" if self.x > 0 else "backwards" if self.x else "round"
        return f"Swim {way} for {self.seconds:g} s"

    def begin(self, robot: MissionRobot) -> None:
        """Starts the time."""
        self._began = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Done when the time is over."""
        if robot.now - self._began >= self.seconds:
            return True
        if self.yaw:
            robot.hold_heading(None)
        robot.swim(self.x, self.yaw)
        return False


@mission_node("to_light")
class ToLightLeaf(Leaf):
    """Swims to the light for a time. Arrival cannot be felt. It fails when no light is seen for too long."""

    claims: ClassVar[frozenset[Claim]] = frozenset({"course", "heading"})
    timeout: MissionSeconds = field(metadata={"description": "after which it is done", "unit": "s"})
    lost: MissionSeconds = field(
        default=25.0, metadata={"description": "without a light after which it fails", "unit": "s"}
    )

    @property
    def words(self) -> str:
        """The step in a few words, for a person."""
        return f"Swim to the light for {self.timeout:g} s"

    def begin(self, robot: MissionRobot) -> None:
        """Starts the time."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:
        """Searches the light anew."""
        self._seen = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Done when the time is over."""
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
        """Done at once."""
        robot.surface()
        return True
