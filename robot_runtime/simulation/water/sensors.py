"""The robot's simulated sensors: latency, noise, offset, quantization and faults."""

from collections import deque
from math import cos, hypot, nan, pi, remainder, sin
from random import Random
from typing import NamedTuple

from robot_runtime.simulation.water.faults import (
    DEVICES,
    LEAK,
    NO_FAULT,
    SENSORS,
    FaultOfDevice,
    SimulatedFault,
    check_sensor,
)
from robot_runtime.simulation.water.fins import Four
from robot_runtime.simulation.water.geometry import BodyState, Matrix, rotation, to_body, to_world
from robot_runtime.simulation.water.parameters import SensorQuality, SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import check_beacons
from robot_runtime.simulation.water.world import World

Numbers = tuple[float, ...]

WALK_PERIOD = 1.0
"""s between two steps of an offset's random walk."""
SAME_TIME = 1e-9
"""s within which times are equal, since they are sums of many periods."""


class Sensor:
    """A sensor of one or more axes, with a fixed `offset` beside the one that is drawn.

    Its random numbers come from the seed and its name, those of its faults from another generator, so that
    neither other sensors nor its own faults change its noise.
    """

    def __init__(
        self, name: str, quality: SensorQuality, axes: int, seed: int, offset: Numbers | None = None
    ) -> None:
        self._noise, self._walk, self._step = quality.noise, quality.walk, quality.step
        self._latency = quality.latency
        self._interval = 1 / quality.rate
        self._gauss = Random(f"{seed} {name}").gauss
        self._chance = Random(f"{seed} {name} fault").random
        self._offset = [value + self._gauss(0, quality.bias) for value in offset or (0.0,) * axes]
        self._due = 0.0
        self._walk_due = WALK_PERIOD
        self._shown: Numbers | None = None
        self._coming: deque[tuple[float, Numbers]] = deque()
        self._fault = NO_FAULT
        self._since = 0.0
        self.repeats = False
        """True if its newest reading was lost, so that it repeats an older one."""

    def set_fault(self, fault: SimulatedFault, time: float) -> None:
        """Set the fault from `time` (s) on, in place of any other."""
        self._fault = fault
        self._since = time
        self.repeats = False

    def read(self, time: float, actual: Numbers) -> Numbers:
        """Return the reading at this time (s) for these actual values. The first reading has no latency."""
        if time > self._due - SAME_TIME:
            self._due = max(self._due + self._interval, time)
            reading = self._apply_fault(time, self._add_noise(time, actual))
            self.repeats = reading is None
            if self._shown is None:
                self._shown = reading or actual
            elif reading is not None and self._latency == 0:
                self._shown = reading
            elif reading is not None:
                self._coming.append((time + self._latency, reading))
        coming = self._coming
        while coming and coming[0][0] < time + SAME_TIME:
            self._shown = coming.popleft()[1]
        return self._shown if self._shown is not None else actual

    def _add_noise(self, time: float, actual: Numbers) -> Numbers:
        gauss, noise = self._gauss, self._noise
        while time > self._walk_due - SAME_TIME:
            self._walk_due += WALK_PERIOD
            self._offset = [offset + gauss(0, self._walk) for offset in self._offset]
        return tuple(
            [value + offset + gauss(0, noise) for value, offset in zip(actual, self._offset, strict=True)]
        )

    def _apply_fault(self, time: float, reading: Numbers) -> Numbers | None:
        """Return the reading with fault and quantization; None if it is lost."""
        fault = self._fault
        if fault is not NO_FAULT:
            if fault.kind == "stuck" or (fault.kind == "dropout" and self._chance() < (fault.share or 0)):
                return None
            if fault.kind == "spike" and self._chance() < (fault.share or 0):
                jump = (fault.size or 0) if self._chance() < 0.5 else -(fault.size or 0)
                reading = tuple([value + jump for value in reading])
            elif fault.kind == "drift":
                drifted = (fault.speed or 0) * (time - self._since)
                reading = tuple([value + drifted for value in reading])
        step = self._step
        return tuple([step * round(value / step) for value in reading]) if step else reading


class Reading(NamedTuple):
    """All sensors at one moment."""

    pressure: float
    """Pa, absolute."""
    temperature: float
    """°C."""
    force: Vector
    """m/s², specific force in body axes: (0, 0, -9.81) on an upright hull at rest."""
    rate: Vector
    """rad/s, in body axes."""
    beacon_right: bool
    beacon_left: bool
    battery: float
    """V."""
    encoders: Four = (0.0, 0.0, 0.0, 0.0)
    """rad, error of each fin's encoder; nan while it repeats its last reading."""
    fin_load: float = 1.0
    """The water's torque on each fin's motor, over that on the published fin; for the emulated board."""


