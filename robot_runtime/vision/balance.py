"""White balance: the correction of the colour cast of water and light."""

from collections.abc import Callable, Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.vision_settings import BYTE_MAX, WhiteBalance
from robot_runtime.vision.picture import Picture

GAIN_MAX = 4.0
"""Largest gain of a channel; beyond it, noise dominates."""
SPARSE = 4
"""Every so many lines and columns, one is used for the means."""


def none(picture: Picture) -> Picture:
    """Return the picture unchanged."""
    return picture


def grey_world(picture: Picture) -> Picture:
    """Scale the channels to the same mean, on the assumption that the world is grey on average.

    G. Buchsbaum, A spatial processor model for object colour perception, J. Franklin Institute 310 (1980).
    BGR, uint8 of shape (height, width, 3).
    """
    means = _means(picture)
    gains = np.clip(means.mean() / np.maximum(means, 1), 1 / GAIN_MAX, GAIN_MAX)
    levels = np.arange(BYTE_MAX + 1)[:, np.newaxis] * gains
    table = np.clip(np.round(levels), 0, BYTE_MAX).astype(np.uint8)[np.newaxis]
    return cv2.LUT(picture, table).astype(np.uint8, copy=False)


def underwater(picture: Picture) -> Picture:
    """Restore lost red from green, then balance as `grey_world`. BGR, uint8 of shape (height, width, 3).

    I_r + (mean I_g - mean I_r)·(1 - I_r)·I_g with intensities from 0 to 1: C. O. Ancuti, C. Ancuti, C. De
    Vleeschouwer and P. Bekaert, Color Balance and Fusion for Underwater Image Enhancement, IEEE Transactions
    on Image Processing 27 (2018) 379, equation 4 with α = 1. Red that is not weaker than green is unchanged.
    """
    blue, green, red = cv2.split(picture)
    means = _means(picture)
    lost = max(means[1] - means[2], 0.0) / BYTE_MAX
    restored = cv2.multiply(cv2.bitwise_not(red), green, scale=lost / BYTE_MAX)
    return grey_world(cv2.merge((blue, green, cv2.add(red, restored))).astype(np.uint8, copy=False))


BALANCES: Mapping[WhiteBalance, Callable[[Picture], Picture]] = {
    "none": none,
    "grey_world": grey_world,
    "underwater": underwater,
}


def _means(picture: Picture) -> NDArray[np.float64]:
    """Return the means of blue, green and red."""
    means: NDArray[np.float64] = picture[::SPARSE, ::SPARSE].reshape(-1, 3).mean(axis=0, dtype=np.float64)
    return means
