"""Patches of one colour in a picture: mask, outlines and selection, and the mask as a picture for people."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi

import cv2
import numpy as np

from robot_runtime.contract.documents import Box, Candidate
from robot_runtime.contract.vision_settings import HUE_MAX, ColourRange, VisionSettings
from robot_runtime.vision.picture import Picture

CONTOURS_MAX = 50
"""The largest patches that are measured; noise may make thousands."""
CANDIDATES_MAX = 5
"""The largest patches that are reported."""
OPENING_LEAST = 3
"""Least size of the opening, pixels; a smaller one removes nothing."""
GROUND = (23, 17, 10)
"""Blue, green and red, like all below."""
DROPPED = (96, 88, 80)
"""Pixels of the colour outside the accepted patches."""
COUNTED = (243, 238, 230)
OUTLINE = (180, 198, 53)
OUTLINE_REFUSED = (41, 180, 240)

Contour = np.ndarray[tuple[int, ...], np.dtype[np.int32]]


@dataclass(frozen=True, slots=True)
class Patches:
    """All patches of one colour; `mask` is 255 in them, uint8 of shape (height, width).

    `candidates` are the largest patches in descending order, `contours` their outlines.
    """

    colour: str
    mask: Picture
    candidates: Sequence[Candidate]
    contours: Sequence[Contour]

    @property
    def counting(self) -> Iterator[tuple[Candidate, Contour]]:
        """The candidates that meet the limits of the settings, with their outlines."""
        pairs = zip(self.candidates, self.contours, strict=True)
        return ((candidate, contour) for candidate, contour in pairs if not candidate.refused)

    @property
    def largest(self) -> Candidate | None:
        """The largest candidate that meets the limits."""
        return next((candidate for candidate, _ in self.counting), None)


def find_patches(hsv: Picture, name: str, settings: VisionSettings) -> Patches:
    """Return the patches of a named colour in an HSV picture (height, width, 3)."""
    height, width = hsv.shape[:2]
    mask = find_colour(hsv, settings.colours[name])
    if cv2.countNonZero(mask) < settings.area_min * width * height:
        return Patches(name, mask, (), ())
    outlines, _ = cv2.findContours(
        _opened(mask, settings.opening), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE
    )
    contours = [outline.astype(np.int32, copy=False) for outline in outlines]
    contours.sort(key=cv2.contourArea, reverse=True)
    measured = [(_measure(contour, width, height, settings), contour) for contour in contours[:CONTOURS_MAX]]
    # Those that meet the limits come first, whatever their size.
    measured.sort(key=lambda pair: bool(pair[0].refused))
    listed = measured[:CANDIDATES_MAX]
    return Patches(name, mask, [candidate for candidate, _ in listed], [contour for _, contour in listed])


def find_colour(hsv: Picture, colour: ColourRange) -> Picture:
    """Return 255 where an HSV picture (height, width, 3) has this colour, else 0; shape (height, width)."""
    low, high = colour.hue
    if low <= high:
        return _between(hsv, colour, low, high)
    return _between(hsv, colour, low, HUE_MAX) | _between(hsv, colour, 0, high)


def _between(hsv: Picture, colour: ColourRange, hue_low: int, hue_high: int) -> Picture:
    lows = (hue_low, colour.saturation[0], colour.value[0])
    highs = (hue_high, colour.saturation[1], colour.value[1])
    return cv2.inRange(hsv, lows, highs).astype(np.uint8, copy=False)


def _opened(mask: Picture, opening: float) -> Picture:
    """Return the mask without specks of noise; larger patches are unchanged."""
    if opening == 0:
        return mask
    size = max(OPENING_LEAST, int(mask.shape[1] * opening) | 1)
    square = cv2.getStructuringElement(cv2.MORPH_RECT, (size, size))
    return cv2.morphologyEx(mask, cv2.MORPH_OPEN, square).astype(np.uint8, copy=False)


def _measure(contour: Contour, width: int, height: int, settings: VisionSettings) -> Candidate:
    x, y, w, h = cv2.boundingRect(contour)
    inside = cv2.contourArea(contour)
    perimeter = cv2.arcLength(contour, closed=True)
    area = inside / (width * height)
    # A contour runs through the middle of the outermost pixels, and so does the box that it fills.
    fill = inside / max((w - 1) * (h - 1), 1)
    aspect = w / h
    circularity = min(4 * pi * inside / perimeter**2, 1.0) if perimeter else 0.0
    return Candidate(
        box=Box(x=x / width, y=y / height, width=w / width, height=h / height),
        area=area,
        fill=fill,
        aspect=aspect,
        circularity=circularity,
        refused=_refused(area, fill, aspect, circularity, settings),
    )


def _refused(area: float, fill: float, aspect: float, circularity: float, settings: VisionSettings) -> str:
    low, high = settings.aspect
    reasons = (
        ("too small", area < settings.area_min),
        ("too large", area > settings.area_max),
        ("fills too little of its box", fill < settings.fill_min),
        ("too narrow", aspect < low),
        ("too wide", aspect > high),
        ("not round enough", circularity < settings.circularity_min),
    )
    return ", ".join(reason for reason, holds in reasons if holds)


def draw_preview(picture: Picture, colour: ColourRange, settings: VisionSettings) -> Picture:
    """Return the mask that a target colour with this range would have, drawn as by `draw_mask`.

    `picture` is BGR, uint8 of shape (height, width, 3), after the white balance.
    """
    hsv = cv2.cvtColor(picture, cv2.COLOR_BGR2HSV).astype(np.uint8, copy=False)
    name = settings.colour
    return draw_mask(find_patches(hsv, name, replace(settings, colours={**settings.colours, name: colour})))


def draw_mask(patches: Patches) -> Picture:
    """Return the mask with the outlines of the largest patches, BGR, uint8 of shape (height, width, 3)."""
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
