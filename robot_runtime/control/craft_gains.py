"""The gains of the model-based controller that follow from a craft's numbers."""

from dataclasses import replace

from robot_runtime.config import ControlConfig
from robot_runtime.contract.craft import Craft
from robot_runtime.control.controllers.predictive import Predictive


def craft_gains(craft: Craft) -> dict[str, float]:
    """Returns thrust (m/s²) and drag (1/m) of the heave model of this craft, within the gains' limits.

    Drag is the quadratic damping over the moving mass. Thrust is the default's, times the ratio of the two
    crafts' C_T·S·r_c² over the moving mass: strokes are the same.
    """
    limits = Predictive.limits
    gains = {
        "thrust": limits["thrust"].default * _push(craft) / _push(Craft()),
        "drag": craft.damping_quadratic[2] / craft.total_mass[2],
    }
    return {
        name: min(max(value, limits[name].minimum), limits[name].maximum) for name, value in gains.items()
    }


def tune_to_craft(config: ControlConfig, craft: Craft) -> ControlConfig:
    """Returns the configuration with the model-based controller's gains for this craft, unless it sets them.

    The default craft changes nothing.
    """
    if craft == Craft():
        return config
    given = config.gains.get(Predictive.name, {})
    return replace(config, gains=config.gains | {Predictive.name: craft_gains(craft) | given})


def _push(craft: Craft) -> float:
    return craft.thrust_coefficient * craft.fin_area * craft.fin_centre**2 / craft.total_mass[2]
