"""Optics of water: absorption, backscatter, caustics, blur and noise."""

from functools import cache
from math import radians, tan
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.simulation.scene import textures
from robot_runtime.simulation.scene.water import WaterOptics
from robot_runtime.simulation.water.geometry import Matrix
from robot_runtime.simulation.water.parameters import Vector

Picture = NDArray[np.uint8]
Floats = NDArray[np.float32]

CAUSTICS_SIZE = 1.1
"""m that one caustic texture covers."""
CAUSTICS_DRIFT = (0.11, 0.07), (-0.09, 0.10)
"""m/s north and east of two such textures; light is the lower of the two."""
CAUSTICS_DEPTH = 3.0
"""m of depth over which caustics fade to 1/e."""
CAUSTICS_DISTANCE = 6.0
"""m from the camera over which they fade to 1/e."""
CAUSTICS_FAR = 15.0
"""m from the camera beyond which they do not change."""
CAUSTICS_BEGIN = 0.3
"""m of depth at which they are strongest."""
SUN = (0.25, -0.2)
"""m north and east of the sunlight's path per m down."""
UPWARDS = 0.35
"""Share by which the water's own light is brighter straight up and darker straight down."""
SKY = 246.0
"""Brightness of the sky through the surface, 0 to 255, of each colour."""
SNELL, SNELL_RIM = 0.661, 0.05
"""Sine of the elevation above which the surface is transparent, and its edge; critical angle 48.6°."""
SURFACE_NEAR = 0.05
"""m from still water within which a visible point belongs to the surface."""
NOISE_SHIFT = 64
"""Pixels by which the array of noise is larger than the picture."""
LENS = 0.6
"""Pixels, standard deviation of the lens's point spread function. Assumed."""
BLUR = 5
"""Pixels of the half-size picture over which scattered light spreads."""


