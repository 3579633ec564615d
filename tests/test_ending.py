"""The end of a process that runs tests."""

import subprocess
import sys
from pathlib import Path

from tests.stack import ROOT
from tests.waiting import SECONDS

STAYING = """
import threading

from tests import conftest

conftest.END_SECONDS = 0.2


def wait_for_ever():
    threading.Event().wait()


def test_that_leaves_a_thread():
    threading.Thread(target=wait_for_ever).start()
"""


def test_a_thread_that_a_test_leaves_fails_the_run_and_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "test_staying.py"
    path.write_text(STAYING, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-p", "tests.conftest", "--rootdir", str(tmp_path), str(path)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert "1 passed" in ended.stdout
    assert ended.returncode == 1
    assert "in wait_for_ever" in ended.stderr
