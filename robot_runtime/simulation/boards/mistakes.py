"""Mistakes of wiring and imperfections of parts that an emulated board can have, by name.

A mistake is a text such as `imu-strap` or `leads-reversed:front-right`. The board carries them out, in
`firmware/emulator/mistakes.c`.
"""

import re
from collections.abc import Callable
from itertools import permutations
from typing import NamedTuple

FINS = ("front-right", "back-right", "back-left", "front-left")
PARTS = (
    *("imu", "pressure", "battery", "beacon-right", "beacon-left"),
    *(f"{part}-{fin}" for part in ("motor", "bridge", "encoder") for fin in FINS),
)
_NUMBER = re.compile(r"[+-]?[0-9]+(\.[0-9]+)?")
_IDENTITY = re.compile(r"0x[0-9a-fA-F]{1,2}|[1-9][0-9]{0,2}")
_EVEN = {("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y")}


class Mistake(NamedTuple):
    """A kind of mistake."""

    argument: str
    """What follows the colon; empty: nothing."""
    meaning: str
    accepts: Callable[[str], bool]


def _is_nothing(text: str) -> bool:
    return not text


def _is_fin(text: str) -> bool:
    return text in FINS


def _are_two_fins(text: str) -> bool:
    return text in {f"{first},{other}" for first, other in permutations(FINS, 2)}


def _are_axes(text: str) -> bool:
    """Return True for the 24 ways in which a chip can lie; the other 24 are mirror images."""
    signs, axes = text[::2], tuple(text[1::2])
    if len(text) != 6 or not set(signs) <= {"+", "-"} or set(axes) != {"x", "y", "z"}:
        return False
    return (axes in _EVEN) == (signs.count("-") % 2 == 0)


def _is_identity(text: str) -> bool:
    return bool(_IDENTITY.fullmatch(text)) and 1 <= int(text, 0) <= 255


def _are_numbers(least: float, most: float, count: int = 1) -> Callable[[str], bool]:
    def accepts(text: str) -> bool:
        values = text.split(",")
        return len(values) == count and all(
            _NUMBER.fullmatch(value) and least <= float(value) <= most for value in values
        )

    return accepts


MISTAKES: dict[str, Mistake] = {
    "motors-swapped": Mistake("FIN,FIN", "two motors are at each other's H-bridge", _are_two_fins),
    "leads-reversed": Mistake("FIN", "a motor's leads are swapped", _is_fin),
    "encoders-swapped": Mistake("FIN,FIN", "two encoders are at each other's select", _are_two_fins),
    "encoder-reversed": Mistake("FIN", "an encoder counts backwards: its magnet is turned over", _is_fin),
    "strap-wrong": Mistake("FIN", "an H-bridge is at 0x62", _is_fin),
    "strap-shared": Mistake(
        "FIN,FIN", "the first's H-bridge has the second's address, and both obey", _are_two_fins
    ),
    "imu-strap": Mistake("", "the IMU is at 0x68", _is_nothing),
    "imu-turned": Mistake(
        "AXES",
        "the body axes along which the IMU's X, Y and Z lie; +x-y-z is upside down",
        _are_axes,
    ),
    "imu-clone": Mistake("IDENTITY", "the IMU's WHO_AM_I, 1 to 255 or from 0x1", _is_identity),
    "missing": Mistake("PART", "a part is not connected", PARTS.__contains__),
    "beacons-inverted": Mistake("", "a detector's pin is low while it hears its tone", _is_nothing),
    "beacons-swapped": Mistake("", "the right detector is at the left one's pin", _is_nothing),
    "divider-wrong": Mistake(
        "FACTOR", "the battery reads as this many times its voltage, 0.1 to 10", _are_numbers(0.1, 10)
    ),
    "regulator-off": Mistake(
        "PERCENT",
        "the 5 V are this much higher, -10 to 10, so that the battery reads lower",
        _are_numbers(-10, 10),
    ),
    "gyro-offset": Mistake("X,Y,Z", "°/s of the gyroscope's own axes, -20 to 20", _are_numbers(-20, 20, 3)),
    "gyro-drift": Mistake(
        "X,Y,Z", "°/s by which the offsets grow with each °C above 25, -1 to 1", _are_numbers(-1, 1, 3)
    ),
    "encoder-noise": Mistake(
        "TICKS", "every encoder is wrong by up to this many of 1024, 0 to 20", _are_numbers(0, 20)
    ),
    "backlash": Mistake("RAD", "of all fins' gears, 0 to 0.3", _are_numbers(0, 0.3)),
    "stiction": Mistake(
        "STEPS",
        "of all fins, 0 to 63, 2 without it: below this drive a fin at rest stays; a seal adds 3 to 9",
        _are_numbers(0, 63),
    ),
    "pack-resistance": Mistake(
        "OHM", "of the battery, 0 to 2: its voltage falls with the motors' current", _are_numbers(0, 2)
    ),
}
"""By name, wiring first. FIN is one of `FINS`."""


def write_list() -> list[str]:
    """Return a line for each kind of mistake: its notation and its meaning."""
    return [f"{notation(name)}: {mistake.meaning}" for name, mistake in MISTAKES.items()]


def check_mistake(text: str) -> None:
    """Raise ValueError if there is no such mistake; its text lists the mistakes."""
    name, colon, argument = text.partition(":")
    if name not in MISTAKES:
        raise ValueError(f"there is no mistake {text!r}; there are {', '.join(MISTAKES)}")
    mistake = MISTAKES[name]
    if not mistake.accepts(argument) or (colon and not argument):
        fins = f"; FIN is {', '.join(FINS)}" if "FIN" in mistake.argument else ""
        raise ValueError(f"the mistake {text!r} is written {notation(name)}: {mistake.meaning}{fins}")


def notation(name: str) -> str:
    """Return how a mistake is written, such as `leads-reversed:FIN`."""
    argument = MISTAKES[name].argument
    return f"{name}:{argument}" if argument else name
