"""The branches: how steps follow each other. `robot_runtime.missions.tree` makes py_trees of them."""

from dataclasses import field
from typing import Annotated

from robot_runtime.contract.limits import Range
from robot_runtime.contract.missions import MissionSeconds
from robot_runtime.missions.leaf import Branch, mission_node

Times = Annotated[int, Range(1, 1000)]


@mission_node("sequence")
class SequenceBranch(Branch):
    """One step after the other. It fails with the first that fails."""


@mission_node("first_of")
class FirstOfBranch(Branch):
    """One step after the other until one succeeds. It fails when all failed."""

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return "First that succeeds of"


@mission_node("while_true")
class WhileTrueBranch(Branch):
    """Checks its leading conditions at every tick, and does the other steps meanwhile.

    Conditions are steps `is`, or an `invert` of one. When one fails, the running step is stopped and this
    step fails.
    """

    least = 2

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return "While"


@mission_node("all")
class AllBranch(Branch):
    """All steps side by side until all succeeded. It fails with the first that fails."""

    least = 2

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return "All side by side"


@mission_node("race")
class RaceBranch(Branch):
    """All steps side by side until the first ends. It ends with that step's status, and stops the others."""

    least = 2


@mission_node("repeat")
class RepeatBranch(Branch):
    """Its steps in a sequence, again and again. It fails with the first that fails."""

    times: Times

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Repeat {self.times} times"


@mission_node("until")
class UntilBranch(Branch):
    """Repeats its steps until its first one, a condition, holds, once a second at most.

    It fails with a step that fails, or after the timeout.
    """

    least = 2
    timeout: MissionSeconds = field(metadata={"description": "after which it fails", "unit": "s"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return "Repeat until"


@mission_node("try")
class TryBranch(Branch):
    """Its steps in a sequence; it succeeds even when a step fails, which ends them."""


@mission_node("invert")
class InvertBranch(Branch):
    """Fails where its step succeeds, and the other way round."""

    most = 1

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return "Not"


@mission_node("timeout")
class TimeoutBranch(Branch):
    """Its steps in a sequence. It fails after the time, which stops them."""

    seconds: MissionSeconds = field(metadata={"description": "after which it fails", "unit": "s"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"At most {self.seconds:g} s"


@mission_node("call")
class CallBranch(Branch):
    """The steps of another mission of the library; the limits that it names apply too."""

    least = most = 0
    mission: str = field(metadata={"description": "its name"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Mission {self.mission}"
