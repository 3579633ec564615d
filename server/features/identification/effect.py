"""The effects of adopting another craft, in words."""

from dataclasses import fields

from robot_runtime.contract.craft import Craft
from robot_runtime.control.craft_gains import craft_gains


def describe_effect(before: Craft, after: Craft) -> list[str]:
    """The effects of another craft, in words."""
    if before == after:
        return ["Nothing: it is the craft in force."]
    changed = [
        one.name.replace("_", " ")
        for one in fields(Craft)
        if getattr(before, one.name) != getattr(after, one.name)
    ]
    old, new = craft_gains(before), craft_gains(after)
    return [
        f"The simulated robot swims with other numbers: {', '.join(changed)}.",
        'Scenarios with craft = "robot" take them.',
        f"The model-based controller's thrust is {new['thrust']:.3g} m/s² instead of {old['thrust']:.3g}, "
        f"its drag {new['drag']:.3g} 1/m instead of {old['drag']:.3g}, unless robot.toml sets them.",
    ]
