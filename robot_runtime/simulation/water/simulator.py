"""The whole simulated robot apart from its board: fins in, sensor readings out."""

import threading
from collections.abc import Sequence
from math import ceil
from typing import NamedTuple

from robot_runtime.contract.battery_pack import charge_at, resting_voltage
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.documents import Truth
from robot_runtime.contract.power_budget import EFFICIENCY, electronics_power, motor_power
from robot_runtime.simulation.water.body import Body
from robot_runtime.simulation.water.faults import FaultOfDevice, SimulatedFault
from robot_runtime.simulation.water.fins import FinDelay, Fins, Four
from robot_runtime.simulation.water.geometry import rotation, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.sensors import Reading, Sensors
from robot_runtime.simulation.water.surroundings import (
    FLOATING,
    Basin,
    Current,
    StartPose,
    Trim,
    Waves,
    check_start,
)
from robot_runtime.simulation.water.world import World

STEP_MAX = 0.005
"""s; at this step a position is off by less than 0.1 mm after 10 s of swimming."""
DRIVE_VOLTS = 0.08
"""V of a motor for each step of its H-bridge's command (DRV8830 data sheet)."""


class FinMotion(NamedTuple):
    """The fins at one moment, as the board reports them."""

    angles: Four
    """rad."""
    speeds: Four
    """rad/s."""
    drives: Four
    """H-bridge commands, -63 to 63."""
    powered: bool
    """True if the motors have power."""

    @classmethod
    def of(cls, numbers: Sequence[float]) -> "FinMotion":
        """Return the motion in 13 numbers: four angles, speeds and drive, and the power (not 0 if on)."""
        a0, a1, a2, a3, s0, s1, s2, s3, d0, d1, d2, d3, power = numbers
        return cls((a0, a1, a2, a3), (s0, s1, s2, s3), (d0, d1, d2, d3), power != 0)


class SimulationSetup(NamedTuple):
    """All settings of water, hull and sensors."""

    basin: Basin
    current: Current
    waves: Waves
    trim: Trim
    beacons: tuple[Vector, ...]
    faults: dict[str, SimulatedFault]
    """By sensor."""


class Simulator:
    """Body, world and sensors together. Its methods may be called from any thread."""

    def __init__(self, parameters: SimulationParameters, seed: int) -> None:
        self._parameters = parameters
        self._craft = parameters.craft
        self._world = World(parameters)
        self._body = Body(parameters, Fins(parameters), self._world)
        self._sensors = Sensors(parameters, self._world, seed)
        self._electronics = electronics_power()
        self._charge_battery()
        self._angles: Four = (0.0, 0.0, 0.0, 0.0)
        self._delay = FinDelay(parameters.fin_delay)
        self._lock = threading.Lock()

    def advance(self, period: float, fins: FinMotion) -> Reading:
        """Advance by `period` (s), at whose end the fins are as given, and read the sensors."""
        with self._lock:
            before = self._velocity()
            steps = ceil(period / STEP_MAX)
            duration = period / steps
            (a, b, c, d), speeds = self._delay.delay(period, fins.angles, fins.speeds)
            e, f, g, h = speeds
            for step in range(steps):
                remaining = period - step * duration
                start = (a - e * remaining, b - f * remaining, c - g * remaining, d - h * remaining)
                self._body.step(duration, start, speeds)
            self._angles = fins.angles
            self._drain(period, fins)
            after = self._velocity()
            # The mean over the period contains the shock of reaching the floor.
            acceleration = (
                (after[0] - before[0]) / period,
                (after[1] - before[1]) / period,
                (after[2] - before[2]) / period,
            )
            return self._sensors.read(self._body.time, self._body.state, acceleration, self._battery)

    def reset(self, start: StartPose = FLOATING, seed: int | None = None) -> None:
        """Restart at time 0, at rest, by default floating and heading north, with a full battery.

        The sensors' noise restarts, too, with another `seed` if one is given. Water, trim, beacons and
        faults stay as they are. Raise ValueError if floor or walls are in the way.
        """
        with self._lock:
            check_start(start, self._world.basin, self._parameters.size)
            if seed is not None:
                self._sensors.seed = seed
            self._start(start)

    def set_current(self, current: Current) -> None:
        """Set the current from now on."""
        with self._lock:
            self._world.set_current(current, self._body.time)

    def set_waves(self, waves: Waves) -> None:
        """Set the waves. Raise ValueError if they would break in water of this depth."""
        with self._lock:
            self._world.set_waves(waves)

    def set_trim(self, trim: Trim) -> None:
        """Set the trim of the hull."""
        with self._lock:
            self._body.trim = trim

    def set_basin(self, basin: Basin) -> None:
        """Set floor and walls, and reset, because the hull may now be inside a wall.

        Raise ValueError if the present waves would break there.
        """
        with self._lock:
            self._world.set_basin(basin)
            self._start()

    def set_beacons(self, positions: tuple[Vector, ...]) -> None:
        """Set the positions (m north, east, down) of all light beacons. Raise ValueError."""
        with self._lock:
            self._sensors.set_beacons(positions)

    def set_fault(self, sensor: str, fault: SimulatedFault) -> None:
        """Set or clear the fault of a sensor. Raise ValueError if it cannot have this fault."""
        with self._lock:
            self._sensors.set_fault(sensor, fault, self._body.time)

    def surroundings(self) -> SimulationSetup:
        """Return the present value of everything that can be set."""
        with self._lock:
            world, sensors = self._world, self._sensors
            return SimulationSetup(
                world.basin,
                world.current,
                world.waves,
                self._body.trim,
                sensors.beacons,
                dict(sensors.faults),
            )

    def craft(self) -> Craft:
        """Return the numbers of the hull, with its present trim."""
        with self._lock:
            trim = self._body.trim
            if trim != Trim.of(self._craft):
                self._craft = trim.on(self._craft)
            return self._craft

    @property
    def device_faults(self) -> dict[str, FaultOfDevice]:
        """The faults of the emulated board's devices: imu, pressure, encoder0 to encoder3, leak."""
        with self._lock:
            return self._sensors.device_faults

    def truth(self) -> Truth:
        """Return the true motion of the body."""
        with self._lock:
            position, attitude, velocity, rate = self._body.state
            return Truth(
                position=position, attitude=attitude, velocity=velocity, rate=rate, fins=self._angles
            )

    def _start(self, start: StartPose = FLOATING) -> None:
        self._body.start(start)
        self._world.set_current(self._world.current)
        self._sensors.start()
        self._delay = FinDelay(self._parameters.fin_delay)
        self._charge_battery()

    def _charge_battery(self) -> None:
        self._charge = charge_at(self._parameters.battery_full)
        self._battery = resting_voltage(self._charge)

    def _velocity(self) -> Vector:
        state = self._body.state
        return to_world(rotation(state.attitude), state.velocity)

    def _drain(self, period: float, fins: FinMotion) -> None:
        power = self._electronics
        if fins.powered:
            for drive, speed in zip(fins.drives, fins.speeds, strict=True):
                power += motor_power(drive * DRIVE_VOLTS, speed) / EFFICIENCY
        charge = power / self._battery * period / 3600
        self._charge = max(self._charge - charge / self._parameters.battery_capacity, 0.0)
        self._battery = resting_voltage(self._charge)
