"""Computed textures, uint8 of shape (height, width, 3), red first as in OpenGL; all repeat without a seam."""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.card_colours import MARKER_CARD

Texture = NDArray[np.uint8]
Floats = NDArray[np.float32]

SIDE = 512
"""Pixels."""


@cache
def tiles() -> Texture:
    """Draw 8 × 8 glazed tiles with dark joints, each of a slightly different shade."""
    ground, across = np.array((196, 226, 232)), 8
    rng = np.random.default_rng(2)
    shade = rng.normal(0.0, 0.022, (across, across, 1)) + rng.normal(0.0, 0.006, (across, across, 3))
    size = SIDE // across
    plain = np.kron(1 + shade, np.ones((size, size, 1))) * ground
    joint = np.zeros((SIDE, SIDE), np.float32)
    for at in range(0, SIDE, size):
        joint[at : at + 3] = joint[:, at : at + 3] = 1.0
    soft = cv2.GaussianBlur(joint, (3, 3), 0)[:, :, np.newaxis]
    # Dark, because pale joints are invisible between pale tiles.
    return _bytes(plain * (1 - soft) + 0.72 * ground * soft)


@cache
def sand() -> Texture:
    """Draw grey sand with ripples and grains."""
    down, across = _grid()
    wander = 2.2 * _cloud(3, 4.0)
    ripples = np.sin(2 * np.pi * (9 * down + 2 * across) + 2.4 * wander)
    grains = np.random.default_rng(4).normal(0.0, 1.0, (SIDE, SIDE))
    light = 1 + 0.05 * ripples + 0.10 * _cloud(5, 3.0) + 0.05 * grains
    return _bytes(light[:, :, np.newaxis] * np.array((150, 156, 158)))


@cache
def stone() -> Texture:
    """Draw dark stone with patches of growth."""
    light = 1 + 0.22 * _cloud(6, 2.2) + 0.12 * _cloud(7, 1.2)
    growth = np.clip(0.5 + 0.8 * _cloud(8, 3.0), 0, 1)[:, :, np.newaxis]
    paint = np.array((92, 94, 98)) * (1 - growth) + np.array((58, 66, 66)) * growth
    return _bytes(light[:, :, np.newaxis] * paint)


@cache
def surface_below(glow: tuple[int, int, int]) -> Texture:
    """Return the water's surface from below: the colour of the water with bright ripples of the sky."""
    crest = np.clip(1 - np.abs(_ripples(10, 7.0)) * 1.5, 0, 1) ** 2
    patch = np.clip(0.5 + 0.5 * _ripples(12, 3.0), 0, 1)
    light = (0.86 + 0.16 * patch + 0.4 * crest * (0.35 + patch))[:, :, np.newaxis]
    return _bytes(light * np.array(glow) + 24.0 * crest[:, :, np.newaxis])


@cache
def caustics() -> Floats:
    """Draw the light on a floor under ripples, about 1 on average, float32 of shape (SIDE, SIDE).

    Vertical rays are refracted by the slope of a random surface and counted on the floor.
    """
    height = _ripples(14, 6.0) + 0.35 * _ripples(17, 12.0)
    slope_down, slope_across = np.gradient(np.pad(height, 1, mode="wrap"))
    fine = 4
    count = np.zeros((SIDE, SIDE))
    base_down, base_across = np.mgrid[0:SIDE, 0:SIDE]
    throw = 190.0
    for step in range(fine * fine):
        offset_down, offset_across = (step // fine) / fine, (step % fine) / fine
        down = (base_down + offset_down + throw * slope_down[1:-1, 1:-1]).astype(int) % SIDE
        across = (base_across + offset_across + throw * slope_across[1:-1, 1:-1]).astype(int) % SIDE
        np.add.at(count, (down, across), 1.0)
    light = cv2.GaussianBlur(np.pad(count / fine**2, 8, mode="wrap"), (0, 0), 1.1)[8:-8, 8:-8]
    return np.clip(light, 0.3, 4.0).astype(np.float32)


@cache
def marker() -> Texture:
    """Return the marker on a card, without its white border."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    printed = cv2.aruco.generateImageMarker(dictionary, MARKER_CARD, SIDE)
    return cv2.cvtColor(printed, cv2.COLOR_GRAY2RGB).astype(np.uint8, copy=False)


@cache
def relief(side: int) -> Floats:
    """Return an uneven floor's heights, 0 to 1, float32 of shape (side, side); its edges fit."""
    hills = cv2.resize(_cloud(15, 3.2), (side - 1, side - 1), interpolation=cv2.INTER_AREA)
    small = cv2.resize(_cloud(16, 2.4), (side - 1, side - 1), interpolation=cv2.INTER_AREA)
    heights = hills + 0.18 * small
    heights = (heights - heights.min()) / (heights.max() - heights.min())
    return np.pad(heights, ((0, 1), (0, 1)), mode="wrap").astype(np.float32)


def _cloud(seed: int, smoothness: float) -> Floats:
    """Return periodic noise of standard deviation 1 whose spectrum falls with frequency to this power."""
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((SIDE, SIDE)))
    frequency = np.hypot(np.fft.fftfreq(SIDE)[:, np.newaxis], np.fft.rfftfreq(SIDE)[np.newaxis])
    frequency[0, 0] = 1.0
    # At most a third of the texture: larger details would make its repetition visible.
    low = 1 - np.exp(-((frequency * SIDE / 3.0) ** 4))
    spectrum = white * low * frequency ** (-smoothness / 2 - 0.5)
    spectrum[0, 0] = 0.0
    noise = np.fft.irfft2(spectrum, (SIDE, SIDE))
    cloud: Floats = (noise / noise.std()).astype(np.float32)
    return cloud


def _ripples(seed: int, cycles: float) -> Floats:
    """Return periodic waves in all directions, about `cycles` per texture, of standard deviation 1."""
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((SIDE, SIDE)))
    number = SIDE * np.hypot(np.fft.fftfreq(SIDE)[:, np.newaxis], np.fft.rfftfreq(SIDE)[np.newaxis])
    waves = np.fft.irfft2(white * np.exp(-(((number - cycles) / (0.45 * cycles)) ** 2)), (SIDE, SIDE))
    ripples: Floats = (waves / waves.std()).astype(np.float32)
    return ripples


def _grid() -> tuple[Floats, Floats]:
    down, across = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32) / SIDE
    return down, across


def _bytes(values: NDArray[np.floating]) -> Texture:
    texture: Texture = np.clip(values, 0, 255).astype(np.uint8)
    return texture
