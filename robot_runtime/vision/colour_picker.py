"""Proposes a colour range from a point in the picture."""

from dataclasses import dataclass
from math import ceil, floor
from typing import Annotated

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.limits import Range
from robot_runtime.contract.vision_settings import BYTE_MAX, HUE_MAX, ColourRange
from robot_runtime.errors import RefusedError
from robot_runtime.vision.patches import find_colour
from robot_runtime.vision.picture import Picture

HUES = HUE_MAX + 1
SATURATION_LEAST = 50
"""Least saturation at which the hue is meaningful; below it a pixel is grey."""
VALUE_LEAST = 30
COLOURED_LEAST = 0.6
"""Share of the pixels that must have a colour."""
PERCENTILES = (5, 95)
HUE_SPREAD_MAX = 40
"""Largest hue span between the percentiles; with more there are several colours."""
HUE_MARGIN, SATURATION_MARGIN = 5, 40
"""Margins beyond the percentiles, for changes of light, distance and noise. Chosen."""
VALUE_LEFT = 0.6
"""Lower limit of the value as a share of the picked one, since ripples focus the light. Chosen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PickPoint:
    """A point in the picture: shares of width and height, and a radius as a share of the width."""

    x: Annotated[float, Range(0, 1)]
    y: Annotated[float, Range(0, 1)]
    radius: Annotated[float, Range(0.005, 0.2)] = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourProposal:
    """A proposed range, and the share of the whole picture that it covers."""

    colour: ColourRange
    share: float


def propose(picture: Picture, point: PickPoint) -> ColourProposal:
    """Return the colour range around a point of a BGR picture (height, width, 3).

    Raise RefusedError if there is no colour, or more than one.
    """
    hsv = cv2.cvtColor(picture, cv2.COLOR_BGR2HSV).astype(np.uint8, copy=False)
    colour = range_of(_around(hsv, point))
    return ColourProposal(colour=colour, share=cv2.countNonZero(find_colour(hsv, colour)) / hsv[..., 0].size)


def range_of(pixels: NDArray[np.uint8]) -> ColourRange:
    """Return the range of these HSV pixels (number, 3) without the outermost. Raise RefusedError."""
    coloured = pixels[(pixels[:, 1] >= SATURATION_LEAST) & (pixels[:, 2] >= VALUE_LEAST)]
    if len(coloured) < COLOURED_LEAST * len(pixels):
        saturation, value = np.median(pixels[:, 1:], axis=0)
        what = "too dark" if value < VALUE_LEAST else "grey"
        raise RefusedError(
            f"There is no colour at this place: it is {what} (saturation {saturation:.0f}, value {value:.0f} "
            f"of {BYTE_MAX}). Point at something coloured; nothing was changed."
        )
    low, high = _hues(coloured[:, 0])
    saturation_low, value_low = np.percentile(coloured[:, 1:], PERCENTILES[0], axis=0)
    return ColourRange(
        hue=(low, high),
        saturation=(max(floor(saturation_low) - SATURATION_MARGIN, SATURATION_LEAST), BYTE_MAX),
        value=(max(floor(VALUE_LEFT * value_low), VALUE_LEAST), BYTE_MAX),
    )


def _hues(hues: NDArray[np.uint8]) -> tuple[int, int]:
    """Return the lowest and the highest hue on the circle, with a margin."""
    angles = hues * (2 * np.pi / HUES)
    middle = np.arctan2(np.sin(angles).mean(), np.cos(angles).mean()) * HUES / (2 * np.pi)
    beside = (hues - middle + HUES / 2) % HUES - HUES / 2
    low, high = np.percentile(beside, PERCENTILES)
    if high - low > HUE_SPREAD_MAX:
        raise RefusedError(
            f"There are several colours at this place: hues over {high - low:.0f} of {HUES}. Point at one of "
            "them, or take a smaller radius; nothing was changed."
        )
    return (
        (floor(middle + low) - HUE_MARGIN) % HUES,
        (ceil(middle + high) + HUE_MARGIN) % HUES,
    )


def _around(hsv: Picture, point: PickPoint) -> NDArray[np.uint8]:
    height, width = hsv.shape[:2]
    x, y = min(int(point.x * width), width - 1), min(int(point.y * height), height - 1)
    disc = np.zeros((height, width), np.uint8)
    cv2.circle(disc, (x, y), max(2, round(point.radius * width)), 255, cv2.FILLED)
    return hsv[disc > 0]
