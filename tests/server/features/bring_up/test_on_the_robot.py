"""The whole stack: a bring-up on the robot's own board, here emulated, by HTTP and from a shell."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from tests.board.rig import OPTIBOOT, PROGRAM, ROOT
from tests.stack import Stack
from tests.waiting import SECONDS, wait_for

pytestmark = pytest.mark.stack


def state(stack: Stack) -> dict[str, Any]:
    answer: dict[str, Any] = stack.api.get("/bring-up").json()
    return answer


def act(stack: Stack, step: str, action: str, **inputs: float | str) -> dict[str, Any]:
    """Perform an action; the step as it is then."""
    body = {"step": step, "action": action, "inputs": inputs}
    answer = stack.api.post("/bring-up/actions", json=body, timeout=SECONDS)
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = next(entry for entry in answer.json()["steps"] if entry["name"] == step)
    return result


def test_a_bring_up_by_http_and_the_robot_is_back_afterwards(shared_stack: Stack) -> None:
    stack = shared_stack
    wait_for(lambda: stack.api.get("/robot").json().get("connected"), "the robot")
    assert stack.api.get("/bring-up/report").status_code == 404
    answer = stack.api.post("/bring-up", timeout=SECONDS)
    assert answer.status_code == 200, answer.text
    assert stack.api.post("/bring-up", timeout=SECONDS).status_code == 409
    wait_for(lambda: state(stack)["phase"] == "ready", "the sketch")
    assert stack.api.post("/robot/commands/arm").status_code == 409
    wait_for(lambda: state(stack)["raw"], "a reading")
    assert act(stack, "devices", "scan")["state"] == "done"
    assert act(stack, "sensors", "look")["state"] == "done"
    for _ in range(6):
        act(stack, "motor_3", "turn", on=1)
        # As a page does while a button is held.
        time.sleep(0.1)
    act(stack, "motor_3", "turn", stop=1)
    assert act(stack, "motor_3", "seen", fin="front left")["state"] == "done"
    refused = stack.api.post("/bring-up/actions", json={"step": "gyro", "action": "rest"})
    assert (refused.status_code, "how the IMU lies" in refused.json()["detail"]) == (409, True)
    act(stack, "motor_3", "turn")
    assert stack.api.post("/robot/stop").status_code == 204
    held = {"step": "motor_3", "action": "turn", "inputs": {"on": 1}}
    refused = stack.api.post("/bring-up/actions", json=held)
    assert (refused.status_code, "STOP was pressed" in refused.json()["detail"]) == (409, True)
    assert stack.api.delete("/bring-up").status_code == 200
    wait_for(lambda: state(stack)["phase"] == "idle", "the firmware")
    assert state(stack)["problem"] == ""
    report = stack.api.get("/bring-up/report").text
    assert "<h1>Bring-up of" in report
    assert "H-bridge of the back left fin at 0x61" in report
    wait_for(lambda: stack.api.get("/robot").json().get("connected"), "the robot")
    assert not (stack.data / "firmware-away").exists()


def awaits_input(process: int) -> bool:
    """Return True while it is blocked in a call whose first argument is file 0.

    Python would notice a signal just before such a call only after it.
    """
    return Path(f"/proc/{process}/syscall").read_text(encoding="ascii").split()[1:2] == ["0x0"]


@pytest.fixture
def bring_up(tmp_path: Path) -> Iterator[list[str]]:
    """The command, for an emulated board in place of a real one, which a shell uploads to and talks to."""
    tty, socket = tmp_path / "tty", tmp_path / "board"
    config = tmp_path / "robot.toml"
    config.write_text(
        f'[robot]\nmode = "robot"\n[link]\nport = "{tty}"\nreset = "board:{socket}"\n', encoding="utf-8"
    )
    options = ("--bootloader", str(OPTIBOOT), "--uncalibrated", "--mistake", "imu-strap")
    elf = ROOT / "build/firmware/robot.elf"
    with EmulatorProcess(PROGRAM, elf, tty, socket, *options):
        # A shell in the background starts its commands without Ctrl-C.
        ctrl_c = "from signal import *; signal(SIGINT, default_int_handler)"
        code = f"{ctrl_c}; from server.cli import main; raise SystemExit(main())"
        command = [sys.executable, "-c", code, "bring-up"]
        yield [*command, "--config", str(config), "--data", str(tmp_path / "data")]


def test_a_bring_up_from_a_shell(bring_up: list[str], tmp_path: Path) -> None:
    done = subprocess.run(
        bring_up,
        # Look who answers; do not repeat; then end.
        input="\nn\nq\n",
        capture_output=True,
        text=True,
        timeout=SECONDS,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert "BAD  IMU at 0x69: silent  An IMU answers at 0x68" in done.stdout, done.stdout + done.stderr
    assert done.returncode == 1
    assert "Not calibrated" in (tmp_path / "data/bring-up.html").read_text(encoding="utf-8")
    assert not (tmp_path / "data/firmware-away").exists()


def test_ctrl_c_at_a_prompt_ends_a_bring_up_and_the_firmware_comes_back(
    bring_up: list[str], tmp_path: Path
) -> None:
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        bring_up, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
    ) as process:
        assert process.stdout is not None
        answer = b""
        while b"q: end" not in answer:
            more = os.read(process.stdout.fileno(), 4096)
            assert more, answer
            answer += more
        wait_for(lambda: awaits_input(process.pid), "the prompt")
        process.send_signal(signal.SIGINT)
        # Its input stays open, and nothing comes from it.
        assert process.wait(SECONDS) == 130
        assert process.stderr is not None
        assert b"The robot's firmware is back on its board" in process.stderr.read()
    assert not (tmp_path / "data/firmware-away").exists()
