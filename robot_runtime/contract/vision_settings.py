"""Settings of the vision node. All of them may change while it runs."""

import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Annotated, Any, Literal

from robot_runtime.contract.limits import SET_POINT, VISION_RATE, ConfigError, Range

HUE_MAX = 179
"""OpenCV halves the colour circle's 360° so that a hue fits a byte."""
BYTE_MAX = 255

Hue = Annotated[int, Range(0, HUE_MAX)]
Byte = Annotated[int, Range(0, BYTE_MAX)]
Share = Annotated[float, Range(0, 1)]
Area = Annotated[float, Range(0.0001, 1)]
Aspect = Annotated[float, Range(0.05, 20)]
MarkerNumber = Annotated[int, Range(0, 1023)]
PICTURES_MAX = 10
"""Pictures that may vote on a sighting."""
PictureCount = Annotated[int, Range(1, PICTURES_MAX)]
WhiteBalance = Literal["none", "grey_world", "underwater"]
Turn = Literal[0, 90, 180, 270]
"""° clockwise by which the camera's picture is turned."""
Exposure = Annotated[float, Range(0, 500)]
"""ms; 0: automatic."""
Gain = Annotated[float, Range(0, 1000)]
"""Of the sensor, in the camera's own unit; 0: automatic."""
ColourTemperature = Annotated[int, Range(0, 10_000)]
"""K of the light that counts as white; 0: automatic."""
MarkerDictionary = Literal["none", "4x4_50", "5x5_100", "6x6_250", "7x7_1000", "original", "april_36h11"]
MARKER_COUNTS: Mapping[MarkerDictionary, int] = {
    "none": 0,
    "4x4_50": 50,
    "5x5_100": 100,
    "6x6_250": 250,
    "7x7_1000": 1000,
    "original": 1024,
    "april_36h11": 587,
}
"""Markers of a dictionary; their numbers count from 0."""

NAME = re.compile(r"[^\W\d_][\w .-]{0,31}")
"""A colour's name: a letter, then up to 31 letters, digits, blanks and . _ -"""
MARKER = re.compile(r"marker (0|[1-9]\d{0,3})")
"""The name of a marker in `actions`."""
COLOURS_MAX = 16
MARKERS_MAX = 64

SINCE_0_2 = ("confirmation", "turn", "mirror", "exposure", "gain", "colour_temperature")
"""Settings that a client of version 0.2 does not send."""


