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
        """Have the running leaf succeed at the next tick."""
        self._skipped = self.status == Status.RUNNING

    def resume(self) -> None:
        """Have the running leaf go on after a pause."""
        if self.status == Status.RUNNING:
            self._leaf.resume(self._robot)

    def initialise(self) -> None:
        """Begin the leaf."""
        self.text, self._skipped = "", False
        self._leaf.begin(self._robot)

    def update(self) -> Status:
        """Tick the leaf."""
        if self._skipped:
            self.text = "It was skipped."
            return Status.SUCCESS
        outcome = self._leaf.tick(self._robot)
        if isinstance(outcome, str):
            self.text = outcome
            return Status.FAILURE
        return Status.SUCCESS if outcome else Status.RUNNING


class InvertBehaviour(Inverter):
    """A behaviour that fails where the child succeeds, and the other way round."""

    def __init__(self, child: Behaviour) -> None:
        super().__init__("invert", child)
        self.text = ""

    def update(self) -> Status:
        """Return the opposite of the child's status."""
        status = super().update()
        self.text = "Its step succeeded." if status == Status.FAILURE else ""
        return status


class TimeoutBehaviour(Decorator):
    """A behaviour that fails after `seconds` of the mission's clock."""

    def __init__(self, child: Behaviour, seconds: float, robot: MissionRobot) -> None:
        super().__init__("timeout", child)
        self.text = ""
        self._seconds = seconds
        self._robot = robot

    def initialise(self) -> None:
        """Start the time."""
        self._until, self.text = self._robot.now + self._seconds, ""

    def update(self) -> Status:
        """Return the child's status, or a failure."""
        if self.decorated.status == Status.RUNNING and self._robot.now >= self._until:
            self.text = f"It was not done after {self._seconds:g} s."
            return Status.FAILURE
        return self.decorated.status


class UntilBehaviour(Behaviour):
    """A behaviour that repeats its body until the condition holds, once a period at most."""

    def __init__(self, condition: Behaviour, body: Behaviour, seconds: float, robot: MissionRobot) -> None:
        super().__init__("until")
        self.text = ""
        self._condition, self._body = condition, body
        self._seconds = seconds
        self._robot = robot
        self.children = [condition, body]

    def initialise(self) -> None:
        """Start the time."""
        self.text = ""
        self._until = self._robot.now + self._seconds
        self._next = self._robot.now

    def update(self) -> Status:
        """Succeed when the condition holds; fail with the body, or after the time."""
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
        """Stop the body with this step. Where this step begins anew, its steps forget how they ended."""
        if new_status == Status.INVALID:
            for child in self.children:
                child.stop(new_status)
        elif self._body.status == Status.RUNNING:
            self._body.stop(Status.INVALID)


class MissionTree:
    """The tree of one run. `behaviours` are those of the document's steps, in its order."""

    def __init__(self, root: MissionStep, robot: MissionRobot) -> None:
        self._robot = robot
        self.behaviours: dict[tuple[int, ...], Behaviour] = {}
        self._root = self._make(root)
        self._repeats = [behaviour for behaviour in self.behaviours.values() if isinstance(behaviour, Repeat)]

    def tick(self) -> MissionStatus:
        """Tick the tree once; return the status of its root."""
        self._root.tick_once()
        return _STATUS[self._root.status]

    def stop(self) -> None:
        """End all running leaves."""
        self._root.stop(Status.INVALID)

    def skip(self) -> None:
        """Have the running leaves succeed."""
        for leaf in self._leaves:
            leaf.skip()

    def resume(self) -> None:
        """Have the running leaves go on after a pause."""
        for leaf in self._leaves:
            leaf.resume()

    def status(self, path: tuple[int, ...]) -> MissionStatus:
        """Return the status of a step."""
        return _STATUS.get(self.behaviours[path].status, "waiting")

    def rounds(self, path: tuple[int, ...]) -> int:
        """Return the number of times that a `repeat` has done its steps."""
        behaviour = self.behaviours[path]
        return behaviour.success if isinstance(behaviour, Repeat) else 0

    @property
    def all_rounds(self) -> list[int]:
        """The rounds of each `repeat`."""
        return [repeat.success for repeat in self._repeats]

    def text(self, path: tuple[int, ...]) -> str:
        """Return the reason of a step's failure; empty where the step gives none."""
        return str(getattr(self.behaviours[path], "text", ""))

    @property
    def _leaves(self) -> Iterable[LeafBehaviour]:
        return [behaviour for behaviour in self.behaviours.values() if isinstance(behaviour, LeafBehaviour)]

    def _make(self, step: MissionStep) -> Behaviour:
        made = self._make_node(step)
        self.behaviours[step.path] = made
        return made

    def _make_node(self, step: MissionStep) -> Behaviour:
        node = step.node
        if isinstance(node, Leaf):
            return LeafBehaviour(node, self._robot)
        steps = [self._make(child) for child in step.steps]
        match node:
            case FirstOfBranch():
                return Selector("first_of", memory=True, children=steps)
            case WhileTrueBranch():
                # What is done goes on where it was; the conditions before it are asked anew.
                count = next(i for i, _ in enumerate(steps) if not is_condition(step.steps[i]))
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
