"""Settings of water and hull that may change while it swims; each is checked at construction."""

from dataclasses import dataclass, field, replace
from math import hypot
from typing import Self

from robot_runtime.contract.craft import Craft, Vector

CURRENT_MAX = 2.0
"""m/s; ten times the robot's speed."""
TURNING_MAX = 1.0
"""rad/s."""
PERIOD_MIN, PERIOD_MAX = 0.8, 30.0
"""s. Waves of 0.8 s are 1 m long, four times the hull; shorter ones vary too much along the hull."""
AMPLITUDE_MAX = 10.0
"""m."""
DIRECTION_MAX = 6.2832
"""rad; a full turn either way."""
BUOYANCY_MIN, BUOYANCY_MAX = 0.9, 1.1
OFFSET_MAX = 0.05
"""m; farther the centre of buoyancy would leave the hull."""
DEPTH_MIN, DEPTH_MAX = 0.5, 1000.0
SIDE_MIN, SIDE_MAX = 1.0, 1000.0
"""m."""
BEACONS_MAX = 8
FAR = 1000.0
"""m from the start beyond which no beacon is placed."""


@dataclass(frozen=True, slots=True)
class Current:
    """The water's steady flow, the same everywhere. Raises ValueError beyond 2 m/s or 1 rad/s."""

    north: float = field(default=0.0, metadata={"description": "m/s"})
    east: float = field(default=0.0, metadata={"description": "m/s"})
    down: float = field(default=0.0, metadata={"description": "m/s"})
    turning: float = field(
        default=0.0,
        metadata={"description": "rad/s at which its direction turns, from north to east, from its start on"},
    )

    def __post_init__(self) -> None:
        parts = (self.north, self.east, self.down)
        if not all(abs(part) <= CURRENT_MAX for part in parts) or hypot(*parts) > CURRENT_MAX:
            raise ValueError(f"a current must be finite and at most {CURRENT_MAX:g} m/s in all")
        _limit("a current's turning", self.turning, -TURNING_MAX, TURNING_MAX, "rad/s")


@dataclass(frozen=True, slots=True)
class Waves:
    """One regular wave. Raises ValueError on impossible numbers; see also `World.set_waves`."""

    amplitude: float = field(
        default=0.0,
        metadata={"description": "m, half of the height from trough to crest; 0: still water"},
    )
    period: float = field(default=2.0, metadata={"description": "s, in the earth-fixed frame"})
    direction: float = field(
        default=0.0, metadata={"description": "rad from north to east, towards which it runs"}
    )

    def __post_init__(self) -> None:
        _limit("a wave's amplitude", self.amplitude, 0.0, AMPLITUDE_MAX, "m")
        _limit("a wave's period", self.period, PERIOD_MIN, PERIOD_MAX, "s")
        _limit("a wave's direction", self.direction, -DIRECTION_MAX, DIRECTION_MAX, "rad")


@dataclass(frozen=True, slots=True)
class Trim:
    """The trim of the hull, set by ballast and foam. Raises ValueError beyond its limits.

    A trim weight of w (N) that is moved by d (m) has the same effect as moving the centre of buoyancy by
    -d·w / weight.
    """

    buoyancy: float = field(metadata={"description": "under water, as a share of the weight, 0.9 to 1.1"})
    forward: float = field(metadata={"description": "m, centre of buoyancy from centre of mass, up to 0.05"})
    right: float = field(metadata={"description": "m, as forward"})
    above: float = field(metadata={"description": "m, as forward; below 0 it capsizes"})

    @classmethod
    def of(cls, craft: Craft) -> Self:
        """Return the craft's own trim."""
        return cls(craft.buoyancy, craft.buoyancy_forward, craft.buoyancy_right, craft.buoyancy_height)

    def on(self, craft: Craft) -> Craft:
        """Return the craft with this trim."""
        return replace(
            craft,
            buoyancy=self.buoyancy,
            buoyancy_forward=self.forward,
            buoyancy_right=self.right,
            buoyancy_height=self.above,
        )

    def __post_init__(self) -> None:
        _limit("buoyancy", self.buoyancy, BUOYANCY_MIN, BUOYANCY_MAX, "times the weight")
        for name in ("forward", "right", "above"):
            _limit(f"the centre of buoyancy's {name}", getattr(self, name), -OFFSET_MAX, OFFSET_MAX, "m")


@dataclass(frozen=True, slots=True)
class StartPose:
    """Pose of the hull at time 0, at rest. Raises ValueError beyond its limits."""

    north: float = 0.0
    east: float = 0.0
    """m, at most 1000 each."""
    down: float | None = None
    """m, of the centre of mass; None: it floats."""
    heading: float = 0.0
    """rad from north to east."""

    def __post_init__(self) -> None:
        _limit("the start's north", self.north, -FAR, FAR, "m")
        _limit("the start's east", self.east, -FAR, FAR, "m")
        if self.down is not None:
            _limit("the start's down", self.down, 0.0, DEPTH_MAX, "m")
        _limit("the start's heading", self.heading, -DIRECTION_MAX, DIRECTION_MAX, "rad")


@dataclass(frozen=True, slots=True)
class Basin:
    """The basin: a floor, and four walls or none. Raises ValueError beyond its limits."""

    depth: float
    """m."""
    length: float | None = None
    """m from south wall to north wall, the start in the middle; None: no walls."""
    width: float | None = None
    """m from west wall to east wall, as `length`; both or neither."""

    def __post_init__(self) -> None:
        _limit("the water's depth", self.depth, DEPTH_MIN, DEPTH_MAX, "m")
        if (self.length is None) != (self.width is None):
            raise ValueError("a pool has both length and width, open water neither")
        if self.length is not None and self.width is not None:
            _limit("a pool's length", self.length, SIDE_MIN, SIDE_MAX, "m")
            _limit("a pool's width", self.width, SIDE_MIN, SIDE_MAX, "m")


def check_start(start: StartPose, basin: Basin, size: Vector) -> None:
    """Raise ValueError if a hull of this size (m) would be in the floor or in a wall."""
    reach = max(size) / 2
    if start.down is not None and start.down + size[2] / 2 > basin.depth:
        raise ValueError(f"a start at {start.down:g} m is in the floor, which is at {basin.depth:g} m")
    for name, coordinate, side in (("north", start.north, basin.length), ("east", start.east, basin.width)):
        if side is not None and abs(coordinate) + reach > side / 2:
            raise ValueError(f"a start {coordinate:g} m {name} is in a wall, which is at {side / 2:g} m")


def check_beacons(positions: tuple[Vector, ...]) -> None:
    """Raise ValueError on more than eight beacons, or one farther than 1000 m north, east or down."""
    if len(positions) > BEACONS_MAX:
        raise ValueError(f"{len(positions)} beacons; there can be at most {BEACONS_MAX}")
    for position in positions:
        for name, value in zip(("north", "east", "down"), position, strict=True):
            _limit(f"a beacon's {name}", value, -FAR, FAR, "m")


def _limit(name: str, value: float, least: float, most: float, unit: str) -> None:
    if not least <= value <= most:
        raise ValueError(f"{name} is {value:g} {unit}; it must be between {least:g} and {most:g}")


FLOATING = StartPose()
