"""Commands that give way to robots in real time."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from robot_runtime.experiments.mission_trial import __main__ as trial
from robot_runtime.experiments.scenario import __main__ as scenario
from server.features.comparison import __main__ as comparison
from server.features.exports import __main__ as exports
from tests.beside import NICENESS
from tests.browser.chromium import ARGUMENTS, HEADLESS_SHELL
from tests.stack import ROOT
from tests.waiting import SECONDS, wait_for

BESIDE = [sys.executable, "-m", "tests.beside"]


def test_a_command_has_a_session_of_little_weight_and_its_exit_code_is_told() -> None:
    own = Path("/proc/self/autogroup")
    if not own.exists():
        pytest.skip("this kernel does not share the processors by session")
    # Its weight is set once it runs: it waits for that.
    command = f"""
import os, sys
while not (said := open("/proc/self/autogroup").read()).endswith("nice {NICENESS}\\n"):
    pass
print(os.getsid(0) == os.getpid(), said)
sys.exit(3)
"""
    whole = [*BESIDE, sys.executable, "-c", command]
    ended = subprocess.run(whole, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert ended.returncode == 3
    assert ended.stdout.startswith("True")
    assert own.read_text() not in ended.stdout


def test_a_browser_gives_way_with_its_session_as_far_as_its_test() -> None:
    own = Path("/proc/self/autogroup")
    if not own.exists():
        pytest.skip("this kernel does not share the processors by session")
    line = ["nice", "-n", "3", str(HEADLESS_SHELL), *ARGUMENTS, "--remote-debugging-port=0"]
    niceness = min(os.getpriority(os.PRIO_PROCESS, 0) + 3 + 5, 19)
    with subprocess.Popen(line, start_new_session=True, stderr=subprocess.DEVNULL) as browser:
        try:
            weight = Path(f"/proc/{browser.pid}/autogroup")
            wait_for(lambda: weight.read_text().endswith(f"nice {niceness}\n"), "its weight")
        finally:
            os.killpg(browser.pid, signal.SIGKILL)


def test_a_command_gives_way_to_what_robots_compute_beside_their_swimming() -> None:
    assert max(exports.NICENESS, comparison.NICENESS, scenario.NICENESS, trial.NICENESS) <= NICENESS


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_ends_it_ends_the_command(number: signal.Signals) -> None:
    process = subprocess.Popen(
        [*BESIDE, "sh", "-c", "echo runs; exec sleep 600"], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    with process:
        assert process.stdout is not None
        assert process.stdout.readline() == "runs\n"
        os.kill(process.pid, number)
        assert process.wait(SECONDS) == 128 + number
