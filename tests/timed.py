"""`python -m tests.timed COMMAND ...`: runs a command, and writes how long it took as its last line."""

import os
import subprocess
import sys
import time


def main(command: list[str]) -> int:
    """Return the command's exit code."""
    begin = time.monotonic()
    status = subprocess.run(command, check=False).returncode
    times = os.times()
    minutes = (time.monotonic() - begin) / 60
    processor = (times.children_user + times.children_system) / 60
    print(f"{minutes:.1f} minutes, {processor:.1f} processor minutes")  # noqa: T201 - it is run from a shell
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