class Sensors:
    """The sensors of the hull's state. The same seed gives the same readings."""

    def __init__(self, parameters: SimulationParameters, world: World, seed: int) -> None:
        self._parameters = parameters
        self._fin_load = parameters.fin_load
        self._world = world
        self.seed = seed
        """Seed of all noise, from the next start on."""
        self.faults = dict.fromkeys(SENSORS, NO_FAULT)
        self.beacons = parameters.beacons
        self.start()

    def start(self) -> None:
        """Restart at time 0, with the same readings for the same motion; beacons and faults stay."""
        parameters = self._parameters
        offsets = {
            "gyroscope": parameters.gyroscope_offset,
            "accelerometer": parameters.accelerometer_offset,
        }
        self._sensors = {
            name: Sensor(name, quality, axes, self.seed, offsets.get(name))
            for name, (quality, axes) in _qualities(parameters).items()
        }
        for name, sensor in self._sensors.items():
            sensor.set_fault(self.faults[name], 0.0)
        self._encoders = [self._sensors[f"encoder{fin}"] for fin in range(4)]

    def set_fault(self, sensor: str, fault: SimulatedFault, time: float) -> None:
        """Set a sensor's fault from `time` (s) on. Raise ValueError if that sensor cannot have it."""
        check_sensor(sensor, fault)
        self.faults[sensor] = fault
        if sensor != LEAK:
            self._sensors[sensor].set_fault(fault, time)

    def set_beacons(self, positions: tuple[Vector, ...]) -> None:
        """Set the positions (m) of all light beacons. Raise ValueError; see `check_beacons`."""
        check_beacons(positions)
        self.beacons = positions

    @property
    def device_faults(self) -> dict[str, FaultOfDevice]:
        """The faults of the emulated board's devices, by their names: no answer, or a leak."""
        faults: dict[str, FaultOfDevice] = {
            DEVICES[name]: "absent" for name, fault in self.faults.items() if fault.kind == "bus"
        }
        return faults | {LEAK: "wet"} if self.faults[LEAK].kind == "wet" else faults

    def read(self, time: float, state: BodyState, acceleration: Vector, battery: float) -> Reading:
        """Return the readings at this time (s); `acceleration` is that over ground in world axes (m/s²)."""
        parameters, sensors = self._parameters, self._sensors
        matrix = rotation(state.attitude)
        north, east, down = acceleration
        force = to_body(matrix, (north, east, down - parameters.gravity))
        pressure = sensors["pressure"].read(time, (self._pressure(time, state, matrix),))
        fx, fy, fz = sensors["accelerometer"].read(time, force)
        p, q, r = sensors["gyroscope"].read(time, state.rate)
        right, left = self._beacon_margins(state, matrix)
        first, second, third, fourth = [_encoder_error(encoder, time) for encoder in self._encoders]
        return Reading(
            pressure=max(pressure[0], 0.0),
            temperature=parameters.temperature,
            force=(fx, fy, fz),
            rate=(p, q, r),
            beacon_right=sensors["beacon_right"].read(time, (right,))[0] > 0,
            beacon_left=sensors["beacon_left"].read(time, (left,))[0] > 0,
            battery=max(sensors["battery"].read(time, (battery,))[0], 0.0),
            encoders=(first, second, third, fourth),
            fin_load=self._fin_load,
        )

    def _pressure(self, time: float, state: BodyState, matrix: Matrix) -> float:
        x, y, z = to_world(matrix, self._parameters.pressure_position)
        north, east, down = state.position
        return self._world.pressure(time, (north + x, east + y, down + z))

    def _beacon_margins(self, state: BodyState, matrix: Matrix) -> tuple[float, float]:
        """Return the margins of the right and the left detector in range and view; above 0 a beacon is seen.

        A detector sees a beacon within its range and view; the brightest counts.
        """
        parameters = self._parameters
        best = (-1.0, -1.0)
        edge = cos(parameters.beacon_view)
        for beacon in self.beacons:
            north, east, down = (a - b for a, b in zip(beacon, state.position, strict=True))
            distance = hypot(north, east, down)
            near = 1 - distance / parameters.beacon_range
            if near < -1:
                continue
            if distance == 0:
                return 1.0, 1.0
            forward, right, _ = to_body(matrix, (north, east, down))
            ahead = cos(parameters.beacon_detector) * forward / distance
            aside = sin(parameters.beacon_detector) * right / distance
            views = (ahead + aside - edge) / (1 - edge), (ahead - aside - edge) / (1 - edge)
            best = max(best[0], min(near, views[0])), max(best[1], min(near, views[1]))
        return best


def _encoder_error(encoder: Sensor, time: float) -> float:
    (error,) = encoder.read(time, (0.0,))
    return nan if encoder.repeats else remainder(error, 2 * pi)


def _qualities(parameters: SimulationParameters) -> dict[str, tuple[SensorQuality, int]]:
    """Return the error model and the number of axes of each sensor."""
    return {
        "pressure": (parameters.pressure, 1),
        "gyroscope": (parameters.gyroscope, 3),
        "accelerometer": (parameters.accelerometer, 3),
        **{f"encoder{fin}": (parameters.encoder, 1) for fin in range(4)},
        "beacon_right": (parameters.beacon_right, 1),
        "beacon_left": (parameters.beacon_left, 1),
        "battery": (parameters.battery, 1),
    }
