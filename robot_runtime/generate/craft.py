"""docs/reference/craft.md: every entry of a craft file."""

from dataclasses import fields
from typing import Any

from robot_runtime.contract.craft import Craft, SensorQuality
from robot_runtime.contract.hints import Hint, read_fields
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/contract/craft.py"
INTRODUCTION = """\
A craft file holds the physical numbers of one robot. Simulator, scenarios and the model-based controller take
it. [Identify](../use/identify.md) says how one is made and adopted.

```toml
title = "Turtle 2"
origin = "weighed on 3 March; drag and thrust fitted to sessions 12 and 14"

[craft]
mass = 2.4
buoyancy = 1.008

[craft.accelerometer]
noise = 0.021
```

An entry that is left out is the default's, also in a sensor's table. An entry that is not known, or out of
its range, is refused with its name. The file of the robot is named by `[craft] file` in `robot.toml`; without
a name it is the adopted one, `craft.toml` in the data folder, and without that the default craft. A scenario
with `craft = "robot"` has that craft's hull, and its model-based controller knows it.
"""
ORIGINS = """\
*Published* numbers are from the robot's own published code. *Assumed* ones are estimates, since nobody
published them. The spread is where the number of a real robot is expected; [identify](../use/identify.md)
replaces most of them by measured ones.

The default's numbers fit together: its hull has the volume that it must displace, its inertia is that of this
hull, and its added mass lies between those of the smallest and the largest body of this size.
"""
SENSORS = """\
Each is a table. `pressure` is in Pa, `gyroscope` in rad/s, `accelerometer` in m/s², `encoder` in rad.
"""
_ENTRIES = {
    "rate": "Hz of new readings, at most 200",
    "latency": "s from input to reading, in steps of 5 ms",
    "noise": "standard deviation of each reading, Gaussian and without memory",
    "bias": "standard deviation of the offset that is drawn at the start",
    "walk": "standard deviation of the offset's random walk after one second",
    "step": "quantization of the readings; 0: they are not rounded",
}


def craft_page() -> str:
    """Return the whole text of craft.md."""
    hints, plain = read_fields(Craft), Craft()
    numbers = [field for field in fields(Craft) if field.metadata]
    rows = [
        (
            f"`{number.name}`",
            _ranges(hints[number.name]),
            _shown(getattr(plain, number.name)),
            number.metadata["unit"],
            number.metadata["meaning"],
        )
        for number in numbers
    ]
    sensors = [field.name for field in fields(Craft) if not field.metadata]
    defaults = [
        (f"`{name}`", meaning, *(_shown(getattr(getattr(plain, sensor), name)) for sensor in sensors))
        for name, meaning in _ENTRIES.items()
    ]
    assert set(_ENTRIES) == {field.name for field in fields(SensorQuality)}
    origins = [
        (
            f"`{number.name}`",
            _shown(getattr(plain, number.name)),
            number.metadata["origin"],
            number.metadata["spread"],
        )
        for number in numbers
    ]
    return page(
        "Craft",
        SOURCE,
        INTRODUCTION,
        "## `[craft]`\n",
        table(("entry", "range", "default", "unit", "meaning"), rows),
        "## Where the numbers come from\n",
        ORIGINS,
        table(("entry", "default", "origin", "spread"), origins),
        "## Sensors\n",
        SENSORS,
        table(("entry", "meaning", *(f"`{name}`" for name in sensors)), defaults),
    )


def _ranges(hint: Hint) -> str:
    """Return the range of a number, or those of a list's numbers without repetition."""
    if hint.limits is not None:
        return f"{hint.limits.minimum:g} to {hint.limits.maximum:g}"
    return "; ".join(dict.fromkeys(map(_ranges, hint.parts)))


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_shown, value))}]"
    return f"{value:.4g}"
