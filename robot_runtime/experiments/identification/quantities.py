"""The numbers of a craft that a fit may find, and the motion that shows each of them.

Only ratios of forces to masses show in a motion: mass, added mass of heave, thrust and drag may all be larger
by the same factor, and everything moves alike. So a fit takes the mass and the added mass of heave as they
are. A mass is weighed; the added mass of heave is estimated (docs/reference/craft.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.hints import read_fields

FACTOR_SPREAD = 0.7
"""Spread (σ) of a number's logarithm before a fit: assumed numbers may be wrong by a factor of two."""


@dataclass(frozen=True, slots=True)
class CraftQuantity:
    """One number that is fitted: the entry of the craft, or one of its list.

    `spread` is the standard deviation before the fit, in the number's unit; 0: it is positive, and known to
    a factor of two.
    """

    name: str
    entry: str
    index: int | None
    unit: str
    title: str
    motion: str
    """The kind of motion that shows it, as the end of “It needs …”."""
    spread: float = 0.0

    def value(self, craft: Craft) -> float:
        """Return the number in a craft."""
        whole = getattr(craft, self.entry)
        return float(whole if self.index is None else whole[self.index])

    def put(self, craft: Craft, start: Craft, scaled: float) -> Craft:
        """Return the craft with this number, given as the scaled number."""
        before = self.value(start)
        value = before + self.spread * scaled if self.spread else before * exp(FACTOR_SPREAD * scaled)
        return self.replaced(craft, value)

    def replaced(self, craft: Craft, value: float) -> Craft:
        """Return the craft with this value, within its range."""
        low, high = self.limits
        value = min(max(value, low), high)
        if self.index is None:
            return replace(craft, **{self.entry: value})  # type: ignore[arg-type]
        whole = list(getattr(craft, self.entry))
        whole[self.index] = value
        return replace(craft, **{self.entry: tuple(whole)})  # type: ignore[arg-type]

    @property
    def limits(self) -> tuple[float, float]:
        """The range of the number in a craft file."""
        hint = read_fields(Craft)[self.entry]
        limits = (hint if self.index is None else hint.parts[self.index]).limits
        assert limits is not None
        return limits.minimum, limits.maximum

    def scaled_limits(self, start: Craft) -> tuple[float, float]:
        """Return the range as scaled numbers; a positive number's begins a hundredth of `start` above 0."""
        low, high = self.limits
        if not self.spread:
            low = max(low, 0.01 * self.value(start))
        return self._scale(low, start), self._scale(high, start)

    def _scale(self, value: float, start: Craft) -> float:
        before = self.value(start)
        return (value - before) / self.spread if self.spread else log(value / before) / FACTOR_SPREAD

    def deviation(self, scaled: float, value: float) -> float:
        """Return a standard deviation of the scaled number as one of the number itself, in its unit."""
        return scaled * (self.spread or FACTOR_SPREAD * abs(value))


_WAYS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
_MOTIONS = (
    "swimming forwards and backwards",
    "swimming sideways",
    "diving and rising",
    "rolling from side to side",
    "nodding up and down",
    "turning to both sides",
)
_FAST = tuple(f"{motion}, fast and slowly" for motion in _MOTIONS)


def _damping(entry: str, label: str, units: tuple[str, str]) -> list[CraftQuantity]:
    return [
        CraftQuantity(f"{entry}_{way}", entry, index, units[index > 2], f"{label} of {way}", _FAST[index])
        for index, way in enumerate(_WAYS)
    ]


QUANTITIES: tuple[CraftQuantity, ...] = (
    CraftQuantity("thrust", "fin_drag", None, "", "Thrust coefficient of the fins", "strokes of the fins"),
    CraftQuantity(
        "blade_drag", "fin_normal", None, "", "Drag across a fin", "fins that turn round while it swims"
    ),
    *_damping("damping_quadratic", "Quadratic damping", ("N s²/m²", "N m s²")),
    *_damping("damping_linear", "Linear damping", ("N s/m", "N m s")),
    *(
        CraftQuantity(
            f"added_mass_{_WAYS[index]}",
            "added_mass",
            index,
            "kg" if index < 3 else "kg m²",
            f"Added {'mass' if index < 3 else 'inertia'} of {_WAYS[index]}",
            _MOTIONS[index],
        )
        for index in (0, 1, 3, 4, 5)
    ),
    CraftQuantity("buoyancy", "buoyancy", None, "", "Buoyancy over weight", "drifting up and diving", 0.01),
    CraftQuantity(
        "trim_forward",
        "buoyancy_forward",
        None,
        "m",
        "Centre of buoyancy ahead",
        "hanging still, and nodding",
        0.003,
    ),
    CraftQuantity(
        "trim_right", "buoyancy_right", None, "m", "Centre of buoyancy to the right", "hanging still", 0.003
    ),
    CraftQuantity(
        "trim_height", "buoyancy_height", None, "m", "Centre of buoyancy above", "rolling and nodding"
    ),
    CraftQuantity(
        "fin_delay", "fin_delay", None, "s", "Delay of the fins' force", "strokes of the fins", 0.03
    ),
)
"""All that a fit may find, besides the offsets of the IMU."""

OFFSET_SPREADS: tuple[float, ...] = (0.1, 0.1, 0.1, 0.3, 0.3, 0.3)
"""Spread (σ) of the offsets of turn rate (rad/s) and specific force (m/s²) before a fit."""
ZERO_SPREAD = 0.005
"""rad, spread (σ) of an encoder's zero before a fit; its data sheet allows 0.0087 with a centred magnet."""


def put_all(start: Craft, quantities: Sequence[CraftQuantity], scaled: Sequence[float]) -> Craft:
    """Return the craft with all these scaled numbers."""
    craft = start
    for quantity, number in zip(quantities, scaled, strict=True):
        craft = quantity.put(craft, start, number)
    return craft