class UnderwaterOptics:
    """The optics of water for pictures of `width` × `height` pixels with this vertical field of view (°)."""

    def __init__(self, width: int, height: int, field_of_view: float) -> None:
        self._size = (width, height)
        upright = tan(radians(field_of_view) / 2)
        down = upright * ((2 * np.arange(height, dtype=np.float32) + 1) / height - 1)
        right = upright * width / height * ((2 * np.arange(width, dtype=np.float32) + 1) / width - 1)
        self._right, self._down = (grid.astype(np.float32) for grid in np.meshgrid(right, down))
        self._stretch: Floats = np.sqrt(1 + self._right**2 + self._down**2)
        """Distance over depth, as depth is measured along the camera's axis."""
        self._half = (max(width // 2, 1), max(height // 2, 1))
        self._half_rays = [
            _floats(cv2.resize(grid, self._half, interpolation=cv2.INTER_NEAREST))
            for grid in (self._right, self._down)
        ]

    def apply(
        self,
        picture: Picture,
        depth: Floats,
        water: WaterOptics,
        position: Vector,
        axes: Matrix,
        time: float,
        noise: float,
    ) -> Picture:
        """Return the picture as seen through water, uint8 of shape (height, width, 3), blue, green, red.

        `depth` (m) is measured along the camera's axis. `position` (m) and `axes`, from forward, right, down
        to world axes, are the camera's pose. `noise` is the standard deviation of a byte.
        """
        light = self._light(depth, water, position, axes, time)
        up = self._up(axes)
        glow = 1 + np.float32(UPWARDS) * up
        sky = self._sky(up, depth, position)
        distance = depth * self._stretch
        planes = []
        for colour, beta, own in zip(cv2.split(picture), water.attenuation, water.glow, strict=True):
            transmission = _floats(cv2.exp(distance * np.float32(-beta)))
            behind = glow * np.float32(own)
            plane = _floats(cv2.multiply(colour, light, dtype=cv2.CV_32F))
            if sky is not None:
                plane += (np.float32(SKY) - plane) * sky
            plane -= behind
            plane *= transmission
            plane += behind
            planes.append(plane)
        # The lens's blur also smooths the steps of slanting edges.
        lens = cv2.GaussianBlur(cv2.convertScaleAbs(cv2.merge(planes)), (3, 3), LENS)
        sharp = _floats(cv2.exp(distance * np.float32(-water.scattering)))
        seen = self._blur(_bytes(lens), sharp)
        return self._grain(seen, time, noise) if noise else seen

    def _light(
        self, depth: Floats, water: WaterOptics, position: Vector, axes: Matrix, time: float
    ) -> Floats:
        """Return the light on each visible point relative to the average."""
        far = _floats(cv2.resize(depth, self._half, interpolation=cv2.INTER_NEAREST))
        np.minimum(far, CAUSTICS_FAR, out=far)
        right, down = self._half_rays
        north, east, below = (
            far * (np.float32(ahead) + np.float32(aside) * right + np.float32(under) * down)
            for ahead, aside, under in axes
        )
        below += np.float32(position[2])
        scale = textures.SIDE / CAUSTICS_SIZE
        x, y = (
            (along - np.float32(slant) * below) * np.float32(scale)
            for along, slant in zip((north, east), SUN, strict=True)
        )
        layers = []
        for drift in CAUSTICS_DRIFT:
            start = [
                np.float32((at + speed * time) * scale % textures.SIDE)
                for at, speed in zip(position, drift, strict=False)
            ]
            layers.append(
                cv2.remap(
                    textures.caustics(), x + start[0], y + start[1], cv2.INTER_LINEAR,
                    borderMode=cv2.BORDER_WRAP,
                )
            )  # fmt: skip
        # None on the surface, and fewer far away, where they are finer than the pixels.
        np.maximum(below, 0, out=below)
        far *= np.float32(-1 / CAUSTICS_DISTANCE)
        far -= below * np.float32(1 / CAUSTICS_DEPTH)
        strength = _floats(cv2.exp(far)) * np.minimum(below * np.float32(1 / CAUSTICS_BEGIN), 1)
        strength *= np.float32(water.caustics)
        light = np.float32(1) + (np.float32(1.5) * cv2.min(*layers) - np.float32(0.75)) * strength
        return _floats(cv2.resize(light, self._size, interpolation=cv2.INTER_LINEAR))

    def _up(self, axes: Matrix) -> Floats:
        """Return the sine of each pixel's elevation."""
        ahead, aside, under = (np.float32(-part) for part in axes[2])
        up: Floats = _floats(ahead + aside * self._right + under * self._down) / self._stretch
        return up

    def _sky(self, up: Floats, depth: Floats, position: Vector) -> Floats | None:
        """Return the share of sky light through the surface: 1 within Snell's window, else 0."""
        if up.max() < SNELL - SNELL_RIM:
            return None
        below = position[2] - depth * self._stretch * up
        window = np.clip((up - np.float32(SNELL - SNELL_RIM)) / np.float32(2 * SNELL_RIM), 0, 1)
        return _floats(np.where(np.abs(below) < SURFACE_NEAR, window, np.float32(0)))

    def _blur(self, picture: Picture, sharp: Floats) -> Picture:
        small = cv2.resize(picture, self._half, interpolation=cv2.INTER_AREA)
        soft = cv2.resize(cv2.blur(small, (BLUR, BLUR)), self._size, interpolation=cv2.INTER_LINEAR)
        return _bytes(cv2.blendLinear(picture, soft, sharp, 1 - sharp))

    def _grain(self, picture: Picture, time: float, noise: float) -> Picture:
        """Return the picture with the sensor's noise: a part of a larger array, another part at each time."""
        width, height = self._size
        x, y = np.random.default_rng(int(time * 1000)).integers(0, NOISE_SHIFT, 2).tolist()
        grain = _sheet(width, height, noise)[y : y + height, x : x + width]
        return _bytes(cv2.add(picture, grain, dtype=cv2.CV_8U))


# OpenCV's stubs do not declare the type of the returned numbers.
def _floats(values: NDArray[Any]) -> Floats:
    return values.astype(np.float32, copy=False)


def _bytes(values: NDArray[Any]) -> Picture:
    return values.astype(np.uint8, copy=False)


@cache
def _sheet(width: int, height: int, noise: float) -> NDArray[np.int8]:
    shape = (height + NOISE_SHIFT, width + NOISE_SHIFT, 3)
    sheet = np.random.default_rng(1).standard_normal(shape, np.float32) * np.float32(noise)
    return np.round(sheet).clip(-127, 127).astype(np.int8)
