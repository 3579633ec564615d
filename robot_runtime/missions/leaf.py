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
    """The robot as a leaf sees it. Depths in m, angles in rad, times in s."""

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
    def battery(self) -> float | None:
        """V; None where it is not measured."""

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
        """True if a fresh picture shows the colour or the marker ("marker 7"), or for "light" as `light`."""

    def hold_depth(self, depth: float) -> None:
        """Holds this depth from now on."""

    def hold_heading(self, heading: float | None) -> None:
        """Holds this heading from now on, or none."""

    def swim(self, x: float, yaw: float) -> None:
        """Sets the course, shares of the full command; it expires, so that each tick must set it anew."""

    def swim_to_light(self) -> None:
        """Sets the course to the light that the detectors see, as `swim` does."""

    def set_parameter(self, name: str, value: ParameterValue) -> None:
        """Sets a parameter; the mission's end puts it back. Raises RefusedError."""

    def is_pending(self, name: str) -> bool:
        """True until the board confirms a parameter."""

    def mark(self, text: str) -> None:
        """Puts a marker into the session."""

    def surface(self) -> None:
        """Ends the mission as a success after this tick; the fins stop, and the robot rises."""


class MissionStart(Protocol):
    """The robot as a leaf may ask it before the start."""

    def check_parameter(self, name: str, value: object) -> str:
        """The reason why a mission cannot set this value; empty if it can."""

    def check_sight(self, what: str) -> str:
        """The reason why the camera cannot see this; empty if it can."""

    @property
    def battery(self) -> float | None:
        """V; None where it is not measured."""


@dataclass(kw_only=True)
class MissionNode:
    """Base of leaves and branches: a node of a mission's document with its fields; `do` is its name there."""

    do: ClassVar[str] = ""

    note: str = field(default="", metadata={"description": "a remark of the author's"})

    def __post_init__(self) -> None:
        if len(self.note) > NOTE_MAX:
            raise ValueError(f"note has more than {NOTE_MAX} characters")

    @property
    def words(self) -> str:
        """The step in a few words, for a person."""
        return self.do.replace("_", " ").capitalize()


class Leaf(MissionNode, ABC):
    """A step without steps below it. One instance belongs to one run of a mission.

    `begin` comes at its start, `tick` at each control tick until it ends, `resume` after a pause. It may end
    at any time without a word: what it steers and sets is taken back by the mission.
    """

    claims: ClassVar[frozenset[Claim]] = frozenset()
    """The parts of the steering that such a step may take."""

    @property
    def steers(self) -> frozenset[Claim]:
        """Those that this one takes."""
        return self.claims

    @property
    def longest(self) -> float:
        """s that the step takes at most; its `timeout` or `seconds` where it has one, and a tick."""
        for one in fields(self):
            if one.name in ("timeout", "seconds"):
                return float(getattr(self, one.name)) + INSTANT
        return INSTANT

    @property
    def deepest(self) -> float:
        """m; the greatest depth that the step asks for."""
        return 0.0

    def check(self, robot: MissionStart) -> str:  # noqa: ARG002 - most leaves need nothing
        """The reason why this robot cannot do the step; empty if it can."""
        return ""

    def begin(self, robot: MissionRobot) -> None:
        """Starts the step."""

    def resume(self, robot: MissionRobot) -> None:
        """Goes on after a pause, in which somebody may have moved the robot."""

    @abstractmethod
    def tick(self, robot: MissionRobot) -> bool | str:
        """Goes on: False. The step is done: True. It failed: a text with the reason."""


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
    """Makes a class a leaf or a branch of documents under this name."""

    def declare(cls: type[N]) -> type[N]:
        made = dataclass(kw_only=True)(cls)
        made.do = do
        NODES.add(do, made, depth=1)
        return made

    return declare
