"""The reasons why this robot cannot do a mission now, step by step."""

from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.missions.document import MissionDocument
from robot_runtime.missions.leaf import Leaf
from robot_runtime.missions.leaves.asking import IsLeaf, WaitForLeaf
from robot_runtime.missions.senses import MissionSenses
from robot_runtime.missions.sights import find_sight_problem
from robot_runtime.parameters.registry import Registry


class _StartingRobot:
    """The robot as the steps may ask it before the start."""

    def __init__(self, senses: MissionSenses, parameters: Registry) -> None:
        self.battery = senses.battery
        self.check_sight = senses.check_sight
        self.check_parameter = parameters.find_problem


def check_start(document: MissionDocument, senses: MissionSenses, parameters: Registry) -> list[str]:
    """Returns the reasons against a start, each with the path of its step; empty if there are none."""
    robot = _StartingRobot(senses, parameters)
    reasons = []
    if document.limits.battery and robot.battery is None:
        reasons.append("limits.battery: the battery is not measured.")
    return reasons + [
        f"Step {step.place}: {problem}" if step.path else problem
        for step in document.root.walk()
        if isinstance(step.node, Leaf) and (problem := step.node.check(robot))
    ]


def check_sights(document: MissionDocument, settings: VisionSettings) -> list[str]:
    """Returns what steps wait to see and a robot with these settings cannot, each with the step's path."""
    return [
        f"Step {place}: {problem}"
        for place, sight in list_sights(document)
        if (problem := find_sight_problem(sight, settings))
    ]


def list_sights(document: MissionDocument) -> list[tuple[str, str]]:
    """Returns what steps wait to see, each with the step's path."""
    return [
        (step.place, step.node.sees)
        for step in document.root.walk()
        if isinstance(step.node, IsLeaf | WaitForLeaf) and step.node.sees is not None
    ]
