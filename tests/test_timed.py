"""The last line of `make test`."""

import re
import subprocess
import sys

from tests.stack import ROOT
from tests.waiting import SECONDS

ABANDONED = """
import os, sys, time
reading, writing = os.pipe()
if os.fork() == 0:
    if (process := os.fork()) == 0:
        # It computes until four seconds are spent: rounded, 0.1 minutes.
        while time.process_time() < 4: pass
    else:
        os.write(writing, str(process).encode())
    os._exit(0)
process = os.read(reading, 20).decode()
while os.path.exists(f"/proc/{process}"): time.sleep(0.01)
sys.exit(3)
"""
"""Starts a process that computes and whose parent ends before it, and waits for its end."""


def test_the_last_line_tells_the_times_also_of_abandoned_processes_and_the_exit_code_is_the_same() -> None:
    ended = subprocess.run(
        [sys.executable, "-m", "tests.timed", sys.executable, "-c", ABANDONED],
        cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False,
    )  # fmt: skip
    assert ended.returncode == 3
    assert re.fullmatch(r"\d+\.\d minutes, 0\.1 processor minutes\n", ended.stdout)
