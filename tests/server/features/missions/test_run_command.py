"""`mucat mission run` beside a running robot: it follows a mission to its end, or says that it broke off."""

import os
import subprocess
from functools import partial
from pathlib import Path

import pytest

from tests.runtime.missions.water import mission
from tests.stack import Stack
from tests.waiting import SECONDS, wait_for

SHORT = mission("{ do = 'hold', seconds = 1, within = 9 }", "{ do = 'surface' }")
LONG = mission("{ do = 'hold', seconds = 150, within = 9 }")


def start(stack: Stack, folder: Path, text: str) -> "subprocess.Popen[str]":
    """Start the command on a mission of this text."""
    file = folder / "test.toml"
    file.write_text(text)
    environment = {**os.environ, "MUCAT_DATA": str(stack.data), "PYTHONUNBUFFERED": "1"}
    command = [str(stack.program), "mission", "run", str(file)]
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def swim(stack: Stack, folder: Path) -> str:
    """Run the command on a short mission to its end; return what it printed."""
    with start(stack, folder, SHORT) as command:
        try:
            output, _ = command.communicate(timeout=SECONDS)
        finally:
            command.kill()
    assert command.returncode == 0, output
    assert output.splitlines()[-1] == "succeeded: It is done."
    wait_for(lambda: not stack.api.get("/robot").json()["armed"], "the robot to be disarmed")
    return output


def _is_ready_after(stack: Stack, run: str) -> bool:
    """Return True where another runtime than this one can arm."""
    answer = stack.api.get("/robot")
    return answer.is_success and answer.json()["run"] != run and not answer.json()["refusals"]


@pytest.mark.stack
def test_a_mission_is_followed_to_its_end(shared_stack: Stack, tmp_path: Path) -> None:
    answer = swim(shared_stack, tmp_path)
    assert "test begins." in answer
    assert "1 Hold the depth for 1 s: done" in answer


@pytest.mark.stack
def test_the_first_mission_of_a_restarted_runtime_is_followed(shared_stack: Stack, tmp_path: Path) -> None:
    for _ in range(2):
        run = shared_stack.api.get("/robot").json()["run"]
        shared_stack.part("runtime").kill()
        wait_for(partial(_is_ready_after, shared_stack, run), "the next runtime")
        swim(shared_stack, tmp_path)
        assert shared_stack.api.get("/missions/state").json()["number"] == 1


@pytest.mark.stack
def test_a_killed_runtime_ends_it_with_words(shared_stack: Stack, tmp_path: Path) -> None:
    with start(shared_stack, tmp_path, LONG) as command:
        assert command.stdout is not None
        assert any("running" in line for line in command.stdout)
        shared_stack.part("runtime").kill()
        output, _ = command.communicate(timeout=SECONDS)
    assert command.returncode == 1, output
    assert "runtime" in output
    shared_stack.wait_ready()
