"""The tree of a running mission, made of py_trees: composites and decorators are its own, timers ours.

This is the only module that loads py_trees (BSD-3), and it is loaded with the first mission: it takes about
2 s on a small Pi. Its timers and its blackboard read the wall clock and are global, so neither is used.
"""

from collections.abc import Iterable

from py_trees.behaviour import Behaviour
from py_trees.common import ParallelPolicy, Status
from py_trees.composites import Parallel, Selector, Sequence
from py_trees.decorators import Decorator, FailureIsSuccess, Inverter, Repeat

from robot_runtime.contract.missions import MissionStatus
from robot_runtime.missions.branches import (
    AllBranch,
    FirstOfBranch,
    InvertBranch,
    RaceBranch,
    RepeatBranch,
    TimeoutBranch,
    TryBranch,
    UntilBranch,
    WhileTrueBranch,
)
from robot_runtime.missions.document import MissionStep, is_condition
from robot_runtime.missions.leaf import Leaf, MissionRobot

UNTIL_PERIOD = 1.0
"""s between two starts of the steps of an `until`, at least."""
_STATUS: dict[Status, MissionStatus] = {
    Status.SUCCESS: "done",
    Status.FAILURE: "failed",
    Status.RUNNING: "running",
}


class LeafBehaviour(Behaviour):
    """A leaf as a behaviour; `text` says why it failed."""

    def __init__(self, leaf: Leaf, robot: MissionRobot) -> None:
        super().__init__(leaf.do)
        self.text = ""
        self._leaf = leaf
        self._robot = robot
        self._skipped = False

    def skip(self) -> None:
        """Has the running leaf succeed at the next tick."""
        self._skipped = self.status == Status.RUNNING

    def resume(self) -> None:
        """Has the running leaf go on after a pause."""
        if self.status == Status.RUNNING:
            self._leaf.resume(self._robot)

    def initialise(self) -> None:
        """Begins the leaf."""
        self.text, self._skipped = "", False
        self._leaf.begin(self._robot)

    def update(self) -> Status:
        """Ticks the leaf."""
        if self._skipped:
            self.text = "It was skipped."
            return Status.SUCCESS
        outcome = self._leaf.tick(self._robot)
        if isinstance(outcome, str):
            self.text = outcome
            return Status.FAILURE
        return Status.SUCCESS if outcome else Status.RUNNING


class InvertBehaviour(Inverter):
    """Fails where the child succeeds, and the other way round."""

    def __init__(self, child: Behaviour) -> None:
        super().__init__("invert", child)
        self.text = ""

    def update(self) -> Status:
        """The other status than the child's."""
        status = super().update()
        self.text = "Its step succeeded." if status == Status.FAILURE else ""
        return status


class TimeoutBehaviour(Decorator):
    """Fails after `seconds` of the mission's clock."""

    def __init__(self, child: Behaviour, seconds: float, robot: MissionRobot) -> None:
        super().__init__("timeout", child)
        self.text = ""
        self._seconds = seconds
        self._robot = robot

    def initialise(self) -> None:
        """Starts the time."""
        self._until, self.text = self._robot.now + self._seconds, ""

    def update(self) -> Status:
        """The child's status, or a failure."""
        if self.decorated.status == Status.RUNNING and self._robot.now >= self._until:
            self.text = f"It was not done after {self._seconds:g} s."
            return Status.FAILURE
        return self.decorated.status


class UntilBehaviour(Behaviour):
    """Ticks its body until the condition holds; begins the body anew once a period at most."""

    def __init__(self, condition: Behaviour, body: Behaviour, seconds: float, robot: MissionRobot) -> None:
        super().__init__("until")
        self.text = ""
        self._condition, self._body = condition, body
        self._seconds = seconds
        self._robot = robot
        self.children = [condition, body]

    def initialise(self) -> None:
        """Starts the time."""
        self.text = ""
        self._until = self._robot.now + self._seconds
        self._next = self._robot.now

    def update(self) -> Status:
        """Success when the condition holds; a failure of the body, or after the time."""
        self._condition.tick_once()
        if self._condition.status == Status.SUCCESS:
            return Status.SUCCESS
        if self._robot.now >= self._until:
            self.text = f"The condition did not hold within {self._seconds:g} s."
            return Status.FAILURE
        if self._body.status == Status.RUNNING or self._robot.now >= self._next:
            if self._body.status != Status.RUNNING:
                self._next = self._robot.now + UNTIL_PERIOD
            self._body.tick_once()
        return Status.FAILURE if self._body.status == Status.FAILURE else Status.RUNNING

    def terminate(self, new_status: Status) -> None:
        """Stops the body with this step. Where this one is to begin anew, its steps forget their ends."""
        if new_status == Status.INVALID:
            for one in self.children:
                one.stop(new_status)
        elif self._body.status == Status.RUNNING:
            self._body.stop(Status.INVALID)


