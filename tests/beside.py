"""`python -m tests.beside COMMAND ...`: runs a command beside robots in real time, which come first.

Linux shares the processors between sessions, and only within a session by niceness (sched(7), "The autogroup
feature"). Robots and browsers have sessions of their own, so the command gets one, too, of little weight.
"""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

NICENESS = 15
"""Of the session: an export's. With more weight tests in real time would wait for their exports."""
_LOOK = 0.05
"""s"""
_AGAIN = 0.1
"""s. The kernel takes one change in that time from all who are not root."""


def main(command: list[str]) -> int:
    """Return the command's exit code, as a shell does; passes on the signals that end it."""
    ending: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: ending.append(number))
    child = subprocess.Popen(command, start_new_session=True)
    _give_way(child.pid)
    while (status := child.poll()) is None:
        while ending:
            os.killpg(child.pid, ending.pop())
        time.sleep(_LOOK)
    return status if status >= 0 else 128 - status


def _give_way(session: int) -> None:
    """Do nothing where the kernel does not share by session, or the session has ended."""
    with suppress(FileNotFoundError, ProcessLookupError):
        while True:
            try:
                Path(f"/proc/{session}/autogroup").write_text(str(NICENESS), "ascii")
            except BlockingIOError:
                time.sleep(_AGAIN)
            else:
                return


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
