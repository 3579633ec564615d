"""The numbers of the simulated robot and its water: those of a craft, and those of its surroundings.

A craft's numbers, with their origins, are in `robot_runtime/contract/craft.py`. Of the rest, *assumed* ones
are estimates, and *chosen* ones a free choice about the surroundings.
"""

from dataclasses import dataclass, field, fields
from math import pi
from typing import Self

from robot_runtime.contract.battery_pack import CAPACITY
from robot_runtime.contract.craft import Craft, SensorQuality, Six, Vector

__all__ = ["SensorQuality", "SimulationParameters", "Six", "Vector"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationParameters(Craft):
    """The parameters of the physics. Raises ValueError for a physically impossible number."""

    beacon_right: SensorQuality = field(default=SensorQuality(rate=20.0, latency=0.05, noise=0.02))
    beacon_left: SensorQuality = field(default=SensorQuality(rate=20.0, latency=0.05, noise=0.02))
    """Share of range and view by which it sees or misses; the reading is whether that is above 0. Assumed
    throughout: nothing of the tone detectors is published; within a factor of three."""
    battery: SensorQuality = field(default=SensorQuality(rate=100.0, noise=5e-3, bias=2e-2, step=10 / 1023))
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
    battery_capacity: float = CAPACITY
    """Ah. Of the reference robot's cells."""

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
        Craft.__post_init__(self)
        for name in ("density", "gravity", "floor", "battery_capacity"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be above 0")
        if self.floor <= self.height:
            raise ValueError(f"the floor at {self.floor} m leaves no room for a hull of {self.height} m")

    @classmethod
    def of(cls, craft: Craft) -> Self:
        """Return the parameters of this craft in the default water."""
        return cls(**{field.name: getattr(craft, field.name) for field in fields(Craft)})

    @property
    def fin_load(self) -> float:
        """The torque by which the water resists a turning fin, over that of the published fin in fresh water.

        By strips of a blade of the same shape: ½ρ·C_N·S·R³/4, with R in proportion to the fin's centre.
        """
        published = SimulationParameters()
        own, usual = (
            numbers.density * numbers.fin_normal * numbers.fin_area * numbers.fin_centre**3
            for numbers in (self, published)
        )
        return own / usual

    @property
    def craft(self) -> Craft:
        """The numbers of the craft alone."""
        return Craft(**{field.name: getattr(self, field.name) for field in fields(Craft)})

    @property
    def weight(self) -> float:
        """The hull's weight, N."""
        return self.mass * self.gravity
