"""`python -m tests.timed COMMAND ...`: runs a command, and writes how long it took as its last line."""

import ctypes
import os
import subprocess
import sys
import time

_SET_CHILD_SUBREAPER = 36


def main(command: list[str]) -> int:
    """Return the command's exit code."""
    begin = time.monotonic()
    # A browser ends before its processes. Their times are told to who waits for them: this one, by prctl(2).
    ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    child = subprocess.Popen(command)
    while True:
        process, result = os.wait()
        if process == child.pid:
            break
    status = child.returncode = os.waitstatus_to_exitcode(result)
    times = os.times()
    minutes = (time.monotonic() - begin) / 60
    processor = (times.children_user + times.children_system) / 60
    print(f"{minutes:.1f} minutes, {processor:.1f} processor minutes")  # noqa: T201 - it is run from a shell
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
