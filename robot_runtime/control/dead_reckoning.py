"""Dead reckoning: the way since arming, estimated from the motion of the fins and the attitude.

Nothing on board measures a position or a speed. The speed through the water follows from the force of the
fins and a model of the hull, the direction from the attitude (T. I. Fossen, Handbook of Marine Craft
Hydrodynamics and Motion Control, 2011: 6.3 for masses that differ along the axes, 6.4 for damping):

    M·v' = F - ω × (M·v) - (d + D·|v|)·v

v is the velocity in body axes, ω the measured turn rate; M has the craft's mass with added mass, d and D its
damping. F is the force of the fins: ½ρ·C_T·S·(r_c·θ')² from tip to shaft, and ½ρ·C_N·S·w·|w| against the
speed w of the blade across the water, θ being the measured angle of a fin (`simulation/water/fins.py`).
Net buoyancy is left out: it hardly moves the hull sideways.

The errors of that are not known, but their sizes are. Each is carried along as the change of the way by one
unit of it (P. S. Maybeck, Stochastic Models, Estimation, and Control, volume 1, 1979, 4.11: sources that are
constants, and white noise). The water is taken to stand still: a current is not felt.
"""

from collections import deque
from collections.abc import Sequence
from math import cos, pi, remainder, sin, sqrt

from robot_runtime.clock import Clock
from robot_runtime.contract.buoyancy import DENSITY
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, Craft, Vector
from robot_runtime.contract.documents import Mode, Track
from robot_runtime.contract.packets import Imu, Motor
from robot_runtime.contract.topics import IMU, MOTOR, TRACK
from robot_runtime.control.attitude import turn_to_world
from robot_runtime.transport.bus import Bus

SPEED_ERROR = 0.1
"""Standard deviation of the speed's error as a share: of thrust and drag that are not those of the craft."""
WANDER = 0.01
"""m/√s, standard deviation of what remains after one second."""
GAP = 0.2
"""s between two readings of the fins at most; in a longer gap the hull coasts."""
_MOTORS_MAX = 100
"""Readings that wait for a tick at most: those of two seconds."""
SWIMS_IN: tuple[Mode, ...] = ("automatic", "manual")
"""The modes in which a way is estimated."""
Four = tuple[float, float, float, float]
Pair = tuple[float, float]


class Hull:
    """The velocity of a hull through the water, m/s in body axes forward, right, down."""

    def __init__(self, craft: Craft) -> None:
        self.velocity: Vector = (0.0, 0.0, 0.0)
        surge, sway, heave, *_ = craft.total_mass
        self._mass = surge, sway, heave
        self._damping = tuple(zip(craft.damping_linear[:3], craft.damping_quadratic[:3], strict=True))
        self._mounts = tuple(
            (*root, *out) for root, out in zip(craft.fin_positions, craft.fin_directions, strict=True)
        )
        self._centre = craft.fin_centre
        half = 0.5 * DENSITY * craft.fin_area
        self._thrust, self._normal = half * craft.thrust_coefficient, half * craft.fin_normal

    def advance(self, seconds: float, angles: Sequence[float], speeds: Sequence[float], rate: Vector) -> None:
        """Advance by `seconds`; the fins at `angles` (rad) turn at `speeds`, the hull at `rate` (rad/s)."""
        a, b, c = (mass * speed for mass, speed in zip(self._mass, self.velocity, strict=True))
        p, q, r = rate
        turning = q * c - r * b, r * a - p * c, p * b - q * a
        force = self._push(angles, speeds, rate)
        # The damping is that of the new speed, so that no gap between two readings makes it unstable.
        surge, sway, heave = (
            (mass * speed + seconds * (push - turned)) / (mass + seconds * (linear + quadratic * abs(speed)))
            for mass, speed, push, turned, (linear, quadratic) in zip(
                self._mass, self.velocity, force, turning, self._damping, strict=True
            )
        )
        self.velocity = surge, sway, heave

    def _push(self, angles: Sequence[float], speeds: Sequence[float], rate: Vector) -> Vector:
        u, v, w = self.velocity
        p, q, r = rate
        x = y = z = 0.0
        for (root_x, root_y, out_x, out_y), angle, speed in zip(self._mounts, angles, speeds, strict=True):
            along, down = cos(angle), sin(angle)
            at_x = root_x + self._centre * along * out_x
            at_y = root_y + self._centre * along * out_y
            at_z = self._centre * down
            sweep = self._centre * speed
            across = (
                sweep
                - down * (out_x * (u + q * at_z - r * at_y) + out_y * (v + r * at_x - p * at_z))
                + along * (w + p * at_y - q * at_x)
            )
            thrust, drag = self._thrust * sweep * sweep, self._normal * across * abs(across)
            outwards = drag * down - thrust * along
            x += outwards * out_x
            y += outwards * out_y
            z -= thrust * down + drag * along
        return x, y, z


