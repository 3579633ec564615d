"""docs/reference/craft.md: every entry of a craft file."""

from dataclasses import fields
from typing import Any

from robot_runtime.contract.craft import Craft, SensorQuality
from robot_runtime.contract.hints import Hint, read_fields
from robot_runtime.generate.markdown import fill, page, table

SOURCE = "robot_runtime/contract/craft.py"
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
        (f"`{number.name}`", number.metadata["origin"], number.metadata["spread"]) for number in numbers
    ]
    return page(
        "Craft",
        SOURCE,
        fill(
            "craft",
            entries=table(("entry", "range", "default", "unit", "meaning"), rows),
            origins=table(("entry", "origin of the default", "spread"), origins),
            sensors=table(("entry", "meaning", *(f"`{name}`" for name in sensors)), defaults),
        ),
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
