"""The Raspberry Pi's own watch over its supply: `get_throttled` of the firmware."""

from pathlib import Path

UNDERVOLTAGE_NOW, UNDERVOLTAGE_SINCE = 1, 1 << 16
"""Bits: the supply is below 4.63 V, and was since the start."""
PLACES = "sys/devices/platform/soc*/soc*:firmware/get_throttled"
"""The file of every model; a Raspberry Pi Zero and Zero W have no detector, and their bits stay 0."""


def read_throttled(root: Path = Path("/")) -> int | None:
    """Return the present bits; None where this is no Raspberry Pi."""
    for path in root.glob(PLACES):
        try:
            return int(path.read_text(encoding="ascii").strip(), 16)
        except (OSError, ValueError):
            return None
    return None
