"""A short form of `make lab-proof`: one robot joins, its session is pulled through a cut, and STOP all."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.stack import ROOT
from tests.two_hosts import available

pytestmark = pytest.mark.stack


def test_a_session_is_pulled_once_through_a_cut_and_the_robot_is_stopped(tmp_path: Path) -> None:
    obstacle = available()
    if obstacle:
        pytest.skip(f"no computers with a network of their own here: {obstacle}")
    command = ["unshare", "--user", "--map-root-user", "--net", sys.executable, "-m", "tests.proofs.lab"]
    done = subprocess.run(
        [*command, "short", str(tmp_path)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr[-4000:]
