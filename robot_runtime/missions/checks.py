"""The reasons why this robot cannot do a mission now, step by step."""

from math import ceil, floor

from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.missions.document import MissionDocument
from robot_runtime.missions.leaf import Leaf
from robot_runtime.missions.leaves.asking import IsLeaf, WaitForLeaf
from robot_runtime.missions.senses import MissionSenses
from robot_runtime.missions.sights import find_sight_problem
from robot_runtime.parameters.registry import Registry


class _StartingRobot:
    """The robot's answers to the steps before the start."""

    def __init__(self, senses: MissionSenses, parameters: Registry) -> None:
        self.battery = senses.battery
        self.check_sight = senses.check_sight
        self.check_parameter = parameters.find_problem


def check_start(document: MissionDocument, senses: MissionSenses, parameters: Registry) -> list[str]:
    """Return the reasons against a start, each with the path of its step; empty if there are none."""
    robot = _StartingRobot(senses, parameters)
    reasons = []
    if document.limits.battery and robot.battery is None:
        reasons.append("limits.battery: the battery is not measured.")
    if (left := senses.battery_left) is not None and document.longest > left:
        reasons.append(
            f"The battery lasts {floor(left / 60)} min more, and the mission may take "
            f"{ceil(document.longest / 60)} min. Charge it, or shorten the mission."
        )
    return reasons + [
        f"Step {step.number}: {problem}" if step.path else problem
        for step in document.root.walk()
        if isinstance(step.node, Leaf) and (problem := step.node.check(robot))
    ]


def check_sights(document: MissionDocument, settings: VisionSettings) -> list[str]:
    """Return the sights that steps wait for and these settings cannot find, each with the step's path."""
    return [
        f"Step {path}: {problem}"
        for path, sight in list_sights(document)
        if (problem := find_sight_problem(sight, settings))
    ]


def list_sights(document: MissionDocument) -> list[tuple[str, str]]:
    """Return the sights that steps wait for, each with the step's path."""
    return [
        (step.number, step.node.sees)
        for step in document.root.walk()
        if isinstance(step.node, IsLeaf | WaitForLeaf) and step.node.sees is not None
    ]
