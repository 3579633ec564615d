"""`python -m tests.runtime.vision.faulty_vision FOLDER` is a vision process whose camera obeys files.

While FOLDER/crash is there, reading a picture crashes the process; with "hang" it never returns, and makes
"hangs"; with "eat" it takes memory for ever.
"""

import os
import signal
import sys
from pathlib import Path

import numpy as np

from robot_runtime.clock import SteadyClock
from robot_runtime.vision import __main__ as vision
from robot_runtime.vision.camera import Camera, CameraFrame
from robot_runtime.vision.card_camera import CardCamera

EATEN_BYTES = 10_000_000


class FaultyCamera(Camera):
    """Draws calm water, as long as nothing else is asked for."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._drawn = CardCamera(64, 48, SteadyClock(), lambda: None)

    def read(self) -> CameraFrame:
        """Draw a picture, crashes, hang, or eats memory."""
        if (self._folder / "crash").exists():
            os.kill(os.getpid(), signal.SIGSEGV)
        while (self._folder / "hang").exists():
            (self._folder / "hangs").touch()
            signal.pause()
        eaten = []
        while (self._folder / "eat").exists():
            eaten.append(np.empty(EATEN_BYTES, np.uint8))
        return self._drawn.read()

    def close(self) -> None:
        """Do nothing."""

    def __str__(self) -> str:
        return "faulty camera"


if __name__ == "__main__":
    os._exit(vision.main(lambda: FaultyCamera(Path(sys.argv[1]))))
