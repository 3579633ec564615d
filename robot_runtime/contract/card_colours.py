"""The colours in which cards and targets are painted, as daylight shows them."""

from collections.abc import Mapping

Paint = tuple[int, int, int]
"""Blue, green and red, 0 to 255."""

PAINTS: Mapping[str, Paint] = {
    "red": (35, 30, 215),
    "yellow": (20, 190, 245),
    "green": (70, 170, 50),
    "blue": (200, 75, 20),
}
"""Colours of printed cards."""
WHITE: Paint = (235, 238, 240)
"""Colour of the card with the marker."""
MARKER_CARD = 7
"""Number of the marker on that card, of OpenCV's dictionary 4x4_50."""
