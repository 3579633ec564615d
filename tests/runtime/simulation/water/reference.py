"""A second implementation of the equations of motion, with full matrices as in the textbook."""

import numpy as np
from numpy.typing import NDArray

from robot_runtime.simulation.water.fins import Four
from robot_runtime.simulation.water.geometry import BodyState
from robot_runtime.simulation.water.parameters import SimulationParameters, Six, Vector

Array = NDArray[np.float64]


def skew(a: Array) -> Array:
    x, y, z = a
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rotation(attitude: Array) -> Array:
    """Return Rodrigues' matrix, from scalar w and vector e: (w² - e·e) I + 2 e eᵀ + 2 w S(e)."""
    w, e = attitude[0], attitude[1:]
    out: Array = (w * w - e @ e) * np.eye(3) + 2 * np.outer(e, e) + 2 * w * skew(e)
    return out


def coriolis(mass: Array, nu: Array) -> Array:
    """Fossen (2011), theorem 3.2: C of a symmetric 6×6 mass matrix."""
    top = mass[:3, :3] @ nu[:3] + mass[:3, 3:] @ nu[3:]
    bottom = mass[3:, :3] @ nu[:3] + mass[3:, 3:] @ nu[3:]
    return np.block([[np.zeros((3, 3)), -skew(top)], [-skew(top), -skew(bottom)]])


def acceleration(parameters: SimulationParameters, state: BodyState, current: Vector, wrench: Six) -> Array:
    """ν̇ (m/s², rad/s²) of the body deep under water, in body axes."""
    turn = rotation(np.array(state.attitude))
    omega = np.array(state.rate)
    flow = turn.T @ np.array(current)
    nu_r = np.concatenate([np.array(state.velocity) - flow, omega])
    rigid = np.diag([parameters.mass] * 3 + list(parameters.inertia))
    mass = rigid + np.diag(parameters.added_mass)
    damping = np.diag(
        np.array(parameters.damping_linear) + np.array(parameters.damping_quadratic) * np.abs(nu_r)
    )
    down = turn.T @ np.array([0, 0, 1.0])
    weight = parameters.mass * parameters.gravity
    lift = -weight * parameters.buoyancy * down
    restoring = np.concatenate([weight * down + lift, np.cross([0, 0, -parameters.buoyancy_height], lift)])
    relative = np.linalg.solve(
        mass, np.array(wrench) + restoring - coriolis(mass, nu_r) @ nu_r - damping @ nu_r
    )
    relative[:3] += -np.cross(omega, flow)
    out: Array = relative
    return out


def fin_wrench(
    parameters: SimulationParameters, angles: Four, speeds: Four, velocity: Vector, rate: Vector
) -> Array:
    """Force and torque of the fins by vectors; they lie at 150°, 30°, -30° and -150° from the bow."""
    total = np.zeros(6)
    roots = [(0.110, 0.065, 0), (-0.110, 0.065, 0), (-0.110, -0.065, 0), (0.110, -0.065, 0)]
    for root, bearing, angle, speed in zip(
        roots, np.deg2rad([150, 30, -30, -150]), angles, speeds, strict=True
    ):
        level = np.array([np.cos(bearing), np.sin(bearing), 0])
        down = np.array([0, 0, 1.0])
        blade = np.cos(angle) * level + np.sin(angle) * down
        normal = -np.sin(angle) * level + np.cos(angle) * down
        at = np.array(root) + parameters.fin_centre * blade
        sweep = parameters.fin_centre * speed
        across = (np.array(velocity) + np.cross(rate, at)) @ normal + sweep
        half = 0.5 * parameters.density * parameters.fin_area
        force = -half * parameters.thrust_coefficient * sweep**2 * blade
        force = force - half * parameters.fin_normal * abs(across) * across * normal
        total += np.concatenate([force, np.cross(at, force)])
    return total
