"""Buoyancy in grams: the water's density, what a craft displaces beyond its weight, and how it then rises.

Density: the one-atmosphere equation of state of seawater, EOS-80 (F. J. Millero and A. Poisson, Deep-Sea
Research 28A, 1981, 625-629; UNESCO Technical Papers in Marine Science 44, 1983). Depth adds 0.005 % in 10 m,
which is left out.
"""

from math import atan, atanh, exp, log1p, sqrt

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.limits import Range

GRAVITY = 9.81
"""m/s²"""
DENSITY = 1000.0
"""kg/m³ of the fresh water in which the fins' forces are computed: `water_density` differs by 3 % at most."""
RESERVE = 0.01
"""Share of its weight by which a trimmed craft is lighter than the water that it displaces."""
TEMPERATURE, SALINITY = Range(0, 40), Range(0, 42)
"""°C, and g of salt in 1 kg: the practical salinity. Outside of these the density is not known."""

_PURE = (999.842594, 6.793952e-2, -9.095290e-3, 1.001685e-4, -1.120083e-6, 6.536332e-9)
_SALT = (8.24493e-1, -4.0899e-3, 7.6438e-5, -8.2467e-7, 5.3875e-9)
_SALT_ROOT = (-5.72466e-3, 1.0227e-4, -1.6546e-6)
_SALT_SQUARE = 4.8314e-4


def water_density(temperature: float, salinity: float = 0.0) -> float:
    """Return kg/m³ at this temperature (°C) and practical salinity. Raise ValueError outside of their ranges.

    The equation has the temperature of 1968, which differs from today's by
    0.01 °C at most.
    """
    if not (
        TEMPERATURE.minimum <= temperature <= TEMPERATURE.maximum
        and SALINITY.minimum <= salinity <= SALINITY.maximum
    ):
        raise ValueError(f"no density of water is known at {temperature:g} °C and a salinity of {salinity:g}")
    return (
        _polynomial(_PURE, temperature)
        + _polynomial(_SALT, temperature) * salinity
        + _polynomial(_SALT_ROOT, temperature) * salinity * sqrt(salinity)
        + _SALT_SQUARE * salinity**2
    )


def buoyancy_reserve(craft: Craft, density: float) -> float:
    """Return the g by which water of this density (kg/m³) lifts the craft under water; below 0 it sinks."""
    return 1000 * (craft.volume * density - craft.mass)


def reserve_elsewhere(mass: float, reserve: float, weighed: float, density: float) -> float:
    """Return the reserve (g) in water of another density (kg/m³) than that in which it was weighed.

    The mass is in kg; the hull's own expansion is left out.
    """
    return reserve + (1000 * mass + reserve) * (density / weighed - 1)


def rise_speed(craft: Craft, reserve: float) -> float:
    """Return m/s at which a craft with this reserve (g, above 0) rises for good, with its fins at rest."""
    linear, quadratic = craft.damping_linear[2], craft.damping_quadratic[2]
    lift = reserve / 1000 * GRAVITY
    return 2 * lift / (linear + sqrt(linear**2 + 4 * quadratic * lift))


def rise_time(craft: Craft, reserve: float, distance: float) -> float:
    """Return s for which a craft with this reserve (g, above 0) rises `distance` (m) from rest.

    The speed follows m·v̇ = lift - a·v - b·v², with the water that moves along in m; b is above 0.
    """
    linear, quadratic = craft.damping_linear[2], craft.damping_quadratic[2]
    mass, lift = craft.total_mass[2], reserve / 1000 * GRAVITY
    # v + a / 2b is the speed of a hyperbolic tangent: c·tanh(kt + p), whose path is ln cosh.
    shift, limit = linear / (2 * quadratic), sqrt(lift / quadratic + (linear / (2 * quadratic)) ** 2)
    rate = quadratic * limit / mass
    phase = atanh(shift / limit)
    early, late = 0.0, 2 * distance / rise_speed(craft, reserve) + 10 / rate
    for _ in range(60):
        time = (early + late) / 2
        path = limit / rate * (_log_cosh(rate * time + phase) - _log_cosh(phase)) - shift * time
        early, late = (time, late) if path < distance else (early, time)
    return (early + late) / 2


def rest_angle(offset: float, height: float) -> float:
    """Return rad by which a hull tilts whose centre of buoyancy is `offset` off the axis, `height` (m) up."""
    return atan(offset / height)


def _polynomial(coefficients: tuple[float, ...], value: float) -> float:
    total = 0.0
    for coefficient in reversed(coefficients):
        total = total * value + coefficient
    return total


def _log_cosh(value: float) -> float:
    """Return ln cosh without its constant ln ½, and without overflow; `value` is not below 0."""
    return value + log1p(exp(-2 * value))
