"""Pictures of any camera or file in the configured size, without squeezing them."""

import cv2
import numpy as np

from robot_runtime.vision.picture import Picture


def fit(picture: Picture, width: int, height: int) -> Picture:
    """Returns the middle of a picture, as much as has the shape of `width` × `height`, scaled to that.

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
    """Returns what `fit` does with pictures of `given` width and height; empty where it does nothing."""
    across, there = given
    if given == (width, height):
        return ""
    done = "scaled" if across * height == there * width else "cropped and scaled"
    return f"{across} × {there}, {done} to {width} × {height}"