class DeadReckoning:
    """The estimated way of the hull since it was armed.

    The bus fills it from any thread; `tick` belongs to the control loop.
    """

    def __init__(self, bus: Bus, clock: Clock) -> None:
        self.craft = DEFAULT_DOCUMENT.craft
        """The numbers of the hull, from the next arming on."""
        self._bus = bus
        self._clock = clock
        self._motors: deque[tuple[float, bytes, bytes]] = deque(maxlen=_MOTORS_MAX)
        self._imu: bytes | None = None
        self._restarts = True
        """True while the next tick in which the robot swims begins a new way."""
        self._start()
        bus.on_row(IMU, self._take_imu)
        bus.on_row(MOTOR, self._take_motor)

    @property
    def track(self) -> Track:
        """The way since arming with its standard deviations."""
        x, y = self.way
        wander = WANDER**2 * self._seconds
        drift_x, drift_y = (self.craft.gyroscope.bias * share for share in self._drift)
        return Track(
            x=x,
            y=y,
            deviation_x=sqrt((SPEED_ERROR * x) ** 2 + drift_x**2 + wander),
            deviation_y=sqrt((SPEED_ERROR * y) ** 2 + drift_y**2 + wander),
        )

    def change_mode(self, mode: Mode) -> None:
        """Take each new mode of the robot; a way ends when the robot no longer swims. Never blocks."""
        if mode not in SWIMS_IN:
            self._restarts = True

    def tick(self, mode: Mode) -> None:
        """Advance by the readings since the last tick, and publish the way while the robot swims."""
        if mode not in SWIMS_IN:
            self._motors.clear()
            return
        if self._restarts:
            self._restarts = False
            self._start()
        while self._motors:
            time, motor, imu = self._motors.popleft()
            self._advance(time, Motor.from_bytes(motor).angle, Imu.from_bytes(imu))
        self._bus.publish_row(TRACK, self._clock.now(), self.track.to_bytes())

    def _start(self) -> None:
        self._hull = Hull(self.craft)
        self.way: Pair = (0.0, 0.0)
        """m along headings 0 and 90°."""
        self._drift: Pair = (0.0, 0.0)
        """The way's change by a heading that drifts by one rad/s."""
        self._seconds = 0.0
        self._last: tuple[float, Four] | None = None

    def _advance(self, time: float, angles: Four, imu: Imu) -> None:
        last, self._last = self._last, (time, angles)
        if last is None or (seconds := time - last[0]) <= 0:
            return
        turned = [remainder(now - before, 2 * pi) for now, before in zip(angles, last[1], strict=True)]
        moving = seconds <= GAP
        self._hull.advance(
            seconds,
            [before + turn / 2 for before, turn in zip(last[1], turned, strict=True)],
            [turn / seconds if moving else 0.0 for turn in turned],
            imu.rate,
        )
        x, y, _ = turn_to_world(imu.attitude, self._hull.velocity)
        self._seconds += seconds
        x, y = x * seconds, y * seconds
        self.way = self.way[0] + x, self.way[1] + y
        # Such a drift turns each piece of the way by the time since the start.
        self._drift = self._drift[0] - y * self._seconds, self._drift[1] + x * self._seconds

    def _take_imu(self, _time: float, record: bytes) -> None:
        self._imu = record

    def _take_motor(self, time: float, record: bytes) -> None:
        if self._imu is not None:
            self._motors.append((time, record, self._imu))
