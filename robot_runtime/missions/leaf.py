"""The base of every leaf: a step of a mission that does or asks one thing. docs/develop/add-a-leaf.md."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import ClassVar, Literal, Protocol, TypeVar, dataclass_transform

from robot_runtime.contract.declarations import Declarations
from robot_runtime.contract.documents import ParameterValue

Claim = Literal["depth", "heading", "course"]
"""A part of the steering that a step takes; two steps side by side must not take the same one."""
INSTANT = 0.1
"""s that a step takes which ends at once: a tick of the control loop at its default rate."""
NOTE_MAX = 200


class MissionRobot(Protocol):
    """The robot as seen by a leaf. Depths in m, angles in rad, times in s."""

    @property
    def now(self) -> float:
        """The mission's clock, which stands still while the mission is paused."""

    @property
    def depth(self) -> float:
        """The newest depth."""

    @property
    def heading(self) -> float:
        """The newest heading, -π to π."""

    @property
    def way(self) -> tuple[float, float]:
        """The way since arming by dead reckoning, m along headings 0 and 90°: an estimate."""

    @property
    def battery(self) -> float | None:
        """The battery's voltage, V; None where it is not measured."""

    @property
    def light(self) -> bool:
        """True while a detector sees the light."""

    @property
    def depth_held(self) -> float:
        """The depth that the mission holds now."""

    @property
    def heading_held(self) -> float | None:
        """The heading that the mission holds now; None where it holds none."""

    def sees(self, what: str) -> bool:
        """Return True if a fresh picture shows the colour or the marker ("marker 7"); "light" is `light`."""

    def hold_depth(self, depth: float) -> None:
        """Hold this depth from now on."""

    def hold_heading(self, heading: float | None) -> None:
        """Hold this heading from now on, or none."""

    def swim(self, x: float, yaw: float) -> None:
        """Set the course, shares of the full command; it expires, so that each tick must set it anew."""

    def swim_to_light(self) -> None:
        """Set the course to the light that the detectors see, as `swim` does."""

    def keep_still(self) -> None:
        """Rest the fins, so that it holds no depth and floats; each tick must say it anew."""

    def count_down(self, remaining: float) -> None:
        """Keep still, and show the remaining time (s) by the LED; each tick must say it anew."""

    def set_parameter(self, name: str, value: ParameterValue) -> None:
        """Set a parameter; the mission's end puts it back. Raise RefusedError."""

    def is_pending(self, name: str) -> bool:
        """Return True until the board confirms a parameter."""

    def mark(self, text: str) -> None:
        """Put a marker into the session."""

    def surface(self) -> None:
        """End the mission as a success after this tick; the fins stop, and the robot rises."""


class MissionStart(Protocol):
    """The robot's answers to a leaf before the start."""

    def check_parameter(self, name: str, value: object) -> str:
        """Return the reason why a mission cannot set this value; empty if it can."""

    def check_sight(self, what: str) -> str:
        """Return the reason why the camera cannot see this; empty if it can."""

    @property
    def battery(self) -> float | None:
        """The battery's voltage, V; None where it is not measured."""


@dataclass(kw_only=True)
class MissionNode:
    """Base of leaves and branches: a node of a mission's document with its fields; `do` is its name there."""

    do: ClassVar[str] = ""

    note: str = field(default="", metadata={"description": "a remark of the author's"})

    def __post_init__(self) -> None:
        if len(self.note) > NOTE_MAX:
            raise ValueError(f"note has more than {NOTE_MAX} characters")

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return self.do.replace("_", " ").capitalize()


class Leaf(MissionNode, ABC):
    """A step without steps below it. One instance belongs to one run of a mission.

    `begin` comes at its start, `tick` at each control tick until it ends, `resume` after a pause. It may end
    at any time without notice: the mission takes back what it steers and sets.
    """

    claims: ClassVar[frozenset[Claim]] = frozenset()
    """The parts of the steering that such a step may take."""

    @property
    def steers(self) -> frozenset[Claim]:
        """The parts of the steering that this leaf takes."""
        return self.claims

    @property
    def longest(self) -> float:
        """The longest duration (s) of the step: its `timeout` or `seconds` where it has one, and a tick."""
        for entry in fields(self):
            if entry.name in ("timeout", "seconds"):
                return float(getattr(self, entry.name)) + INSTANT
        return INSTANT

    @property
    def deepest(self) -> float:
        """The greatest depth (m) that the step asks for."""
        return 0.0

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return the expected duration (s) from this depth (m) on, and the depth at its end, for the plan.

        None: the end depends on what happens, as of a step that has a timeout, unless it says more.
        """
        names = {entry.name for entry in fields(self)}
        return (None if "timeout" in names else getattr(self, "seconds", 0.0)), depth

    def check(self, robot: MissionStart) -> str:  # noqa: ARG002 - most leaves need nothing
        """Return the reason why this robot cannot do the step; empty if it can."""
        return ""

    def begin(self, robot: MissionRobot) -> None:
        """Start the step."""

    def resume(self, robot: MissionRobot) -> None:
        """Go on after a pause, in which somebody may have moved the robot."""

    @abstractmethod
    def tick(self, robot: MissionRobot) -> bool | str:
        """Return False to go on, True when the step is done, and the reason as text when it failed."""


class Branch(MissionNode):
    """A step with steps below it."""

    least: ClassVar[int] = 1
    """Steps that it has at least."""
    most: ClassVar[int | None] = None


N = TypeVar("N", bound=MissionNode)
NODES: Declarations[str, type[MissionNode]] = Declarations("the name of a mission's node")
"""Every leaf and branch by its name in documents; the page's editor and the reference list these."""


@dataclass_transform(kw_only_default=True, field_specifiers=(field,))
def mission_node(do: str) -> Callable[[type[N]], type[N]]:
    """Make a class a leaf or a branch of documents under this name."""

    def declare(cls: type[N]) -> type[N]:
        made = dataclass(kw_only=True)(cls)
        made.do = do
        NODES.add(do, made, depth=1)
        return made

    return declare
