"""The board's tunable parameters; `make generate` writes the firmware's table from this.

No limit that safety rests on is among them: how soon a command expires, how soon the fins stop flapping, and
the watchdog are constants of the firmware. Where the hardware sets a limit, it is the range's end.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ChipParameter:
    """One number that the board keeps until its next reset; on the line in thousandths of its unit."""

    name: str
    default: float
    minimum: float
    maximum: float
    unit: str
    meaning: str
    while_armed: bool = True
    """True if the board accepts a new value while it is armed."""


CHIP_PARAMETERS: tuple[ChipParameter, ...] = (
    ChipParameter("fins.frequency", 1.3, 0.3, 2.0, "Hz", "strokes of a flapping fin each second"),
    ChipParameter("fins.amplitude", 1.6, 0.2, 1.6, "rad", "largest stroke, peak to peak, at full command"),
    # Slower, and the fins of a robot whose battery is low would not be down within the 1.5 s they have.
    ChipParameter("fins.turn_rate", 4.909, 2.5, 4.909, "rad/s", "how fast the direction of a fin turns"),
    ChipParameter("fins.gain", 0.625, 0.3, 1.2, "", "drive of a fin, in steps for each count of its error"),
    ChipParameter(
        "battery.alarm", 6.2, 6.2, 7.4, "V", "below it for 20 s the robot is stopped", while_armed=False
    ),
    ChipParameter(
        "water.density", 1.0, 0.99, 1.05, "kg/L", "1 for fresh water, 1.025 for the sea", while_armed=False
    ),
)
"""Each one's place is its number on the line."""
