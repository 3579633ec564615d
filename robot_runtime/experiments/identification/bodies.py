"""Many hulls at once in calm, unbounded water: the equations of `simulation/water` on arrays.

A fit needs hundreds of motions that differ little. One step of all of them together costs as much as a few of
the simulator's. A test compares every term with `Body` and `Fins`. Arrays have the shape (variants, windows),
most with an axis of components before it. Steady currents make no difference: all motion here is relative to
the water.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.buoyancy import DENSITY, GRAVITY
from robot_runtime.contract.craft import Craft

Floats = NDArray[np.float64]

STATES = 9
"""Depth (m); velocity forward, right, down (m/s); roll and pitch (rad); turn rates (rad/s)."""
CHANNELS = 7
"""Measured: depth of the sensor (m), turn rates (rad/s), specific forces (m/s²)."""


@dataclass(frozen=True, slots=True)
class FinMotions:
    """The fins at every half step: angles (rad) and speeds (rad/s), of shape (half steps, fins, windows)."""

    angles: Floats
    speeds: Floats


class _FinGeometry:
    """The fins' geometry that the hull's motion does not change, for every half step."""

    def __init__(self, craft: Craft, motions: Sequence[FinMotions]) -> None:
        angles = np.stack([motion.angles for motion in motions], axis=2)
        speeds = np.stack([motion.speeds for motion in motions], axis=2)
        roots, out = np.array(craft.fin_positions), np.array(craft.fin_directions)
        centre = craft.fin_centre

        def column(values: Floats) -> Floats:
            return values[:, None, None]

        along, down = np.cos(angles), np.sin(angles)
        self.along, self.down = along, down
        self.at_x = column(roots[:, 0]) + centre * along * column(out[:, 0])
        self.at_y = column(roots[:, 1]) + centre * along * column(out[:, 1])
        self.at_z = centre * down
        self.normal_x, self.normal_y = -down * column(out[:, 0]), -down * column(out[:, 1])
        self.sweep = centre * speeds
        # Thrust along the blade for each unit of its coefficient.
        push = -0.5 * DENSITY * craft.fin_area * self.sweep**2
        self.push_x, self.push_y = push * along * column(out[:, 0]), push * along * column(out[:, 1])
        self.push_z = push * down


class Bodies:
    """The same windows for each of these crafts, which share hull size and fin geometry."""

    def __init__(self, crafts: Sequence[Craft], motions: Sequence[FinMotions], which: Sequence[int]) -> None:
        """Prepare the crafts; `which` is the index of each craft's motion in `motions`."""

        def column(values: Sequence[float]) -> Floats:
            return np.array(values, dtype=float)[:, None]

        def six(values: Sequence[Sequence[float]]) -> Floats:
            return np.array(values, dtype=float).T[:, :, None]

        self._fins = _FinGeometry(crafts[0], motions)
        self._which = np.array(which)
        self._shared = len(motions) == 1
        self._mass = six([craft.total_mass for craft in crafts])
        self._linear = six([craft.damping_linear for craft in crafts])
        self._quadratic = six([craft.damping_quadratic for craft in crafts])
        self._thrust = column([craft.thrust_coefficient for craft in crafts])
        self._normal = column([0.5 * DENSITY * craft.fin_area * craft.fin_normal for craft in crafts])
        weight = column([craft.mass * GRAVITY for craft in crafts])
        self._lift = weight * column([craft.buoyancy for craft in crafts])
        self._excess = weight - self._lift
        self._forward = column([craft.buoyancy_forward for craft in crafts])
        self._right = column([craft.buoyancy_right for craft in crafts])
        self._above = column([craft.buoyancy_height for craft in crafts])
        self._sensor = crafts[0].pressure_position

    def simulate(self, start: Floats, step: float, every: int) -> Floats:
        """Return the measured channels of shape (CHANNELS, moments, variants, windows), without offsets.

        `start` are the states of shape (STATES, variants, windows); a moment is every `every` steps of `step`
        (s), by the midpoint rule (Runge-Kutta of second order).
        """
        state = _whole_state(start)
        steps = (len(self._fins.along) - 1) // 2
        channels = np.empty((CHANNELS, steps // every + 1, *start.shape[1:]))
        for index in range(steps + 1):
            slope = self._slope(state, 2 * index) if index < steps or steps % every == 0 else None
            if index % every == 0 and slope is not None:
                channels[:, index // every] = self._measure(state, slope)
            if index == steps or slope is None:
                break
            middle = state + 0.5 * step * slope
            state = state + step * self._slope(middle, 2 * index + 1)
            state[1:5] /= np.sqrt((state[1:5] ** 2).sum(axis=0))
        return channels

    def _slope(self, state: Floats, half: int) -> Floats:
        """Return the time derivative of depth, quaternion, velocity and turn rate, stacked to 11 rows."""
        w, x, y, z = state[1:5]
        velocity, rate = state[5:8], state[8:11]
        u, v, down = velocity
        p, q, r = rate
        towards = _down(state)
        force = self._wrench(half, velocity, rate)
        force[0] += self._excess * towards[0]
        force[1] += self._excess * towards[1]
        force[2] += self._excess * towards[2]
        lift = self._lift
        force[3] -= lift * (self._right * towards[2] + self._above * towards[1])
        force[4] += lift * (self._above * towards[0] + self._forward * towards[2])
        force[5] += lift * (self._right * towards[0] - self._forward * towards[1])

        mass = self._mass
        a, b, c = mass[0] * u, mass[1] * v, mass[2] * down
        d, e, f = mass[3] * p, mass[4] * q, mass[5] * r
        force[0] -= q * c - r * b
        force[1] -= r * a - p * c
        force[2] -= p * b - q * a
        force[3] -= q * f - r * e + v * c - down * b
        force[4] -= r * d - p * f + down * a - u * c
        force[5] -= p * e - q * d + u * b - v * a
        moving = state[5:11]
        force -= (self._linear + self._quadratic * np.abs(moving)) * moving
        slope = np.empty_like(state)
        slope[0] = towards[0] * u + towards[1] * v + towards[2] * down
        slope[1] = -0.5 * (x * p + y * q + z * r)
        slope[2] = 0.5 * (w * p + y * r - z * q)
        slope[3] = 0.5 * (w * q + z * p - x * r)
        slope[4] = 0.5 * (w * r + x * q - y * p)
        slope[5:11] = force / mass
        return slope

    def _wrench(self, half: int, velocity: Floats, rate: Floats) -> Floats:
        """Return force and torque of the fins, as `Fins.push`."""
        fins = self._fins
        u, v, w = velocity
        p, q, r = rate

        def at(values: Floats) -> Floats:
            now: Floats = values[half]
            return now if self._shared else now[:, self._which]

        at_x, at_y, at_z, along = at(fins.at_x), at(fins.at_y), at(fins.at_z), at(fins.along)
        normal_x, normal_y = at(fins.normal_x), at(fins.normal_y)
        across = at(fins.sweep) + (u + q * at_z - r * at_y) * normal_x
        across += (v + r * at_x - p * at_z) * normal_y
        across += (w + p * at_y - q * at_x) * along
        drag = self._normal * across * np.abs(across)
        x = self._thrust * at(fins.push_x) - drag * normal_x
        y = self._thrust * at(fins.push_y) - drag * normal_y
        z = self._thrust * at(fins.push_z) - drag * along
        wrench = np.empty((6, *u.shape))
        wrench[0], wrench[1], wrench[2] = x.sum(axis=0), y.sum(axis=0), z.sum(axis=0)
        wrench[3] = (at_y * z - at_z * y).sum(axis=0)
        wrench[4] = (at_z * x - at_x * z).sum(axis=0)
        wrench[5] = (at_x * y - at_y * x).sum(axis=0)
        return wrench

    def _measure(self, state: Floats, slope: Floats) -> Floats:
        """Return the readings of the IMU at the centre of mass and of the pressure sensor at its position."""
        towards = _down(state)
        velocity, rate = state[5:8], state[8:11]
        channels = np.empty((CHANNELS, *state.shape[1:]))
        x, y, z = self._sensor
        channels[0] = state[0] + towards[0] * x + towards[1] * y + towards[2] * z
        channels[1:4] = rate
        # Acceleration over ground in body axes, less gravity.
        channels[4:7] = slope[5:8] - GRAVITY * towards
        channels[4] += rate[1] * velocity[2] - rate[2] * velocity[1]
        channels[5] += rate[2] * velocity[0] - rate[0] * velocity[2]
        channels[6] += rate[0] * velocity[1] - rate[1] * velocity[0]
        return channels


def _whole_state(start: Floats) -> Floats:
    """Return depth, quaternion, velocity and turn rate of hulls that look north."""
    roll, pitch = start[4] / 2, start[5] / 2
    state = np.empty((11, *start.shape[1:]))
    state[0] = start[0]
    state[1], state[2] = np.cos(roll) * np.cos(pitch), np.sin(roll) * np.cos(pitch)
    state[3], state[4] = np.cos(roll) * np.sin(pitch), -np.sin(roll) * np.sin(pitch)
    state[5:8], state[8:11] = start[1:4], start[6:9]
    return state


def _down(state: Floats) -> Floats:
    """Return the direction downwards in body axes: the last row of the rotation to the world."""
    w, x, y, z = state[1:5]
    return np.stack((2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
