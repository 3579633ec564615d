"""Every number of the simulated robot and its water, with its origin and uncertainty.

Three origins occur. *Published*: from the robot's own published code, good to some per cent. *Assumed*:
estimated from the hull's size and shape, since nobody published it; may be wrong by a factor of two.
*Chosen*: a free choice about the surroundings. Numbers of the large U-CAT (19 kg), which circulate under
this robot's name, are not used.

Sensors have a fourth: *data sheet*, of the part named; its values are typical; a single part may differ by a
factor of two.

Fins: front right, back right, back left, front left. Body axes: forward, right, down.
"""

from dataclasses import dataclass
from math import cos, pi, sin

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorQuality:
    """The error model of a sensor, in the units of its reading. Raises ValueError below 0."""

    rate: float = 200.0
    """Hz of new readings, at most 200, the rate of the simulation; faster sensors have that."""
    latency: float = 0.0
    """s from input to reading, besides the delay of the emulated part; in steps of 5 ms."""
    noise: float = 0.0
    """Standard deviation of each reading: Gaussian, without memory."""
    bias: float = 0.0
    """Standard deviation of the offset that is drawn at the start."""
    walk: float = 0.0
    """Standard deviation of the offset's random walk after one second; it grows with √time."""
    step: float = 0.0
    """Quantization of the readings; 0: they are not rounded."""

    def __post_init__(self) -> None:
        if not self.rate > 0:
            raise ValueError(f"a sensor's rate is {self.rate} Hz; it must be above 0")
        for name in ("latency", "noise", "bias", "walk", "step"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"a sensor's {name} is {getattr(self, name)}; it must not be below 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationParameters:
    """The parameters of the physics. Raises ValueError for a number without physical sense."""

    # The hull
    mass: float = 3.0
    """kg. Published."""
    size: Vector = (0.24, 0.10, 0.10)
    """m, along forward, right, down. Published. Where it breaks the surface the hull is taken as an upright
    box, where it touches something as an ellipsoid."""
    inertia: Vector = (0.005, 0.0169, 0.0169)
    """kg m², about forward, right, down. Assumed: a box of the hull's size and mass."""
    buoyancy: float = 1.003
    """Buoyancy under water as a share of the weight. Assumed; published is "slightly positive"."""
    buoyancy_height: float = 0.010
    """m, centre of buoyancy above the centre of mass. Assumed. `Trim` changes both while it swims."""
    restitution: float = 0.2
    """Share of the speed towards a wall or the floor with which the hull comes back. Assumed: plastic on
    tiles under water, which damps; within 0 to 0.5."""
    friction: float = 0.3
    """Coulomb's, of the hull on walls and floor. Assumed: wet plastic; within 0.1 to 0.6."""

    # The water's answer to the moving hull: surge, sway, heave, roll, pitch, yaw
    added_mass: Six = (0.9, 2.6, 3.2, 0.004, 0.012, 0.010)
    """kg and kg m². Assumed: an ellipsoid of the hull's size."""
    damping_linear: Six = (0.6, 1.5, 1.5, 0.004, 0.006, 0.006)
    """N s/m and N m s. Assumed."""
    damping_quadratic: Six = (10.0, 25.0, 35.0, 0.02, 0.05, 0.05)
    """N s²/m² and N m s². Assumed."""

    # The fins
    fin_positions: tuple[tuple[float, float], ...] = (
        (0.110, 0.065),
        (-0.110, 0.065),
        (-0.110, -0.065),
        (0.110, -0.065),
    )
    """m, forward and right, of the fins' shafts. Published."""
    fin_mount: float = pi / 6
    """rad between a fin at angle 0 and the long axis. Published."""
    fin_area: float = 0.0045
    """m² of one fin. Published."""
    fin_centre: float = 0.045
    """m from the shaft to where a fin's force acts. Published."""
    fin_drag: float = 0.31
    """C_d of the published thrust formula, with 0.15 or 0.31 in it. Published, uncertain by that."""
    fin_thrust_per_drag: float = 13.95
    """C_T / C_d. Derived from the published formula; see `thrust_coefficient`."""
    fin_normal: float = 2.0
    """C_N, drag of a fin across its blade. Assumed: a flat plate."""

    # The sensors
    pressure_position: Vector = (0.0, 0.0, -0.05)
    """m, of the pressure sensor in the body; the IMU is at the centre of mass. Assumed: on the back."""
    pressure: SensorQuality = SensorQuality(noise=42.0, walk=1.0, step=0.67)
    """Pa. MS5837-30BA: noise by its data sheet 20 Pa at OSR 8192, twice that at the firmware's 2048, which
    takes a quarter of the samples; step one count of its 24-bit converter. Walk assumed, within a factor of
    five: temperature and gel. No offset, as the firmware takes the surface as its zero. The emulated part
    adds its 4.5 ms of conversion."""
    gyroscope: SensorQuality = SensorQuality(
        latency=0.005, noise=2e-4, bias=2e-3, walk=2e-5, step=pi / 180 / 65.536
    )
    """rad/s. MPU-6050: noise of its class (by the data sheet up to 7e-4 behind the 44 Hz filter); latency of
    that filter 4.8 ms, step at ±500 °/s, both data sheet. Bias and walk assumed, after a calibration at rest:
    the data sheet allows 0.35 rad/s without one."""
    accelerometer: SensorQuality = SensorQuality(
        latency=0.005, noise=1.7e-2, bias=2e-2, walk=1e-4, step=9.80665 / 8192
    )
    """m/s². MPU-6050: noise of its class (by the data sheet 3.3e-2 behind the 44 Hz filter); latency of that
    filter 4.9 ms, step at ±4 g, both data sheet. Bias and walk assumed, after a calibration at rest: the data
    sheet allows 0.5 m/s² without one."""
    encoder: SensorQuality = SensorQuality(noise=2.1e-3, bias=3e-3)
    """rad, each fin's. AS5040: noise data sheet, 0.12°. Bias assumed: half a tick of the calibrated zero; the
    data sheet allows 0.5° for a centred magnet. The emulated part has the 1024 ticks of a turn; the real
    part's delay of 0.1 ms is left out."""
    beacon_right: SensorQuality = SensorQuality(rate=20.0, latency=0.05, noise=0.02)
    beacon_left: SensorQuality = SensorQuality(rate=20.0, latency=0.05, noise=0.02)
    """Share of range and view by which it sees or misses; the reading is whether that is above 0. Assumed
    throughout: nothing of the tone detectors is published; within a factor of three."""
    battery: SensorQuality = SensorQuality(rate=100.0, noise=5e-3, bias=2e-2, step=10 / 1023)
    """V. Divider and converter of the ATmega328P: step 10 bit of 10 V. Noise assumed: half a count; bias
    assumed: resistors of 0.25 %."""
    beacon_detector: float = pi / 4
    """rad between straight ahead and where each beacon detector looks, to its own side. Assumed."""
    beacon_view: float = pi / 3
    """rad from a detector's axis to the edge of what it sees. Assumed."""
    beacon_range: float = 8.0
    """m at which a beacon's light is lost. Assumed: clear water."""
    battery_full: float = 8.2
    """V. Assumed: two lithium cells, freshly charged."""
    battery_idle: float = 0.1 / 3600
    """V/s lost by the electronics alone. Assumed."""
    battery_motors: float = 1.0 / 3600
    """V/s lost besides when all four fins are driven fully. Assumed."""

    # The surroundings
    density: float = 1000.0
    """kg/m³. Chosen: fresh water."""
    gravity: float = 9.81
    """m/s². Chosen."""
    surface_pressure: float = 101325.0
    """Pa. Chosen: the standard atmosphere."""
    temperature: float = 15.0
    """°C. Chosen."""
    surface_damping: float = 40.0
    """N s/m, of the waves of a hull that breaks the surface. Assumed: about half of critical."""
    floor: float = 3.0
    """m, depth of the floor at the start. Chosen, as is that there are no walls, no current and no waves."""
    beacons: tuple[Vector, ...] = ((3.0, 0.0, 0.5),)
    """m north, east, down of the light beacons at the start. Chosen."""

    def __post_init__(self) -> None:
        positive = ("mass", "buoyancy", "fin_area", "fin_centre", "density", "gravity", "floor")
        for name in positive:
            if not getattr(self, name) > 0:
                raise ValueError(f"simulation parameter {name} is {getattr(self, name)}; it must be above 0")
        if not all(value > 0 for value in self.inertia) or not all(value >= 0 for value in self.added_mass):
            raise ValueError("simulation parameters inertia must be above 0, added_mass not below 0")
        if not all(length > 0 for length in self.size):
            raise ValueError(f"simulation parameter size is {self.size}; each length must be above 0")
        if not 0 <= self.restitution <= 1 or not self.friction >= 0:
            raise ValueError("simulation parameter restitution must be 0 to 1, friction not below 0")
        if self.floor <= self.height:
            raise ValueError(f"the floor at {self.floor} m leaves no room for a hull of {self.height} m")

    @property
    def height(self) -> float:
        """m, of the upright hull."""
        return self.size[2]

    @property
    def weight(self) -> float:
        """N."""
        return self.mass * self.gravity

    @property
    def total_mass(self) -> Six:
        """kg and kg m²: the hull's own mass and inertia with the water that must move along."""
        own = (self.mass, self.mass, self.mass, *self.inertia)
        surge, sway, heave, roll, pitch, yaw = (a + b for a, b in zip(own, self.added_mass, strict=True))
        return surge, sway, heave, roll, pitch, yaw

    @property
    def thrust_coefficient(self) -> float:
        """C_T of a fin's thrust ½ρ·C_T·S·(r_c·θ̇)².

        For θ = a·sin(2πft) the mean of θ̇²·cos θ along the mount is a·(2πf)²·J₁(a), J₁ being Bessel's. Set
        equal to the published mean thrust 8ρ·C_d·S·r_c²·π²f²·(1 - cos 2a), where 2a is the amplitude from
        peak to peak, that gives C_T = 4·C_d·(1 - cos 2a) / (a·J₁(a)): 13.95·C_d at the largest, 2a = 1.6 rad.
        """
        return self.fin_thrust_per_drag * self.fin_drag

    @property
    def fin_directions(self) -> tuple[tuple[float, float], ...]:
        """From shaft to tip at angle 0, forward and right: outwards, and towards the middle of the hull."""
        along, across = cos(self.fin_mount), sin(self.fin_mount)
        return tuple(
            (-along if x > 0 else along, across if y > 0 else -across) for x, y in self.fin_positions
        )
