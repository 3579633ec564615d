"""`python -m tests.runtime.vision.lonely_parent FOLDER` starts a faulty vision process, and waits for ever.

It prints the process's PID.
"""

import sys
import threading
import time

from robot_runtime.clock import SteadyClock
from robot_runtime.config import VisionConfig
from robot_runtime.vision.interface import VisionOutputs
from robot_runtime.vision.process import VisionProcess


def main() -> None:
    """Never returns."""
    program = (sys.executable, "-m", "tests.runtime.vision.faulty_vision", sys.argv[1])
    outputs = VisionOutputs(detection=lambda _: None, event=lambda _: None)
    vision = VisionProcess(VisionConfig(), SteadyClock(), outputs, "turtle", "nowhere", program)
    vision.start()
    while vision.refusals():
        time.sleep(0.01)
    sys.stdout.write(f"{vision.pid}\n")
    sys.stdout.flush()
    threading.Event().wait()


if __name__ == "__main__":
    main()
