"""Contact of the hull with floor and walls.

The hull is an ellipsoid, so that it touches each plane at one point. Its speed at that point is changed by
impulses, with the mass that it has in water: one along the plane's normal, which returns `restitution` of the
approach (Newton), then one along the plane against the sliding, at most `friction` times the first (Coulomb).
An impulse -(1+e)·v/K along a line in which the hull has the speed v and the mass 1/K changes the energy by
-(1-e²)·v²/2K; neither impulse can create any. The penetration is undone in the direction of the first
impulse, rotation included, so that a hull on the floor is at rest. Fins touch nothing.
"""

from math import sqrt

from robot_runtime.simulation.water.geometry import (
    BodyState,
    Matrix,
    attitude_rate,
    cross,
    normalize,
    rotation,
    to_world,
)
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import Basin

RESTING = 0.01
"""m/s of approach below which the hull does not bounce, so that it comes to rest."""


class Contact:
    """The contact of the hull with its basin."""

    def __init__(self, parameters: SimulationParameters) -> None:
        length, width, height = parameters.size
        self._half = (length / 2, width / 2, height / 2)
        self._reach = max(self._half)
        self._mass = parameters.total_mass
        self._restitution = parameters.restitution
        self._friction = parameters.friction

    def settle(self, state: BodyState, basin: Basin) -> BodyState:
        """Return the state of a hull that may have passed floor or walls, put back and stopped there."""
        reach, (north, east, down) = self._reach, state.position
        if down + reach > basin.depth:
            state = self._touch(state, 2, 1.0, basin.depth)
        if basin.length is not None and basin.width is not None:
            if abs(north) + reach > basin.length / 2:
                state = self._touch(state, 0, 1.0 if north > 0 else -1.0, basin.length / 2)
            if abs(east) + reach > basin.width / 2:
                state = self._touch(state, 1, 1.0 if east > 0 else -1.0, basin.width / 2)
        return state

    def _touch(self, state: BodyState, axis: int, side: float, limit: float) -> BodyState:
        """Return the state after contact with a plane across this world axis, at `side`·`limit` (m)."""
        matrix = rotation(state.attitude)
        x, y, z = matrix[axis]
        a, b, c = self._half
        reach = sqrt((a * x) ** 2 + (b * y) ** 2 + (c * z) ** 2)
        if side * state.position[axis] + reach <= limit:
            return state
        scale = side / reach
        point = (a * a * x * scale, b * b * y * scale, c * c * z * scale)
        inwards = (-side * x, -side * y, -side * z)
        depth = side * state.position[axis] + reach - limit
        back = self._take_back(state, matrix, point, inwards, depth)
        x, y, z = rotation(back.attitude)[axis]
        position = list(back.position)
        position[axis] = side * min(
            side * position[axis], limit - sqrt((a * x) ** 2 + (b * y) ** 2 + (c * z) ** 2)
        )
        return self._stop(back._replace(position=(position[0], position[1], position[2])), point, inwards)

    def _take_back(
        self, state: BodyState, matrix: Matrix, point: Vector, inwards: Vector, depth: float
    ) -> BodyState:
        """Return the state moved and turned as by a push at the point, until the point is inside."""
        size = depth * self._mass_along(point, inwards)
        x, y, z, roll, pitch, yaw = (
            size * part / mass
            for part, mass in zip((*inwards, *cross(point, inwards)), self._mass, strict=True)
        )
        (north, east, down), moved = state.position, to_world(matrix, (x, y, z))
        w, i, j, k = state.attitude
        turned = attitude_rate(state.attitude, (roll, pitch, yaw))
        return state._replace(
            position=(north + moved[0], east + moved[1], down + moved[2]),
            attitude=normalize((w + turned[0], i + turned[1], j + turned[2], k + turned[3])),
        )

    def _stop(self, state: BodyState, point: Vector, inwards: Vector) -> BodyState:
        approach = -_dot(_speed_at(state, point), inwards)
        if approach <= 0:
            return state
        bounce = self._restitution if approach > RESTING else 0.0
        impulse = (1 + bounce) * approach * self._mass_along(point, inwards)
        state = self._push(state, point, inwards, impulse)
        x, y, z = _speed_at(state, point)
        away = _dot((x, y, z), inwards)
        slide = (x - away * inwards[0], y - away * inwards[1], z - away * inwards[2])
        speed = sqrt(_dot(slide, slide))
        if speed == 0:
            return state
        against = (-slide[0] / speed, -slide[1] / speed, -slide[2] / speed)
        grip = min(self._friction * impulse, speed * self._mass_along(point, against))
        return self._push(state, point, against, grip)

    def _mass_along(self, point: Vector, line: Vector) -> float:
        """Return the effective mass, kg, at this point along this line."""
        lever = cross(point, line)
        yielding = sum(part * part / mass for part, mass in zip((*line, *lever), self._mass, strict=True))
        return 1 / yielding

    def _push(self, state: BodyState, point: Vector, line: Vector, impulse: float) -> BodyState:
        lever = cross(point, line)
        u, v, w, p, q, r = (
            speed + impulse * part / mass
            for speed, part, mass in zip(
                (*state.velocity, *state.rate), (*line, *lever), self._mass, strict=True
            )
        )
        return state._replace(velocity=(u, v, w), rate=(p, q, r))


def _speed_at(state: BodyState, point: Vector) -> Vector:
    x, y, z = cross(state.rate, point)
    u, v, w = state.velocity
    return u + x, v + y, w + z


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
