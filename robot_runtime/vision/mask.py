"""The mask as a picture for a person: what has the colour, and what of it counts."""

import cv2
import numpy as np

from robot_runtime.vision.patches import Patches
from robot_runtime.vision.picture import Picture

GROUND = (23, 17, 10)
"""Blue, green and red, as all below."""
DROPPED = (96, 88, 80)
"""Has the colour and does not count."""
COUNTED = (243, 238, 230)
OUTLINE = (180, 198, 53)
OUTLINE_REFUSED = (41, 180, 240)


def draw_mask(patches: Patches) -> Picture:
    """The mask with the outlines of the largest patches, BGR, uint8 of shape (height, width, 3)."""
    height, width = patches.mask.shape
    picture = np.full((height, width, 3), GROUND, np.uint8)
    picture[patches.mask > 0] = DROPPED
    inside = np.zeros((height, width), np.uint8)
    counting = [contour for _, contour in patches.counting]
    cv2.drawContours(inside, counting, -1, 255, cv2.FILLED)
    picture[cv2.bitwise_and(inside, patches.mask) > 0] = COUNTED
    thickness = max(1, round(width / 240))
    for candidate, contour in zip(patches.candidates, patches.contours, strict=True):
        colour = OUTLINE_REFUSED if candidate.refused else OUTLINE
        cv2.drawContours(picture, [contour], -1, colour, thickness)
    return picture
