"""A pack of two lithium cells: its voltage at rest by its charge, and back.

The curve is that of M. Chen and G. A. Rincón-Mora, Accurate electrical battery model capable of predicting
runtime and I-V performance, IEEE Transactions on Energy Conversion 21 (2), 2006, 504-511, for one cell of
lithium cobalt oxide. Cells with nickel (such as NCR18650B) have more charge than these at the same voltage
in the middle of their discharge, so that a time computed by this curve is too short for them.
"""

from math import exp

from robot_runtime.contract.power_budget import CELL_CAPACITY, CELL_VOLTS, CELLS

CAPACITY = CELL_CAPACITY
"""Ah of the reference robot's pack."""


def resting_voltage(charge: float) -> float:
    """Return the V of a pack at rest that has this share of its charge, 0 to 1."""
    rising = 0.2156 * charge - 0.1178 * charge**2 + 0.3201 * charge**3
    return CELLS * (3.685 - 1.031 * exp(-35 * charge) + rising)


def charge_at(volts: float) -> float:
    """Return the share of its charge, 0 to 1, that a pack with this voltage at rest has."""
    low, high = 0.0, 1.0
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if resting_voltage(middle) < volts else (low, middle)
    return (low + high) / 2


def seconds_left(volts: float, alarm: float, capacity: float, power: float) -> float:
    """Return s for which a pack of `capacity` (Ah) at `volts` feeds `power` (W) until it is at `alarm` (V).

    Both voltages are under load. What the load takes from them then cancels out at the end.
    """
    share = max(charge_at(volts) - charge_at(alarm), 0.0)
    return share * capacity * CELLS * CELL_VOLTS / power * 3600
