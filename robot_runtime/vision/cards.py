"""The cards that can be shown to the camera: coloured ones, and one with a marker."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.card_colours import MARKER_CARD, PAINTS, WHITE, Paint
from robot_runtime.contract.vision_settings import ColourRange, marker_name

MARKER_DICTIONARY = cv2.aruco.DICT_4X4_50
MARKER_CELLS = 6
"""Cells along each side, with the black border."""
MARKER_SIDE = 0.8
"""Side of the marker as a share of the card's width."""


@dataclass(frozen=True, slots=True)
class CameraCard:
    """A card: its blue, green and red in daylight; `marked`: the marker is printed on it."""

    name: str
    paint: Paint
    marked: bool = False


def make_card(name: str, colours: Mapping[str, ColourRange]) -> CameraCard:
    """Return the card of this name; without a paint it has the middle of the range. Raise KeyError."""
    if name == marker_name(MARKER_CARD):
        return CameraCard(name, WHITE, marked=True)
    if name in PAINTS:
        return CameraCard(name, PAINTS[name])
    middle = np.array([[colours[name].middle]], np.uint8)
    blue, green, red = cv2.cvtColor(middle, cv2.COLOR_HSV2BGR)[0, 0].tolist()
    return CameraCard(name, (blue, green, red))


@cache
def marker_pattern() -> NDArray[np.uint8]:
    """Return the printed marker, one pixel a cell: 0 black, 255 white."""
    dictionary = cv2.aruco.getPredefinedDictionary(MARKER_DICTIONARY)
    pattern = cv2.aruco.generateImageMarker(dictionary, MARKER_CARD, MARKER_CELLS)
    return pattern.astype(np.uint8, copy=False)
