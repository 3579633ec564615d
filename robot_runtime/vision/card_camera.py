"""A camera that draws calm water and, on request, a coloured card in it.

Colours reach the camera as through water: each channel is I·e^(-βz) + B·(1 - e^(-βz)), where z is the
distance, β the water's attenuation and B its own colour. The same time gives the same picture.
"""

from collections.abc import Callable
from math import cos, exp, pi, sin

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.clock import Clock
from robot_runtime.contract.card_colours import Paint
from robot_runtime.vision.camera import Camera, CameraFrame
from robot_runtime.vision.cards import MARKER_CELLS, MARKER_SIDE, CameraCard, marker_pattern
from robot_runtime.vision.picture import Picture

Floats = NDArray[np.float32]

WATER = (150.0, 128.0, 30.0)
"""Blue, green and red of the water itself, 0 to 255, in the middle of the picture."""
ATTENUATION = (0.06, 0.09, 0.6)
"""1/m, of blue, green and red."""
CARD_DISTANCE = 0.4
"""m."""
CARD_SIZE = (0.26, 0.36)
"""Width and height of the card as shares of the picture's height."""
BLACK = (18, 18, 18)
"""Printer's ink."""
NOISE = 3.0
"""Standard deviation of each byte of the picture."""
NOISE_SHIFT = 64
"""Pixels by which the array of noise is larger than the picture."""
RIPPLES = ((1.7, 0.6, 0.31), (-1.1, 1.9, 0.23), (0.7, -2.6, 0.41), (2.9, 1.3, 0.17))
"""Caustic light as four waves: cycles across, cycles down, and Hz."""
COARSE = 8
"""Pixels per sample of the light, which is smooth."""


class CardCamera(Camera):
    """A camera that draws `width` × `height` pixels; `card` returns the shown card, if any."""

    def __init__(
        self,
        width: int,
        height: int,
        clock: Clock,
        card: Callable[[], CameraCard | None],
    ) -> None:
        self.size = (width, height)
        self._clock = clock
        self._card = card
        self._prepare(width, height)

    def _prepare(self, width: int, height: int) -> None:
        """Make the water, the light and the noise of pictures of this size."""
        self._size = (width, height)
        self._water = _water(width, height)
        # Reused, because new memory for each picture costs more than drawing in it.
        self._canvas: Floats = np.empty_like(self._water)
        self._fine: Floats = np.empty((height, width), np.float32)
        down, across = np.mgrid[0 : 1 : complex(height // COARSE), 0 : 1 : complex(width // COARSE)]
        self._phases = [(2 * pi * (x * across + y * down)).astype(np.float32) for x, y, _ in RIPPLES]
        sheet = (height + NOISE_SHIFT, width + NOISE_SHIFT, 3)
        self._noise = np.random.default_rng(1).standard_normal(sheet, np.float32) * np.float32(NOISE)

    def read(self) -> CameraFrame:
        """Return the present picture."""
        now = self._clock.now()
        if self.size != self._size:
            self._prepare(*self.size)
        return CameraFrame(self.draw(now, self._card()), now)

    def close(self) -> None:
        """Do nothing; no device is open."""

    def __str__(self) -> str:
        card = self._card()
        return f"drawn water with a {card.name} card" if card else "drawn water without a card"

    def draw(self, time: float, card: CameraCard | None) -> Picture:
        """Return the picture at this time (s), uint8 of shape (height, width, 3), blue, green, red."""
        canvas = self._canvas
        np.copyto(canvas, self._water)
        if card is not None:
            self._draw_card(time, card)
        canvas *= self._light(time)
        canvas += self._grain(time)
        np.clip(canvas, 0, 255, out=canvas)
        return canvas.astype(np.uint8)

    def _draw_card(self, time: float, card: CameraCard) -> None:
        half_x, half_y = (side * self._size[1] / 2 for side in CARD_SIZE)
        sheet = self._quad(time, -half_x, -half_y, half_x, half_y)
        cv2.fillConvexPoly(self._canvas, sheet, _through_water(card.paint), cv2.LINE_AA, shift=4)
        if not card.marked:
            return
        cell = 2 * half_x * MARKER_SIDE / MARKER_CELLS
        start = -cell * MARKER_CELLS / 2
        for row, column in np.argwhere(marker_pattern() == 0):
            x, y = start + cell * column, start + cell * row
            black = self._quad(time, x, y, x + cell, y + cell)
            cv2.fillConvexPoly(self._canvas, black, _through_water(BLACK), shift=4)

    def _light(self, time: float) -> Floats:
        """Return the relative brightness of each pixel, about 1; (height, width, 1)."""
        waves = [
            np.sin(phase + 2 * pi * hertz * time)
            for phase, (_, _, hertz) in zip(self._phases, RIPPLES, strict=True)
        ]
        # Squared, waves give the bright narrow lines and wide dim patches of caustic light.
        coarse = (0.94 + 0.03 * np.square(np.add.reduce(waves))).astype(np.float32)
        cv2.resize(coarse, self._size, dst=self._fine, interpolation=cv2.INTER_LINEAR)
        return self._fine[:, :, np.newaxis]

    def _grain(self, time: float) -> Floats:
        """Return the sensor's noise: a part of a larger array, another part at each time."""
        width, height = self._size
        x, y = np.random.default_rng(int(time * 1000)).integers(0, NOISE_SHIFT, 2).tolist()
        return self._noise[y : y + height, x : x + width]

    def _quad(self, time: float, left: float, top: float, right: float, bottom: float) -> NDArray[np.int32]:
        """Return the corners, in 1/16 pixel, of a rectangle on the card, given in pixels from its middle.

        The card sways, as if held by hand.
        """
        width, height = self._size
        centre_x = width * (0.5 + 0.03 * sin(2 * pi * 0.11 * time))
        centre_y = height * (0.5 + 0.03 * sin(2 * pi * 0.17 * time + 1))
        tilt = 0.12 * sin(2 * pi * 0.13 * time + 2)
        corners = [
            (centre_x + x * cos(tilt) - y * sin(tilt), centre_y + x * sin(tilt) + y * cos(tilt))
            for x, y in ((left, top), (right, top), (right, bottom), (left, bottom))
        ]
        return np.round(np.array(corners) * 16).astype(np.int32)


def _water(width: int, height: int) -> Floats:
    """Return water that grows darker downwards."""
    brightness = np.linspace(1.25, 0.7, height, dtype=np.float32)[:, np.newaxis, np.newaxis]
    return np.ascontiguousarray(np.broadcast_to(brightness * np.array(WATER, np.float32), (height, width, 3)))


def _through_water(paint: Paint) -> tuple[float, float, float]:
    """Return a paint's blue, green and red as seen through the water in front of the card."""
    blue, green, red = (
        own * exp(-loss * CARD_DISTANCE) + water * (1 - exp(-loss * CARD_DISTANCE))
        for own, water, loss in zip(paint, WATER, ATTENUATION, strict=True)
    )
    return blue, green, red
