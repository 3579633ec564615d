"""Force and torque of four flapping fins."""

from collections import deque
from math import cos, pi, remainder, sin

from robot_runtime.simulation.water.parameters import SimulationParameters, Six, Vector

Four = tuple[float, float, float, float]


class Fins:
    """Blades on shafts across the hull's sides.

    A fin that turns pushes the body from its tip towards its shaft with ½ρ·C_T·S·(r_c·θ̇)². Besides, the
    water resists its blade with ½ρ·C_N·S·u·|u|, where u is the speed across the blade: of the fin's own
    turning and of the hull's motion through the water. Both act at the distance r_c from the shaft. A fin's
    own mass is part of the hull's.
    """

    def __init__(self, parameters: SimulationParameters) -> None:
        self._mounts = [
            (*position, *direction)
            for position, direction in zip(parameters.fin_positions, parameters.fin_directions, strict=True)
        ]
        self._centre = parameters.fin_centre
        half = 0.5 * parameters.density * parameters.fin_area
        self._thrust = half * parameters.thrust_coefficient
        self._normal = half * parameters.fin_normal

    def push(self, angles: Four, speeds: Four, velocity: Vector, rate: Vector) -> Six:
        """Return force (N) and torque (N m) in body axes.

        `angles` in rad, `speeds` in rad/s; `velocity` (m/s) of the hull through the water and its turn `rate`
        (rad/s) in body axes.
        """
        u, v, w = velocity
        p, q, r = rate
        x = y = z = roll = pitch = yaw = 0.0
        for (root_x, root_y, out_x, out_y), angle, speed in zip(self._mounts, angles, speeds, strict=True):
            along, down = cos(angle), sin(angle)
            at_x = root_x + self._centre * along * out_x
            at_y = root_y + self._centre * along * out_y
            at_z = self._centre * down
            normal_x, normal_y = -down * out_x, -down * out_y
            sweep = self._centre * speed
            across = (
                sweep
                + (u + q * at_z - r * at_y) * normal_x
                + (v + r * at_x - p * at_z) * normal_y
                + (w + p * at_y - q * at_x) * along
            )
            thrust = self._thrust * sweep * sweep
            drag = self._normal * across * abs(across)
            force_x = -thrust * along * out_x - drag * normal_x
            force_y = -thrust * along * out_y - drag * normal_y
            force_z = -thrust * down - drag * along
            x += force_x
            y += force_y
            z += force_z
            roll += at_y * force_z - at_z * force_y
            pitch += at_z * force_x - at_x * force_z
            yaw += at_x * force_y - at_y * force_x
        return x, y, z, roll, pitch, yaw


class FinDelay:
    """The delayed motion of the fins: the water answers to that of `seconds` ago."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._motions: deque[tuple[float, Four, Four]] = deque()
        self._time = 0.0
        self._before: Four = (0.0, 0.0, 0.0, 0.0)

    def delay(self, period: float, angles: Four, speeds: Four) -> tuple[Four, Four]:
        """Take angles (rad) and speeds (rad/s) at the end of a period (s); return the delayed ones.

        Between two periods' ends the fins turn evenly, at the speeds of the later one. Before the first they
        were where it begins. The delayed speeds are the means of the period.
        """
        if self._seconds == 0:
            return angles, speeds
        if not self._motions:
            start = _turned(angles, speeds, -period)
            self._motions.append((self._time, start, (0.0, 0.0, 0.0, 0.0)))
            self._before = start
        self._time += period
        self._motions.append((self._time, angles, speeds))
        moment = self._time - self._seconds
        while len(self._motions) > 1 and self._motions[0][0] < moment:
            self._motions.popleft()
        time, angles, speeds = self._motions[0]
        delayed = _turned(angles, speeds, moment - time)
        # Encoders begin anew after a turn.
        e, f, g, h = (
            remainder(now - old, 2 * pi) / period for now, old in zip(delayed, self._before, strict=True)
        )
        self._before = delayed
        return delayed, (e, f, g, h)


def _turned(angles: Four, speeds: Four, seconds: float) -> Four:
    a, b, c, d = angles
    e, f, g, h = speeds
    return a + e * seconds, b + f * seconds, c + g * seconds, d + h * seconds
