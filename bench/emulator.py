"""Speed of the emulated board: emulated seconds in a real second."""

import tempfile
import time
from pathlib import Path

from tests.board.host import start

_SECONDS = 20.0


def measure() -> dict[str, float]:
    """Measure the robot's firmware, swimming in still water, nobody at its line."""
    with tempfile.TemporaryDirectory() as folder, start("robot", Path(folder)) as rig:
        rig.board.run(1.0)
        began = time.monotonic()
        rig.board.run(_SECONDS)
        return {"emulator.speed_x": _SECONDS / (time.monotonic() - began)}
