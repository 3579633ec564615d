"""The effects of adopting another craft, as text."""

from dataclasses import fields

from robot_runtime.contract.craft import Craft
from robot_runtime.control.controllers.predictive import Predictive
from robot_runtime.control.craft_gains import craft_gains


def describe_effect(before: Craft, after: Craft) -> list[str]:
    """Return the effects of another craft as text."""
    if before == after:
        return ["Nothing: it is the craft in force."]
    changed = [
        field.name.replace("_", " ")
        for field in fields(Craft)
        if getattr(before, field.name) != getattr(after, field.name)
    ]
    return [
        f"The simulated robot swims with other numbers: {', '.join(changed)}.",
        'Scenarios with craft = "robot" take them.',
        _describe_controller(craft_gains(before), craft_gains(after)),
    ]


def _describe_controller(before: dict[str, float], after: dict[str, float]) -> str:
    numbers = {name: (_shown(before[name]), _shown(value)) for name, value in after.items()}
    changed = [
        f"{name.replace('_', ' ')} {new} instead of {old} {Predictive.limits[name].unit}"
        for name, (old, new) in numbers.items()
        if new != old
    ]
    if not changed:
        return "The model-based controller stays as it is."
    return f"The model-based controller has {', '.join(changed)}, unless robot.toml sets them."


def _shown(value: float) -> str:
    return f"{value:.3g}"
