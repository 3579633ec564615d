"""The Makefile's targets build what they run."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("target", ["bench", "proofs", "faults", "robot-faults", "test-rest", "attacks"])
def test_what_runs_the_firmware_on_this_computer_builds_it(target: str) -> None:
    plain = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    line = ["make", "--dry-run", "--always-make", target]
    done = subprocess.run(line, cwd=ROOT, env=plain, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "firmware host hang full proofs" in done.stdout
