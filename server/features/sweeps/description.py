"""Parameters of a sweep in words, and a sweep to begin with."""

from collections.abc import Sequence

import tomli_w

from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.controllers.base import GainLimits
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.experiments.sweep.document import FORMAT, Sweep
from robot_runtime.experiments.sweep.parameter import SweptParameter, Value
from server.features.sweeps.schemas import SweepParameter

STEPS = 4
VARIED = 2
"""Gains that a template varies."""
UNITS = {"north": "m/s", "east": "m/s", "amplitude": "m", "period": "s", "duration": "s"}


def describe_parameters(sweep: Sweep) -> list[SweepParameter]:
    """Return the parameters of a sweep in the order of its document."""
    return [_describe(parameter) for parameter in sweep.parameters]


def gains_of(sweep: Sweep, values: Sequence[Value], controller: str) -> dict[str, float | str]:
    """Return the parameters of the robot that a variant sets: its depth controller and its varied gains.

    `controller` is the scenario's. Raise RefusedError where the sweep varies none.
    """
    set_: dict[str, float | str] = {}
    for parameter, value in zip(sweep.parameters, values, strict=True):
        match parameter.path:
            case ("control", "gains", str(kind), str(gain)) if isinstance(value, int | float):
                set_[f"depth.{kind}.{gain}"] = float(value)
            case ("control", "controller") if isinstance(value, str):
                set_["depth.controller"] = value
    if not set_:
        raise RefusedError("This sweep varies neither gains nor the controller; there is nothing to apply.")
    return {"depth.controller": controller, **set_}


def write_template(name: str, scenario: Scenario) -> str:
    """Return a sweep of a scenario to begin with: two gains of its controller, three seeds."""
    controller = next(kind for kind in CONTROLLERS["depth"] if kind.name == scenario.control.controller)
    own = scenario.control.gains.get(controller.name, {})
    vary = {}
    for gain, limits in [*controller.limits.items()][:VARIED]:
        low, high = _around(own.get(gain, limits.default), limits)
        vary[f"control.gains.{controller.name}.{gain}"] = {"from": low, "to": high, "steps": STEPS}
    head = {"format": FORMAT, "name": f"{name}_gains"[:60], "scenario": name, "seeds": 3}
    lines = [
        tomli_w.dumps(head),
        "[vary]",
        *(
            f'"{path}" = {{ from = {part["from"]:g}, to = {part["to"]:g}, steps = {part["steps"]} }}'
            for path, part in vary.items()
        ),
        "",
        "[figures]",
        'best = "rmse"',
        "",
    ]
    return "\n".join(lines)


def _around(value: float, limits: GainLimits) -> tuple[float, float]:
    """Return half and one and a half of a value, within its limits."""
    if value == 0:
        return max(limits.minimum, 0.0), limits.maximum / 2
    low, high = sorted((value / 2, value * 1.5))
    return max(low, limits.minimum), min(high, limits.maximum)


def _describe(parameter: SweptParameter) -> SweepParameter:
    limits = _gain(parameter)
    last = parameter.name.rpartition(".")[2]
    ends = [parameter.low, parameter.high]
    return SweepParameter(
        name=parameter.name,
        label=_label(parameter),
        unit=limits.unit if limits is not None else UNITS.get(last, ""),
        values=[*(parameter.values or ends)],
        kind=parameter.kind,
        by_seed=parameter.by_seed,
    )


def _label(parameter: SweptParameter) -> str:
    """Return a short name: the last part, before it the part that tells it from others."""
    parts = [part for part in parameter.name.split(".") if not part.isdecimal()]
    return " ".join(parts[-2:] if len(parts) > 2 else parts[-1:]).replace("_", " ")


def _gain(parameter: SweptParameter) -> GainLimits | None:
    match parameter.path:
        case ("control", "gains", controller, str(name)):
            kinds = (kind for kind in CONTROLLERS["depth"] if kind.name == controller)
            return next((kind.limits.get(name) for kind in kinds), None)
    return None
