"""The whole stack: firmware uploaded by HTTP to the emulated board, and the older one put back."""

from typing import Any

import pytest

from robot_runtime.simulation.boards.emulator_process import EmulatorClient
from server.features.board.previous_firmware import read_program
from tests.board.rig import ROOT
from tests.stack import Stack
from tests.waiting import SECONDS, wait_for

pytestmark = pytest.mark.stack


def upload(stack: Stack, firmware: str) -> tuple[dict[str, Any], set[str]]:
    """Upload this firmware; the state afterwards, and the phases that were seen."""
    answer = stack.api.post("/firmware", json={"firmware": firmware}, timeout=SECONDS)
    assert answer.status_code == 200, answer.text
    assert stack.api.post("/firmware", json={"firmware": firmware}).status_code == 409
    seen: dict[str, list[float]] = {}
    state: dict[str, Any] = answer.json()

    def idle() -> bool:
        nonlocal state
        state = stack.api.get("/firmware").json()
        seen.setdefault(state["phase"], []).append(state["progress"])
        return bool(state["phase"] == "idle")

    wait_for(idle, "the end of the upload", SECONDS)
    assert any(0 < share < 1 for share in seen["uploading"])
    assert seen["uploading"] == sorted(seen["uploading"])
    return state, set(seen)


def test_firmware_is_uploaded_verified_and_the_older_one_put_back(shared_stack: Stack) -> None:
    stack = shared_stack
    previous = stack.data / "firmware-previous.hex"
    with EmulatorClient(stack.data / "run/board.sock") as board:
        board.load(ROOT / "build/firmware/bring_up.elf")
    state, phases = upload(stack, "built")
    assert phases == {"reading", "uploading", "idle"}
    assert (state["problem"], state["previous"]["path"]) == ("", str(previous))
    assert "read back and compared" in state["words"]
    assert read_program(previous) == read_program(ROOT / "build/firmware/bring_up.hex")
    stack.wait_ready()

    # Uploaded once more, it is the same, and the older one stays.
    state, _ = upload(stack, "built")
    assert "The same was on it before." in state["words"]
    assert read_program(previous) == read_program(ROOT / "build/firmware/bring_up.hex")

    state, phases = upload(stack, "previous")
    assert phases == {"uploading", "idle"}
    assert "The previous firmware is on the board" in state["words"]
    previous.unlink()
    # What was put back is on the board: it is read from there.
    state, _ = upload(stack, "built")
    assert f"stored as {previous}" in state["words"]
    # The boot loader has left the end of the longer firmware behind it.
    assert read_program(previous).startswith(read_program(ROOT / "build/firmware/bring_up.hex"))
    stack.wait_ready()
