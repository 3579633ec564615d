"""The flight view's lines, drawn into a picture: thin and light with a dark edge, legible in sunlight."""

import unicodedata
from collections.abc import Sequence
from functools import lru_cache
from math import ceil, cos, floor, radians, sin

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.vision.picture import Picture
from server.library.flight_values import Attitude, FlightValues, format_time

Colour = tuple[int, int, int]
"""Blue, green, red."""
Point = tuple[float, float]
Segment = tuple[Point, Point]
Shares = NDArray[np.float32]

LINE: Colour = (255, 255, 255)
EDGE: Colour = (20, 14, 8)
HELD: Colour = (92, 198, 255)
"""Of a set point."""
ALARM: Colour = (96, 106, 255)
_HEIGHT = 480.0
"""px of a picture on which the measures below are meant; on others they grow or shrink."""
_PER_METRE = 105.0
_PER_DEGREE = 3.4
_PER_PITCH = 3.8
_PITCHES = (-20, -10, 10, 20)
_BANKS = (-60, -30, -10, 0, 10, 30, 60)
_NAMES = {0: "N", 90: "E", 180: "S", 270: "W"}
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_SHIFT = 4
"""Binary digits after the point of a pixel's coordinates."""
_TEXT_MOST = 60


class FlightLines:
    """The lines for pictures of one size, px."""

    def __init__(self, width: int, height: int) -> None:
        self._width, self._height = width, height
        self._unit = height / _HEIGHT
        self._picture: Picture

    def draw(self, picture: Picture, values: FlightValues) -> None:
        """Draw the values into the picture, which has the shape (height, width, 3), BGR."""
        self._picture = picture
        if values.attitude is not None:
            self._draw_horizon(values.attitude)
            self._draw_compass(values.attitude.heading, values.heading_held)
        if values.depth is not None:
            self._draw_depth(values.depth, values.depth_held)
        self._draw_words(values)

    def _draw_horizon(self, attitude: Attitude) -> None:
        unit, half = self._unit, self._height * 0.27
        gap, middle = half * 0.24, (self._width / 2, self._height / 2)
        turned = -radians(attitude.roll)

        def turn(x: float, y: float, down: float = attitude.pitch * _PER_PITCH * unit) -> Point:
            y += down
            return middle[0] + x * cos(turned) - y * sin(turned), middle[1] + x * sin(turned) + y * cos(
                turned
            )

        self._draw(
            [
                ((middle[0] + side * gap * 0.4, middle[1]), (middle[0] + side * gap * 0.85, middle[1]))
                for side in (-1, 1)
            ],
            2,
        )
        banks = [(sin(radians(bank)), -cos(radians(bank)), 9 if bank % 30 == 0 else 5) for bank in _BANKS]
        self._draw(
            [
                (turn(x * half, y * half, 0), turn(x * (half + long * unit), y * (half + long * unit), 0))
                for x, y, long in banks
            ]
        )
        self._draw(
            [
                (
                    (middle[0] - 4 * unit, middle[1] - half + 9 * unit),
                    (middle[0], middle[1] - half + 2 * unit),
                ),
                (
                    (middle[0] + 4 * unit, middle[1] - half + 9 * unit),
                    (middle[0], middle[1] - half + 2 * unit),
                ),
            ]
        )
        if abs(attitude.pitch) * _PER_PITCH * unit < half:
            self._draw([(turn(side * gap, 0), turn(side * half * 0.9, 0)) for side in (-1, 1)])
        for angle in _PITCHES:
            y = -angle * _PER_PITCH * unit
            if abs(y + attitude.pitch * _PER_PITCH * unit) > half * 0.9:
                continue
            self._draw([(turn(side * gap * 0.6, y), turn(side * gap * 1.1, y)) for side in (-1, 1)])
            x, y = turn(gap * 1.1 + 5 * unit, y)
            self._write(str(abs(angle)), x, y, size=0.3)

    def _draw_compass(self, heading: float, held: float | None) -> None:
        unit, middle = self._unit, self._width / 2
        reach, top = 130 * unit, 40 * unit
        per_degree = _PER_DEGREE * unit
        marks = [
            ((degree * 10 - heading) * per_degree, degree * 10)
            for degree in _steps(heading - reach / per_degree, heading + reach / per_degree, 10)
        ]
        self._draw(
            [((middle - reach, top), (middle + reach, top))]
            + [
                ((middle + at, top), (middle + at, top - (9 if degree % 30 == 0 else 5) * unit))
                for at, degree in marks
            ]
        )
        for at, degree in marks:
            if degree % 30 == 0 and 30 * unit < abs(at):
                name = _NAMES.get(degree % 360, f"{degree % 360 // 10:02d}")
                self._write(name, middle + at, top - 17 * unit, size=0.36, align=0.5)
        self._box(f"{round(heading) % 360:03d}", middle, top - 19 * unit, 44 * unit)
        if held is not None:
            apart = (held - heading + 180) % 360 - 180
            at = middle + max(-reach, min(reach, apart * per_degree))
            tip = (at, top + 2 * unit)
            left, right = (at - 5 * unit, top + 10 * unit), (at + 5 * unit, top + 10 * unit)
            self._draw([(tip, left), (left, right), (right, tip)], colour=HELD)

    def _draw_depth(self, depth: float, held: float | None) -> None:
        unit, middle = self._unit, self._height / 2
        reach, right = 130 * unit, self._width - 14 * unit
        per_metre = _PER_METRE * unit
        marks = [
            ((tenth / 10 - depth) * per_metre, tenth)
            for tenth in _steps(
                max(0.0, 10 * (depth - reach / per_metre)), 10 * (depth + reach / per_metre), 1
            )
        ]
        self._draw(
            [((right, middle + max(-reach, -depth * per_metre)), (right, middle + reach))]
            + [
                ((right, middle + at), (right - (10 if tenth % 5 == 0 else 5) * unit, middle + at))
                for at, tenth in marks
            ]
        )
        for at, tenth in marks:
            if tenth % 5 == 0 and abs(at) > 18 * unit:
                self._write(f"{tenth / 10:.1f}", right - 14 * unit, middle + at, size=0.36, align=1.0)
        self._box(f"{depth:z.2f} m", right - 44 * unit, middle, 62 * unit)
        if held is None:
            return
        apart = (held - depth) * per_metre
        at = middle + max(-reach, min(reach, apart))
        tip = (right + 1 * unit, at)
        upper, lower = (right + 9 * unit, at - 5 * unit), (right + 9 * unit, at + 5 * unit)
        self._draw([(tip, upper), (upper, lower), (lower, tip)], colour=HELD)
        if 20 * unit < abs(apart) <= reach:
            self._draw([((right - 20 * unit, at), (right, at))], colour=HELD)
            self._write(f"{held:.2f}", right - 24 * unit, at, size=0.36, align=1.0, colour=HELD)

    def _draw_words(self, values: FlightValues) -> None:
        unit, bottom = self._unit, self._height - 16 * self._unit
        at = 12 * unit
        if values.armed:
            at = self._write("ARMED", at, bottom, colour=HELD) + 10 * unit
        self._write(" ".join([values.mode, values.controller.replace("_", "-")]).strip(), at, bottom)
        self._write(format_time(values.time), self._width - 12 * unit, bottom, align=1.0)
        for line, alarm in enumerate(values.alarms[:3]):
            self._write(f"! {alarm}", self._width / 2, (64 + 18 * line) * unit, align=0.5, colour=ALARM)
        if values.event:
            self._write(values.event, self._width / 2, bottom - 24 * unit, size=0.38, align=0.5)

    def _box(self, text: str, x: float, y: float, width: float) -> None:
        """Write the value in the middle of a tape on a dark ground in a frame."""
        unit = self._unit
        left, right, upper, lower = x - width / 2, x + width / 2, y - 11 * unit, y + 11 * unit
        ground = self._picture[max(0, round(upper)) : round(lower), max(0, round(left)) : round(right)]
        ground //= 3
        self._draw(
            [
                ((left, upper), (right, upper)),
                ((right, upper), (right, lower)),
                ((right, lower), (left, lower)),
                ((left, lower), (left, upper)),
            ]
        )
        self._write(text, x, y, align=0.5)

    def _draw(self, segments: Sequence[Segment], width: float = 1, colour: Colour = LINE) -> None:
        """Draw lines, all of their edges first, so that crossing ones stay whole."""
        thin = max(1, round(width * self._unit))
        points = [[(round(x * 2**_SHIFT), round(y * 2**_SHIFT)) for x, y in segment] for segment in segments]
        for shade, thick in ((EDGE, thin + 2), (colour, thin)):
            for begin, end in points:
                cv2.line(self._picture, begin, end, shade, thick, cv2.LINE_AA, _SHIFT)

    def _write(
        self, text: str, x: float, y: float, *, size: float = 0.45, align: float = 0.0, colour: Colour = LINE
    ) -> float:
        """Write text with its middle at height `y`, and this share of it before `x`; return its right end."""
        ink, edge = _render(_ascii(text), size * self._unit)
        height, width = ink.shape
        left = round(min(max(0.0, x - align * width), max(0.0, float(self._width - width))))
        top = round(min(max(0.0, y - height / 2), max(0.0, float(self._height - height))))
        ground = self._picture[top : top + height, left : left + width]
        height, width = ground.shape[:2]
        for mask, shade in ((edge, EDGE), (ink, colour)):
            share = mask[:height, :width, np.newaxis]
            ground[:] = ground * (1.0 - share) + np.array(shade, np.float32) * share
        return float(left + width)


