"""The leaves that change a setting or the recording."""

from dataclasses import field

from robot_runtime.contract.documents import ParameterValue
from robot_runtime.errors import RefusedError
from robot_runtime.missions.leaf import Leaf, MissionRobot, MissionStart, mission_node

CONFIRMED_WITHIN = 5.0
"""s within which the board confirms a parameter."""
TEXT_MAX = 200


@mission_node("set")
class SetLeaf(Leaf):
    """Sets a parameter that may change while the robot is armed. The mission's end puts it back."""

    parameter: str = field(metadata={"description": "its name", "kind": "parameter"})
    value: ParameterValue = field(metadata={"description": "in the parameter's unit"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Set {self.parameter} to {self.value}"

    @property
    def longest(self) -> float:
        """The time (s) within which the board must confirm."""
        return CONFIRMED_WITHIN

    def check(self, robot: MissionStart) -> str:
        """Check that the parameter exists, takes the value, and may change while armed."""
        return robot.check_parameter(self.parameter, self.value)

    def begin(self, robot: MissionRobot) -> None:
        """Set the parameter."""
        self._began, self._problem = robot.now, ""
        try:
            robot.set_parameter(self.parameter, self.value)
        except RefusedError as problem:
            self._problem = str(problem)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when the value is confirmed."""
        if self._problem:
            return self._problem
        if not robot.is_pending(self.parameter):
            return True
        late = robot.now - self._began >= CONFIRMED_WITHIN
        return late and f"The board did not confirm it within {CONFIRMED_WITHIN:g} s."


@mission_node("mark")
class MarkLeaf(Leaf):
    """Puts a marker into the session."""

    text: str

    def __post_init__(self) -> None:
        Leaf.__post_init__(self)
        if not 1 <= len(self.text.strip()) <= TEXT_MAX or not self.text.isprintable():
            raise ValueError(f"text has 1 to {TEXT_MAX} characters, all of which can be printed")

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Mark “{self.text}”"

    def tick(self, robot: MissionRobot) -> bool | str:
        """Succeed at once."""
        robot.mark(self.text)
        return True
