"""The coloured cards that are held before the camera."""

import cv2
import numpy as np

from robot_runtime.paints import PAINTS, Paint
from robot_runtime.vision.colours import ColourRange


def card_paint(name: str, colour: ColourRange) -> Paint:
    """A card's blue, green and red in daylight; of the range's middle where the colour has no paint."""
    if name in PAINTS:
        return PAINTS[name]
    middle = np.array([[colour.middle]], np.uint8)
    blue, green, red = cv2.cvtColor(middle, cv2.COLOR_HSV2BGR)[0, 0].tolist()
    return blue, green, red
