"""The hull's motion in six degrees of freedom.

The model is Fossen's, for a hull whose centre of mass is the origin and whose planes of symmetry make all its
matrices diagonal: M ν̇_r + C(ν_r) ν_r + D(ν_r) ν_r + g(η) = τ, where ν_r is the velocity through the water
and M holds the added mass (T. I. Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2011,
8.1). C(ν_r) includes the Munk moment, which turns a drifting hull across its path. Water that accelerates, in
waves, takes the hull along as the water that it displaces (J. N. Newman, Marine Hydrodynamics, 1977, chapter
4): its acceleration is added to that through the water. The flow is that at the centre of mass. Body axes are
forward, right, down; the world's north, east, down.
"""

from robot_runtime.simulation.water.contact import Contact
from robot_runtime.simulation.water.fins import Fins, Four
from robot_runtime.simulation.water.geometry import (
    BodyState,
    Matrix,
    at_rest,
    attitude_rate,
    cross,
    normalize,
    rotation,
    to_body,
    to_world,
)
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import FLOATING, StartPose, Trim
from robot_runtime.simulation.water.world import World


class Body:
    """A hull in water, pushed by fins."""

    def __init__(self, parameters: SimulationParameters, fins: Fins, world: World) -> None:
        self._fins = fins
        self.world = world
        self._contact = Contact(parameters)
        self._mass = parameters.total_mass
        self._linear = parameters.damping_linear
        self._quadratic = parameters.damping_quadratic
        self._weight = parameters.weight
        self.trim = Trim.of(parameters)
        self.start()

    def start(self, start: StartPose = FLOATING) -> None:
        """Put the hull at this pose, at rest, at time 0."""
        depth = self.world.floating_depth(self.trim.buoyancy) if start.down is None else start.down
        self.time = 0.0
        self.state = at_rest(depth, start.north, start.east, start.heading)

    def step(self, duration: float, angles: Four, speeds: Four) -> None:
        """Advance by `duration` (s): one step of the midpoint rule (Runge-Kutta of second order).

        `angles` (rad) are the fins' at the start; during the step they turn evenly at `speeds` (rad/s).
        """
        half = 0.5 * duration
        middle = _advance(self.state, self.derivative(self.state, angles, speeds), half)
        a, b, c, d = angles
        e, f, g, h = speeds
        halfway = (a + e * half, b + f * half, c + g * half, d + h * half)
        moved = _advance(self.state, self.derivative(middle, halfway, speeds, half), duration)
        moved = moved._replace(attitude=normalize(moved.attitude))
        self.state = self._contact.settle(moved, self.world.basin)
        self.time += duration

    def derivative(self, state: BodyState, angles: Four, speeds: Four, later: float = 0.0) -> BodyState:
        """Return the time derivative of a state that is reached `later` (s) than now."""
        position, attitude, velocity, rate = state
        matrix = rotation(attitude)
        water = self.world.flow(self.time + later, position)
        flow = to_body(matrix, water.velocity)
        through = (velocity[0] - flow[0], velocity[1] - flow[1], velocity[2] - flow[2])
        push = self._fins.push(angles, speeds, through, rate)
        restoring = self._restoring(position[2] + water.rise, matrix, through)

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
        surge, sway, heave = to_body(matrix, water.acceleration)
        return BodyState(
            to_world(matrix, velocity),
            attitude_rate(attitude, rate),
            (x - swing[0] + surge, y - swing[1] + sway, z - swing[2] + heave),
            (roll, pitch, yaw),
        )

    def _restoring(self, depth: float, matrix: Matrix, through: Vector) -> tuple[float, ...]:
        """Return force (N) and torque (N m) of weight, buoyancy and waves in body axes.

        `depth` (m) is that below the surface as it is above the hull, `through` (m/s) the velocity through
        the water.
        """
        x, y, z = matrix[2]
        trim = self.trim
        sinking = x * through[0] + y * through[1] + z * through[2]
        lift = self._weight * trim.buoyancy * self.world.submerged(depth)
        force = self._weight - lift + self.world.wave_drag(depth, sinking)
        return (
            force * x,
            force * y,
            force * z,
            -lift * (trim.right * z + trim.above * y),
            lift * (trim.above * x + trim.forward * z),
            lift * (trim.right * x - trim.forward * y),
        )


def _advance(state: BodyState, rates: BodyState, duration: float) -> BodyState:
    (a, b, c), (d, e, f, g), (h, i, j), (k, m, n) = state
    (da, db, dc), (dd, de, df, dg), (dh, di, dj), (dk, dm, dn) = rates
    return BodyState(
        (a + da * duration, b + db * duration, c + dc * duration),
        (d + dd * duration, e + de * duration, f + df * duration, g + dg * duration),
        (h + dh * duration, i + di * duration, j + dj * duration),
        (k + dk * duration, m + dm * duration, n + dn * duration),
    )
