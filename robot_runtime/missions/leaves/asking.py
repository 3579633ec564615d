"""The leaves that check conditions or wait for them."""

from dataclasses import field
from typing import Annotated

from robot_runtime.contract.limits import SET_POINT
from robot_runtime.contract.missions import BatteryVolts, MissionSeconds, MissionTime
from robot_runtime.missions.leaf import Leaf, MissionRobot, MissionStart, mission_node

_SIGHT = {"description": 'a colour, a marker such as "marker 7", or "light"', "kind": "sight"}


@mission_node("wait_for")
class WaitForLeaf(Leaf):
    """Waits until the last pictures show a colour or a marker, or a detector sees the light.

    How many must show it is `confirmation` of the vision settings: 2 of 3 by default.

    Of several colours in a picture the robot sees one: the target colour, else one with an action, else the
    largest. A step `set` of `vision.colour` before this one makes its colour the target.
    """

    sees: str = field(metadata=_SIGHT)
    timeout: MissionSeconds = field(
        default=60.0, metadata={"description": "after which it fails", "unit": "s"}
    )

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Wait for {self.sees}"

    def check(self, robot: MissionStart) -> str:
        """Check that the camera looks for it."""
        return robot.check_sight(self.sees)

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when it is seen; fail after the timeout."""
        if robot.sees(self.sees):
            return True
        return robot.now - self._began >= self.timeout and f"It saw no {self.sees} for {self.timeout:g} s."


@mission_node("is")
class IsLeaf(Leaf):
    """Succeeds at once if all of these hold, and fails if not. It needs one at least."""

    below: Annotated[float | None, SET_POINT] = field(
        default=None, metadata={"description": "it is deeper than this", "unit": "m"}
    )
    above: Annotated[float | None, SET_POINT] = field(
        default=None, metadata={"description": "it is less deep than this", "unit": "m"}
    )
    battery: BatteryVolts | None = field(
        default=None, metadata={"description": "the battery has this at least", "unit": "V"}
    )
    sees: str | None = field(default=None, metadata=_SIGHT)
    elapsed: MissionTime | None = field(
        default=None, metadata={"description": "of the mission, at least", "unit": "s"}
    )

    def __post_init__(self) -> None:
        Leaf.__post_init__(self)
        if not self._parts:
            raise ValueError("needs below, above, battery, sees or elapsed")

    @property
    def _parts(self) -> list[str]:
        parts = [] if self.below is None else [f"below {self.below:g} m"]
        parts += [] if self.above is None else [f"above {self.above:g} m"]
        parts += [] if self.battery is None else [f"battery at {self.battery:g} V"]
        parts += [] if self.sees is None else [f"sees {self.sees}"]
        return parts + ([] if self.elapsed is None else [f"after {self.elapsed:g} s"])

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        text = ", ".join(self._parts)
        return text[0].upper() + text[1:]

    def check(self, robot: MissionStart) -> str:
        """Check that the camera looks for it, and that the battery is measured."""
        if self.battery is not None and robot.battery is None:
            return "The battery is not measured."
        return "" if self.sees is None else robot.check_sight(self.sees)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Succeed or fail at once."""
        if self.below is not None and robot.depth <= self.below:
            return f"It was at {robot.depth:.2f} m, not below {self.below:g} m."
        if self.above is not None and robot.depth >= self.above:
            return f"It was at {robot.depth:.2f} m, not above {self.above:g} m."
        if self.battery is not None and (robot.battery or 0.0) < self.battery:
            return f"The battery had {robot.battery or 0.0:.2f} V, under {self.battery:g} V."
        if self.sees is not None and not robot.sees(self.sees):
            return f"It saw no {self.sees}."
        if self.elapsed is not None and robot.now < self.elapsed:
            return f"{robot.now:.0f} s had passed, not {self.elapsed:g} s."
        return True
