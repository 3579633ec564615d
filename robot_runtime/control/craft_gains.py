"""The gains of the model-based controller that follow from a craft's numbers."""

from dataclasses import replace

from robot_runtime.config import ControlConfig
from robot_runtime.contract.craft import Craft
from robot_runtime.control.controllers.predictive import Predictive


def craft_gains(craft: Craft) -> dict[str, float]:
    """Return the gains of the heave model for this craft, in the gains' units and within their limits.

    A force over the moving mass, and the noise, is the default gain times the ratio of this craft's to the
    default craft's. A delay is the default gain plus this craft's additional delay.
    """
    limits, plain = Predictive.limits, Craft()
    of_plain = _scales(plain)
    gains = {name: limits[name].default * value / of_plain[name] for name, value in _scales(craft).items()}
    gains |= {
        "lag": limits["lag"].default + craft.fin_delay - plain.fin_delay,
        "depth_age": limits["depth_age"].default + craft.pressure.latency - plain.pressure.latency,
        "acceleration_age": limits["acceleration_age"].default
        + craft.accelerometer.latency
        - plain.accelerometer.latency,
    }
    return {
        name: min(max(value, limits[name].minimum), limits[name].maximum) for name, value in gains.items()
    }


def tune_to_craft(config: ControlConfig, craft: Craft) -> ControlConfig:
    """Return the configuration with the model-based controller's gains for this craft, unless it sets them.

    The default craft changes nothing.
    """
    if craft == Craft():
        return config
    given = config.gains.get(Predictive.name, {})
    return replace(config, gains=config.gains | {Predictive.name: craft_gains(craft) | given})


def _scales(craft: Craft) -> dict[str, float]:
    """Return, by gain, the number of the craft to which it is proportional."""
    mass = craft.total_mass[2]
    return {
        "thrust": craft.thrust_coefficient * craft.fin_area * craft.fin_centre**2 / mass,
        "drag": craft.damping_quadratic[2] / mass,
        "linear": craft.damping_linear[2] / mass,
        "blade": craft.fin_normal * craft.fin_area / mass,
        "centre": craft.fin_centre,
        "drift": (1 - craft.buoyancy) * craft.mass / mass,
        "noise": craft.pressure.noise,
    }
