"""What is in the scene, checked where it is made; nothing here knows how it is drawn."""

from dataclasses import dataclass
from math import isfinite
from typing import Literal, get_args

from robot_runtime.paints import PAINTS, Paint
from robot_runtime.simulation.parameters import Parameters, Vector
from robot_runtime.simulation.scene.water import TURBIDITY_MAX, Kind
from robot_runtime.simulation.surroundings import FAR, Basin, check_beacons

TARGETS_MAX = 20
SIZE_MIN, SIZE_MAX = 0.02, 2.0
"""m."""

Shape = Literal["ball", "box"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """Something of one colour that can be looked for. Raises ValueError on what cannot be."""

    colour: str
    position: Vector
    """m north, east, down."""
    size: float = 0.2
    """m across."""
    shape: Shape = "ball"

    def __post_init__(self) -> None:
        if self.colour not in PAINTS:
            raise ValueError(f"a target's colour is {self.colour!r}; there are {', '.join(PAINTS)}")
        if self.shape not in get_args(Shape):
            raise ValueError(f"a target's shape is {self.shape!r}; there are {', '.join(get_args(Shape))}")
        if not SIZE_MIN <= self.size <= SIZE_MAX:
            raise ValueError(
                f"a target's size is {self.size:g} m; it must be between {SIZE_MIN:g} and {SIZE_MAX:g}"
            )
        if not all(isfinite(value) and abs(value) <= FAR for value in self.position):
            raise ValueError(f"a target's position must be within {FAR:g} m of the start")

    @property
    def paint(self) -> Paint:
        """Its blue, green and red."""
        return PAINTS[self.colour]


START_TARGETS = (
    Target(colour="yellow", position=(2.2, 0.5, 1.1), size=0.3),
    Target(colour="red", position=(2.8, -0.9, 0.8), size=0.26, shape="box"),
    Target(colour="green", position=(4.2, 0.4, 1.6), size=0.3, shape="box"),
    Target(colour="blue", position=(3.4, 1.4, 0.7), size=0.28),
)
"""Chosen: one of each colour ahead of the start."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contents:
    """Everything in the scene but the robot. Raises ValueError on what cannot be."""

    kind: Kind | None = None
    """None: a pool where there are walls, else a natural scene."""
    turbidity: float = 0.0
    """NTU, 0 to 20."""
    basin: Basin = Basin(Parameters().floor)
    beacons: tuple[Vector, ...] = Parameters().beacons
    targets: tuple[Target, ...] = START_TARGETS

    def __post_init__(self) -> None:
        if self.kind is not None and self.kind not in get_args(Kind):
            raise ValueError(f"the scene's kind is {self.kind!r}; there are {', '.join(get_args(Kind))}")
        if not 0 <= self.turbidity <= TURBIDITY_MAX:
            raise ValueError(
                f"the turbidity is {self.turbidity:g} NTU; it must be between 0 and {TURBIDITY_MAX:g}"
            )
        if len(self.targets) > TARGETS_MAX:
            raise ValueError(f"{len(self.targets)} targets; there can be at most {TARGETS_MAX}")
        check_beacons(self.beacons)

    @property
    def look(self) -> Kind:
        """The kind of scene that is drawn."""
        return self.kind or ("natural" if self.basin.length is None else "pool")