class MissionTree:
    """The tree of one run. `behaviours` are those of the document's steps, in its order."""

    def __init__(self, root: MissionStep, robot: MissionRobot) -> None:
        self._robot = robot
        self.behaviours: dict[tuple[int, ...], Behaviour] = {}
        self._root = self._make(root)
        self._repeats = [one for one in self.behaviours.values() if isinstance(one, Repeat)]

    def tick(self) -> MissionStatus:
        """Ticks the tree once; returns the status of its root."""
        self._root.tick_once()
        return _STATUS[self._root.status]

    def stop(self) -> None:
        """Ends all running leaves."""
        self._root.stop(Status.INVALID)

    def skip(self) -> None:
        """Has the running leaves succeed."""
        for leaf in self._leaves:
            leaf.skip()

    def resume(self) -> None:
        """Has the running leaves go on after a pause."""
        for leaf in self._leaves:
            leaf.resume()

    def status(self, path: tuple[int, ...]) -> MissionStatus:
        """The status of a step."""
        return _STATUS.get(self.behaviours[path].status, "waiting")

    def rounds(self, path: tuple[int, ...]) -> int:
        """The number of times that a `repeat` has done its steps."""
        behaviour = self.behaviours[path]
        return behaviour.success if isinstance(behaviour, Repeat) else 0

    @property
    def all_rounds(self) -> list[int]:
        """The rounds of each `repeat`."""
        return [one.success for one in self._repeats]

    def text(self, path: tuple[int, ...]) -> str:
        """The reason why a step failed, where it says so itself."""
        return str(getattr(self.behaviours[path], "text", ""))

    @property
    def _leaves(self) -> Iterable[LeafBehaviour]:
        return [one for one in self.behaviours.values() if isinstance(one, LeafBehaviour)]

    def _make(self, step: MissionStep) -> Behaviour:
        made = self._make_node(step)
        self.behaviours[step.path] = made
        return made

    def _make_node(self, step: MissionStep) -> Behaviour:
        node = step.node
        if isinstance(node, Leaf):
            return LeafBehaviour(node, self._robot)
        steps = [self._make(one) for one in step.steps]
        match node:
            case FirstOfBranch():
                return Selector("first_of", memory=True, children=steps)
            case WhileTrueBranch():
                # What is done goes on where it was; the conditions before it are asked anew.
                count = next(i for i, one in enumerate(steps) if not is_condition(step.steps[i]))
                return Sequence("while", memory=False, children=[*steps[:count], _in_order(steps[count:])])
            case AllBranch():
                return Parallel("all", ParallelPolicy.SuccessOnAll(synchronise=True), steps)
            case RaceBranch():
                return Parallel("race", ParallelPolicy.SuccessOnOne(), steps)
            case RepeatBranch(times=times):
                return Repeat("repeat", _in_order(steps), times)
            case UntilBranch(timeout=seconds):
                return UntilBehaviour(steps[0], _in_order(steps[1:]), seconds, self._robot)
            case TryBranch():
                return FailureIsSuccess("try", _in_order(steps))
            case InvertBranch():
                return InvertBehaviour(steps[0])
            case TimeoutBranch(seconds=seconds):
                return TimeoutBehaviour(_in_order(steps), seconds, self._robot)
        return _in_order(steps)


def _in_order(steps: list[Behaviour]) -> Behaviour:
    return Sequence("sequence", memory=True, children=steps)
