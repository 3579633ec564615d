"""Pictures of any camera or file in the configured size, without squeezing them."""

import cv2
import numpy as np

from robot_runtime.contract.vision_settings import Turn
from robot_runtime.vision.picture import Picture

_ROTATIONS = {90: cv2.ROTATE_90_CLOCKWISE, 180: cv2.ROTATE_180, 270: cv2.ROTATE_90_COUNTERCLOCKWISE}


def fit(picture: Picture, width: int, height: int) -> Picture:
    """Return the largest middle part of a picture with the shape of `width` × `height`, scaled to that.

    A circle stays a circle, so that limits of shape and area hold. Bars at the sides would do that, too, but
    count as dark water in the white balance and in a patch's share of the picture.
    """
    there, across = picture.shape[:2]
    if (across, there) == (width, height):
        return picture
    wide, high = min(across, round(there * width / height)), min(there, round(across * height / width))
    left, top = (across - wide) // 2, (there - high) // 2
    middle = picture[top : top + max(high, 1), left : left + max(wide, 1)]
    # Of fewer pixels each is a mean of those it covers; of more they are interpolated.
    way = cv2.INTER_AREA if wide > width else cv2.INTER_LINEAR
    return cv2.resize(middle, (width, height), interpolation=way).astype(np.uint8, copy=False)


def describe_fit(given: tuple[int, int], width: int, height: int) -> str:
    """Return the effect of `fit` on pictures of `given` width and height as text; empty without any."""
    across, there = given
    if given == (width, height):
        return ""
    done = "scaled" if across * height == there * width else "cropped and scaled"
    return f"{across} × {there}, {done} to {width} × {height}"


def turn(picture: Picture, degrees: Turn, mirror: bool) -> Picture:
    """Return a picture turned clockwise by `degrees`, then mirrored left to right."""
    if degrees:
        picture = cv2.rotate(picture, _ROTATIONS[degrees]).astype(np.uint8, copy=False)
    return cv2.flip(picture, 1).astype(np.uint8, copy=False) if mirror else picture


def before_turn(size: tuple[int, int], degrees: Turn) -> tuple[int, int]:
    """Return the width and height that a picture of `size` has before it is turned by `degrees`."""
    width, height = size
    return (height, width) if degrees in (90, 270) else size
