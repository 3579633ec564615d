"""Named colours as ranges of hue, saturation and value, the way OpenCV counts them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

from robot_runtime.config import ConfigError

Pair = tuple[int, int]

HUE_MAX = 179
"""OpenCV halves the colour circle's 360° so that a hue fits a byte."""
BYTE_MAX = 255


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourRange:
    """What counts as one colour: lowest and highest hue, saturation and value, both included.

    A hue range whose first number is above its second runs through 0, where red lies.
    """

    hue: Pair
    saturation: Pair
    value: Pair

    @property
    def middle(self) -> tuple[int, int, int]:
        """Hue, saturation and value in the middle of the ranges."""
        low, high = self.hue
        span = (high - low) % (HUE_MAX + 1)
        return (low + span // 2) % (HUE_MAX + 1), sum(self.saturation) // 2, sum(self.value) // 2


DEFAULTS: Mapping[str, ColourRange] = {
    "red": ColourRange(hue=(170, 10), saturation=(120, 255), value=(70, 255)),
    "yellow": ColourRange(hue=(20, 35), saturation=(100, 255), value=(70, 255)),
    "green": ColourRange(hue=(40, 85), saturation=(80, 255), value=(50, 255)),
    "blue": ColourRange(hue=(104, 130), saturation=(140, 255), value=(70, 255)),
}
"""Taken where the configuration names no colours; docs/vision.md tells how they were chosen."""


def parse_colours(table: Mapping[str, Mapping[str, Sequence[int]]]) -> dict[str, ColourRange]:
    """The colours of a configuration, or the defaults where it has none.

    Raises ConfigError, naming the entry, where a range is missing, unknown or impossible.
    """
    return {name: _parse_colour(name, ranges) for name, ranges in table.items()} or dict(DEFAULTS)


def _parse_colour(name: str, ranges: Mapping[str, Sequence[int]]) -> ColourRange:
    where = f"vision.colours.{name}"
    wanted = {field.name for field in fields(ColourRange)}
    if set(ranges) != wanted:
        raise ConfigError(
            f"{where} has {', '.join(ranges) or 'nothing'}; it must have hue, saturation and value"
        )
    hue = _parse_pair(where, "hue", ranges["hue"], HUE_MAX)
    saturation = _parse_pair(where, "saturation", ranges["saturation"], BYTE_MAX)
    value = _parse_pair(where, "value", ranges["value"], BYTE_MAX)
    for what, (low, high) in (("saturation", saturation), ("value", value)):
        if low > high:
            raise ConfigError(
                f"{where}: {what} is [{low}, {high}]; only a hue range may run backwards, through 0"
            )
    return ColourRange(hue=hue, saturation=saturation, value=value)


def _parse_pair(where: str, what: str, numbers: Sequence[int], maximum: int) -> Pair:
    whole = all(isinstance(number, int) and not isinstance(number, bool) for number in numbers)
    if len(numbers) != 2 or not whole or not all(0 <= number <= maximum for number in numbers):
        raise ConfigError(
            f"{where}: {what} is {list(numbers)}; it must be two whole numbers from 0 to {maximum}"
        )
    return numbers[0], numbers[1]
