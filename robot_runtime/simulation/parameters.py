"""Every number of the simulated robot and its water, with its origin and how far it may be trusted.

Three origins occur. *Published*: from the robot's own published code, good to some per cent. *Assumed*:
estimated from the hull's size and shape, since nobody published it; may be wrong by a factor of two.
*Chosen*: a free choice about the surroundings. Numbers of the large U-CAT (19 kg), which circulate under
this robot's name, are not used.

Fins: front right, back right, back left, front left. Body axes: forward, right, down.
"""

from dataclasses import dataclass
from math import cos, pi, sin

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameters:
    """What the physics needs to know. Raises ValueError where a number makes no physical sense."""

    # The hull
    mass: float = 3.0
    """kg. Published."""
    height: float = 0.10
    """m. Published; the hull is taken as a box of this height where it breaks the surface."""
    inertia: Vector = (0.005, 0.0169, 0.0169)
    """kg m², about forward, right, down. Assumed: a box of the hull's size and mass."""
    buoyancy: float = 1.003
    """Buoyancy under water as a share of the weight. Assumed; published is "slightly positive"."""
    buoyancy_height: float = 0.010
    """m, centre of buoyancy above the centre of mass. Assumed."""

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
    rate_noise: float = 2e-4
    """rad/s, standard deviation of each reading of the gyroscope. From the sensor's class; within 50 %."""
    force_noise: float = 1.7e-2
    """m/s², standard deviation of each reading of the accelerometer. From the sensor's class; within 50 %."""
    beacon_detector: float = pi / 4
    """rad between straight ahead and where each beacon detector looks, to its own side. Assumed."""
    beacon_view: float = pi / 3
    """rad from a detector's axis to the edge of what it sees. Assumed."""
    beacon_range: float = 8.0
    """m at which the beacon's light is lost. Assumed: clear water."""
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
    """m, depth of the floor. Chosen."""
    beacon: Vector = (3.0, 0.0, 0.5)
    """m north, east, down of the light beacon. Chosen."""

    def __post_init__(self) -> None:
        positive = ("mass", "height", "buoyancy", "fin_area", "fin_centre", "density", "gravity", "floor")
        for name in positive:
            if not getattr(self, name) > 0:
                raise ValueError(f"simulation parameter {name} is {getattr(self, name)}; it must be above 0")
        if not all(value > 0 for value in self.inertia) or not all(value >= 0 for value in self.added_mass):
            raise ValueError("simulation parameters inertia must be above 0, added_mass not below 0")
        if self.floor <= self.height:
            raise ValueError(f"the floor at {self.floor} m leaves no room for a hull of {self.height} m")

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