@lru_cache(maxsize=500)
def _render(text: str, scale: float) -> tuple[Shares, Shares]:
    """Return the shares of a text and of its edge in the pixels of its rectangle, 0 to 1.

    Drawn once: most texts of a picture are those of the last one.
    """
    thin, margin = max(1, round(scale / 0.45)), 3
    (width, height), below = cv2.getTextSize(text, _FONT, scale, thin)
    canvas = np.zeros((height + below + 2 * margin, width + 2 * margin), np.uint8)
    cv2.putText(canvas, text, (margin, margin + height), _FONT, scale, 255, thin, cv2.LINE_AA)
    edge = cv2.GaussianBlur(cv2.dilate(canvas, np.ones((3, 3), np.uint8)), (3, 3), 0)
    return canvas.astype(np.float32) / np.float32(255), edge.astype(np.float32) / np.float32(255)


def _steps(low: float, high: float, step: int) -> range:
    """Return the whole multiples of `step` between two values, divided by it."""
    return range(ceil(low / step), floor(high / step) + 1)


def _ascii(text: str) -> str:
    """Return text in the signs that OpenCV's font has."""
    known = text.translate({ord("µ"): "u", ord("μ"): "u", ord("–"): "-", ord("“"): '"', ord("”"): '"'})
    plain = unicodedata.normalize("NFKD", known).encode("ascii", "ignore").decode()
    return plain if len(plain) <= _TEXT_MOST else f"{plain[: _TEXT_MOST - 3]}..."
