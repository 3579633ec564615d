"""The hull's motion in six degrees of freedom.

The model is Fossen's, for a hull whose centre of mass is the origin and whose planes of symmetry make all its
matrices diagonal: M ν̇_r + C(ν_r) ν_r + D(ν_r) ν_r + g(η) = τ, where ν_r is the velocity through the water and
M holds the added mass (T. I. Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2011, 8.1).
C(ν_r) includes the Munk moment, which turns a drifting hull across its path. Body axes are forward, right,
down; the world's north, east, down.
"""

from typing import NamedTuple

from robot_runtime.simulation.fins import Four, Propulsion
from robot_runtime.simulation.geometry import (
    Matrix,
    Quaternion,
    attitude_rate,
    cross,
    normalize,
    rotation,
    to_body,
    to_world,
)
from robot_runtime.simulation.parameters import Parameters, Vector
from robot_runtime.simulation.world import World


class State(NamedTuple):
    """Where the hull is and how it moves."""

    position: Vector
    """m north, east, down."""
    attitude: Quaternion
    """Unit quaternion w, x, y, z that turns body axes into world axes."""
    velocity: Vector
    """m/s over ground, in body axes."""
    rate: Vector
    """rad/s, in body axes."""


class Body:
    """A hull in water, pushed by fins."""

    def __init__(self, parameters: Parameters, propulsion: Propulsion, world: World) -> None:
        self._propulsion = propulsion
        self._world = world
        self._mass = parameters.total_mass
        self._linear = parameters.damping_linear
        self._quadratic = parameters.damping_quadratic
        self._weight = parameters.weight
        self._lift = parameters.weight * parameters.buoyancy
        self._lift_height = parameters.buoyancy_height
        self.current: Vector = (0.0, 0.0, 0.0)
        """m/s north, east, down, of the water."""
        self.state = self.at_rest(world.floating_depth)

    @staticmethod
    def at_rest(depth: float) -> State:
        """Upright, looking north, at rest, at this depth (m)."""
        return State((0.0, 0.0, depth), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def step(self, duration: float, angles: Four, speeds: Four) -> None:
        """Let `duration` (s) pass: one step of the midpoint rule (Runge-Kutta of second order).

        `angles` (rad) are the fins' at the start; during the step they turn evenly at `speeds` (rad/s).
        """
        half = 0.5 * duration
        middle = _advance(self.state, self.derivative(self.state, angles, speeds), half)
        a, b, c, d = angles
        e, f, g, h = speeds
        halfway = (a + e * half, b + f * half, c + g * half, d + h * half)
        moved = _advance(self.state, self.derivative(middle, halfway, speeds), duration)
        self.state = self._held_by_floor(moved._replace(attitude=normalize(moved.attitude)))

    def derivative(self, state: State, angles: Four, speeds: Four) -> State:
        """Time derivative of each part of the state, in the same units per second."""
        position, attitude, velocity, rate = state
        matrix = rotation(attitude)
        flow = to_body(matrix, self.current)
        through = (velocity[0] - flow[0], velocity[1] - flow[1], velocity[2] - flow[2])
        push = self._propulsion.push(angles, speeds, through, rate)
        restoring = self._restoring(position[2], matrix, velocity)

        mass = self._mass
        momentum = (mass[0] * through[0], mass[1] * through[1], mass[2] * through[2])
        spin = (mass[3] * rate[0], mass[4] * rate[1], mass[5] * rate[2])
        turning = cross(rate, momentum)
        gyroscopic = cross(rate, spin)
        munk = cross(through, momentum)
        inertial = (*turning, gyroscopic[0] + munk[0], gyroscopic[1] + munk[1], gyroscopic[2] + munk[2])
        x, y, z, roll, pitch, yaw = (
            (push + restoring - inertial - (linear + quadratic * abs(speed)) * speed) / mass
            for push, restoring, inertial, linear, quadratic, speed, mass in zip(
                push, restoring, inertial, self._linear, self._quadratic, (*through, *rate), mass, strict=True
            )
        )
        # In body axes a steady current turns as the hull turns, and the velocity over ground contains it.
        swing = cross(rate, flow)
        return State(
            to_world(matrix, velocity),
            attitude_rate(attitude, rate),
            (x - swing[0], y - swing[1], z - swing[2]),
            (roll, pitch, yaw),
        )

    def _restoring(self, depth: float, matrix: Matrix, velocity: Vector) -> tuple[float, ...]:
        """Weight, buoyancy and waves: force (N) and torque (N m) in body axes."""
        x, y, z = matrix[2]
        sinking = x * velocity[0] + y * velocity[1] + z * velocity[2]
        lift = self._lift * self._world.submerged(depth)
        force = self._weight - lift + self._world.wave_drag(depth, sinking)
        torque = lift * self._lift_height
        return force * x, force * y, force * z, -torque * y, torque * x, 0.0

    def _held_by_floor(self, state: State) -> State:
        """The state after a hull that reached the floor lost what speed it had towards it."""
        north, east, depth = state.position
        if depth <= self._world.lowest_depth:
            return state
        matrix = rotation(state.attitude)
        x, y, z = to_world(matrix, state.velocity)
        velocity = to_body(matrix, (x, y, min(z, 0.0)))
        return state._replace(position=(north, east, self._world.lowest_depth), velocity=velocity)


def _advance(state: State, rates: State, duration: float) -> State:
    (a, b, c), (d, e, f, g), (h, i, j), (k, m, n) = state
    (da, db, dc), (dd, de, df, dg), (dh, di, dj), (dk, dm, dn) = rates
    return State(
        (a + da * duration, b + db * duration, c + dc * duration),
        (d + dd * duration, e + de * duration, f + df * duration, g + dg * duration),
        (h + dh * duration, i + di * duration, j + dj * duration),
        (k + dk * duration, m + dm * duration, n + dn * duration),
    )
