"""The contents of the scene, checked at construction; rendering is elsewhere."""

from dataclasses import dataclass
from typing import Annotated, Literal

from robot_runtime.contract.card_colours import PAINTS, Paint
from robot_runtime.contract.limits import Range
from robot_runtime.simulation.scene.water import TURBIDITY, Kind
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import FAR, Basin, check_beacons

TARGETS_MAX = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A coloured object to search for. Raises ValueError on an unknown colour or a far position."""

    colour: str
    """One of `PAINTS`."""
    position: Vector
    """m north, east, down."""
    size: Annotated[float, Range(0.02, 2)] = 0.2
    """m across."""
    shape: Literal["ball", "box"] = "ball"

    def __post_init__(self) -> None:
        if self.colour not in PAINTS:
            raise ValueError(f"a target's colour is {self.colour!r}; it must be one of {', '.join(PAINTS)}")
        if not all(abs(value) <= FAR for value in self.position):
            raise ValueError(f"a target's position must be within {FAR:g} m of the start")

    @property
    def paint(self) -> Paint:
        """The target's blue, green and red."""
        return PAINTS[self.colour]


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneWater:
    """The kind of water and its turbidity."""

    kind: Kind | None = None
    """None: a pool if there are walls, otherwise natural."""
    turbidity: Annotated[float, TURBIDITY] = 0.1
    """0: clear; 1: visibility of 0.1 m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Targets:
    """All targets. Raises ValueError on too many."""

    targets: tuple[Target, ...]

    def __post_init__(self) -> None:
        if len(self.targets) > TARGETS_MAX:
            raise ValueError(f"{len(self.targets)} targets; there can be at most {TARGETS_MAX}")


START_BEACONS = SimulationParameters().beacons
START_BASIN = Basin(SimulationParameters().floor)
START_TARGETS = (
    Target(colour="green", position=(2.2, 0.5, 1.1), size=0.3),
    Target(colour="red", position=(2.8, -0.9, 0.8), size=0.26, shape="box"),
    Target(colour="green", position=(4.2, 0.4, 1.6), size=0.3, shape="box"),
    Target(colour="blue", position=(3.4, 1.4, 0.7), size=0.28),
)
"""The targets at the start. Chosen: ahead, in colours that the water between does not change into others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contents:
    """Everything in the scene except the robot. Raises ValueError on impossible beacons."""

    water: SceneWater = SceneWater()
    basin: Basin = START_BASIN
    beacons: tuple[Vector, ...] = START_BEACONS
    targets: tuple[Target, ...] = START_TARGETS

    def __post_init__(self) -> None:
        check_beacons(self.beacons)

    @property
    def kind(self) -> Kind:
        """The kind of scene that is drawn."""
        return self.water.kind or ("natural" if self.basin.length is None else "pool")