def marker_name(number: int) -> str:
    """Return the name of the marker with this number."""
    return f"marker {number}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourRange:
    """The range of one colour: lowest and highest hue, saturation and value, both included.

    A hue range whose first number is above its second runs through 0, where red lies. Raises ValueError
    where another one does.
    """

    hue: tuple[Hue, Hue]
    saturation: tuple[Byte, Byte]
    value: tuple[Byte, Byte]

    def __post_init__(self) -> None:
        for what, (low, high) in (("saturation", self.saturation), ("value", self.value)):
            if low > high:
                raise ValueError(f"{what} is [{low}, {high}]; only a hue range may run backwards, through 0")

    @property
    def middle(self) -> tuple[int, int, int]:
        """Hue, saturation and value in the middle of the ranges."""
        low, high = self.hue
        span = (high - low) % (HUE_MAX + 1)
        return (low + span // 2) % (HUE_MAX + 1), sum(self.saturation) // 2, sum(self.value) // 2


COLOURS: Mapping[str, ColourRange] = {
    "red": ColourRange(hue=(170, 10), saturation=(120, 255), value=(70, 255)),
    "yellow": ColourRange(hue=(20, 35), saturation=(100, 255), value=(70, 255)),
    "green": ColourRange(hue=(40, 85), saturation=(80, 255), value=(50, 255)),
    "blue": ColourRange(hue=(104, 130), saturation=(140, 255), value=(70, 255)),
}
"""The colours of a configuration without any; docs/use/vision.md explains the choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionSettings:
    """Rate in Hz; areas as shares of the picture, `opening` as a share of its width.

    `colour` is the target colour, whose mask is shown. A patch counts if its area, its fill (area over that
    of its upright box), its aspect (the box's width over height) and its circularity (4π·area over
    perimeter²; 1: a circle) lie within these limits. Without `marker_numbers` every marker of the dictionary
    counts. `actions` are set points (m) while a colour or `marker 7` is seen. With `confirmation` (2, 3) it
    is seen while at least 2 of the last 3 pictures show it. The picture is turned clockwise by `turn` °,
    then mirrored left to right. `exposure` (ms), `gain` and `colour_temperature` (K) fix what a Pi or USB
    camera else chooses by itself; 0 leaves it to the camera. Raises ConfigError on settings that contradict
    each other.
    """

    rate: Annotated[float, VISION_RATE] = 4.0
    colour: str = "yellow"
    colours: dict[str, ColourRange] = field(default_factory=lambda: dict(COLOURS))
    area_min: Area = 0.01
    area_max: Area = 1.0
    fill_min: Share = 0.0
    aspect: tuple[Aspect, Aspect] = (0.05, 20.0)
    circularity_min: Share = 0.0
    opening: Annotated[float, Range(0, 0.1)] = 0.01
    confirmation: tuple[PictureCount, PictureCount] = (2, 3)
    white_balance: WhiteBalance = "none"
    markers: MarkerDictionary = "none"
    marker_numbers: tuple[MarkerNumber, ...] = ()
    actions: dict[str, Annotated[float, SET_POINT]] = field(default_factory=dict)
    turn: Turn = 0
    mirror: bool = False
    exposure: Exposure = 0.0
    gain: Gain = 0.0
    colour_temperature: ColourTemperature = 0

    def __post_init__(self) -> None:
        problems = [*self._colour_problems(), *self._filter_problems(), *self._action_problems()]
        if problems:
            raise ConfigError(*(f"vision: {problem}" for problem in problems))

    def table(self) -> dict[str, Any]:
        """Return the settings as a file has them, with lists and tables."""
        table: dict[str, Any] = json.loads(json.dumps(asdict(self)))
        return table

    def _colour_problems(self) -> list[str]:
        problems = [
            f"a colour is named {name!r}; a name is a letter and up to 31 letters, digits, blanks and . _ -"
            for name in self.colours
            if not NAME.fullmatch(name)
        ]
        problems += [
            f"a colour is named {name!r}, which names a marker"
            for name in self.colours
            if MARKER.fullmatch(name)
        ]
        if not 1 <= len(self.colours) <= COLOURS_MAX:
            problems.append(f"there are {len(self.colours)} colours; there must be 1 to {COLOURS_MAX}")
        elif self.colour not in self.colours:
            problems.append(f"colour is {self.colour!r}; it must be one of {', '.join(self.colours)}")
        return problems

    def _filter_problems(self) -> list[str]:
        problems = []
        if self.area_min > self.area_max:
            problems.append(f"area_min is {self.area_min:g}, above area_max, which is {self.area_max:g}")
        if self.aspect[0] > self.aspect[1]:
            problems.append(f"aspect is [{self.aspect[0]:g}, {self.aspect[1]:g}]; it cannot run backwards")
        if self.confirmation[0] > self.confirmation[1]:
            needed, pictures = self.confirmation
            problems.append(
                f"confirmation is [{needed}, {pictures}]; its first number cannot be above its second"
            )
        if len(self.marker_numbers) > MARKERS_MAX:
            problems.append(
                f"there are {len(self.marker_numbers)} marker_numbers; there can be at most {MARKERS_MAX}"
            )
        return problems

    def _action_problems(self) -> list[str]:
        return [
            f"an action is for {name!r}, which is no colour and no marker"
            for name in self.actions
            if name not in self.colours and not MARKER.fullmatch(name)
        ]
