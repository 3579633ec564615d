"""The leaves that wait with still fins: the robot floats, or lies where it was put."""

from dataclasses import field
from typing import Annotated, ClassVar

from robot_runtime.contract.limits import Range
from robot_runtime.contract.missions import WET_DEPTH, MissionSeconds
from robot_runtime.missions.leaf import Claim, Leaf, MissionRobot, mission_node
from robot_runtime.missions.leaves.moving import Steady

WET_FOR = 2.0
"""s at `WET_DEPTH` or deeper."""
COUNTDOWN = Range(3, 20)
"""s of a countdown: its last three seconds are shown one by one."""
RISE_SPEED = 0.03
"""m/s of the default craft with still fins, on trials in simulated water; for plans."""
_ALL: frozenset[Claim] = frozenset({"course", "depth", "heading"})


@mission_node("wait")
class WaitLeaf(Leaf):
    """Waits with still fins. Under water it rises meanwhile; `hold` stays at a depth."""

    claims: ClassVar[frozenset[Claim]] = _ALL
    seconds: MissionSeconds = field(metadata={"unit": "s"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Wait for {self.seconds:g} s"

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return its time, and the depth to which it rises meanwhile."""
        return self.seconds, max(depth - RISE_SPEED * self.seconds, 0.0)

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when the time is over."""
        robot.keep_still()
        return robot.now - self._began >= self.seconds


@mission_node("count_down")
class CountDownLeaf(Leaf):
    """Counts down with the LED and still fins: two blinks a second, a long one for each of the last three."""

    claims: ClassVar[frozenset[Claim]] = _ALL
    seconds: Annotated[float, COUNTDOWN] = field(default=5.0, metadata={"unit": "s"})

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return f"Count down {self.seconds:g} s with the LED"

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return its time, and the depth to which it rises meanwhile."""
        return self.seconds, max(depth - RISE_SPEED * self.seconds, 0.0)

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when the time is over."""
        remaining = self.seconds - (robot.now - self._began)
        robot.count_down(max(remaining, 0.0))
        return remaining <= 0.0


@mission_node("wait_until_wet")
class WaitUntilWetLeaf(Leaf):
    """Waits with still fins until somebody holds the robot under water, 0.1 m deep for 2 s.

    As the first step it starts the dive on immersion: the mission is begun at the bench, and swims when it
    is in the water.
    """

    claims: ClassVar[frozenset[Claim]] = _ALL
    timeout: MissionSeconds = field(
        default=600.0, metadata={"description": "after which it fails", "unit": "s"}
    )

    @property
    def label(self) -> str:
        """The step in a few words, for a person."""
        return "Wait until it is wet"

    def estimate(self, depth: float) -> tuple[float | None, float]:
        """Return no time: somebody holds it under water, at the depth that counts as wet."""
        return None, max(depth, WET_DEPTH)

    def begin(self, robot: MissionRobot) -> None:
        """Start the time."""
        self._began = robot.now
        self.resume(robot)

    def resume(self, robot: MissionRobot) -> None:  # noqa: ARG002 - as of every leaf
        """Wait for the water anew."""
        self._wet = Steady(WET_FOR)

    def tick(self, robot: MissionRobot) -> bool | str:
        """Return True when it is wet; fail after the timeout."""
        robot.keep_still()
        if self._wet.see(robot.depth >= WET_DEPTH, robot.now):
            return True
        return (
            robot.now - self._began >= self.timeout and f"It was not under water within {self.timeout:g} s."
        )
