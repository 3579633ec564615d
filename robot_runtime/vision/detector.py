"""The search for a colour: BGR to HSV, a mask of the colour, its largest patch (thesis, section 4.2)."""

from collections.abc import Mapping
from typing import NamedTuple

import cv2
import numpy as np

from robot_runtime.samples import Box
from robot_runtime.vision.colours import HUE_MAX, ColourRange
from robot_runtime.vision.picture import Picture


class Patch(NamedTuple):
    """A patch of one colour; `area` and the box are shares of the picture."""

    colour: str
    box: Box
    area: float


class Detector:
    """Finds patches of the named colours that cover at least `area_min` of the picture (a share, 0 to 1)."""

    def __init__(self, colours: Mapping[str, ColourRange], area_min: float) -> None:
        self._colours = colours
        self.area_min = area_min

    def find(self, picture: Picture, wanted: str) -> Patch | None:
        """The largest patch of the wanted colour or, without one, of any other; BGR (height, width, 3)."""
        hsv = cv2.cvtColor(picture, cv2.COLOR_BGR2HSV).astype(np.uint8, copy=False)
        patch = self._largest(hsv, wanted)
        if patch is not None:
            return patch
        others = (self._largest(hsv, name) for name in self._colours if name != wanted)
        return max(filter(None, others), key=lambda other: other.area, default=None)

    def _largest(self, hsv: Picture, name: str) -> Patch | None:
        height, width = hsv.shape[:2]
        mask = find_colour(hsv, self._colours[name])
        if cv2.countNonZero(mask) < self.area_min * width * height:
            return None
        # Opening removes specks, which noise makes, and keeps patches as they are.
        size = max(3, width // 100 | 1)
        opened = cv2.morphologyEx(
            mask, cv2.MORPH_OPEN, cv2.getStructuringElement(cv2.MORPH_RECT, (size, size))
        )
        contours, _ = cv2.findContours(opened, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        if not contours:
            return None
        largest = max(contours, key=cv2.contourArea)
        area = cv2.contourArea(largest) / (width * height)
        if area < self.area_min:
            return None
        x, y, w, h = cv2.boundingRect(largest)
        return Patch(name, Box(x=x / width, y=y / height, width=w / width, height=h / height), area)


def find_colour(hsv: Picture, colour: ColourRange) -> Picture:
    """255 where the HSV picture (height, width, 3) has this colour, 0 elsewhere; (height, width)."""
    low, high = colour.hue
    if low <= high:
        return _between(hsv, colour, low, high)
    return _between(hsv, colour, low, HUE_MAX) | _between(hsv, colour, 0, high)


def _between(hsv: Picture, colour: ColourRange, hue_low: int, hue_high: int) -> Picture:
    lows = (hue_low, colour.saturation[0], colour.value[0])
    highs = (hue_high, colour.saturation[1], colour.value[1])
    return cv2.inRange(hsv, lows, highs).astype(np.uint8, copy=False)
