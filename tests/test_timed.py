"""The last line of `make test`."""

import re
import subprocess
import sys

from tests.stack import ROOT
from tests.waiting import SECONDS


def test_a_command_s_times_are_told_in_the_last_line_and_its_exit_code_is_the_same() -> None:
    # It computes until four seconds are spent: rounded, 0.1 minutes.
    command = [sys.executable, "-c", "import time\nwhile time.process_time() < 4: pass\nraise SystemExit(3)"]
    ended = subprocess.run(
        [sys.executable, "-m", "tests.timed", *command],
        cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False,
    )  # fmt: skip
    assert ended.returncode == 3
    assert re.fullmatch(r"\d+\.\d minutes, 0\.1 processor minutes\n", ended.stdout)
