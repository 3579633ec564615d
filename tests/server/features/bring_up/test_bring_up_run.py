"""The end of a bring-up on a board that refuses uploads, and one that cannot begin."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest

import server.features.bring_up.bring_up_run as bring_up_run
from robot_runtime.config import HilConfig
from robot_runtime.errors import RefusedError
from server.features.bring_up.bring_up_run import BringUpRun
from server.platform.settings import Settings
from server.processes.supervisor import SIMULATION_ELSEWHERE, ProcessSupervisor
from tests.server.features.board.real_board import UploadedRobot, disarming
from tests.server.waiting import until


@pytest.fixture
def robot(settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> UploadedRobot:
    return UploadedRobot(settings, tmp_path, monkeypatch)


async def test_it_says_at_its_end_that_the_firmware_is_not_on_the_board(robot: UploadedRobot) -> None:
    async with robot.serve() as served:
        robot.upload_does("echo avrdude: not in sync; exit 1")
        bring_up = served.get(BringUpRun)
        async with disarming(served):
            await bring_up.begin()
        earlier = await served.api.delete(f"/bring-up?run={'0' * 16}")
        assert (earlier.status_code, "This bring-up is over" in earlier.text) == (409, True)
        await until(lambda: bring_up.state().phase == "idle", "its end")
        state = bring_up.state()
        assert len(state.run) == 16
        order = {"run": "0" * 16, "step": "bus", "action": "skip"}
        assert "This bring-up is over" in (await served.api.post("/bring-up/actions", json=order)).text
        assert state.words == ""
        assert "The sketch is not on the board: avrdude: not in sync" in state.problem
        assert "The robot's firmware is not on its board: avrdude: not in sync" in state.problem


async def test_one_that_is_refused_says_nothing_about_the_board(robot: UploadedRobot) -> None:
    async with robot.serve() as served:
        assert (await served.api.post("/sessions", json={"name": "dive"})).status_code == 201
        with pytest.raises(RefusedError, match="“dive” is being recorded"):
            await served.get(BringUpRun).begin()
        state = served.get(BringUpRun).state()
        assert (state.phase, state.words, state.problem) == ("idle", "", "")


async def test_an_error_of_the_software_is_said(
    robot: UploadedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ValueError("no such thing")

    monkeypatch.setattr(bring_up_run, "SerialBench", fail)

    async with robot.serve() as served:
        bring_up = served.get(BringUpRun)
        async with disarming(served):
            await bring_up.begin()
        await until(lambda: bring_up.state().phase == "idle", "its end")
        state = bring_up.state()
        assert (state.words, "Internal error (ValueError('no such thing'))" in state.problem) == ("", True)


@pytest.mark.parametrize("position", ["here", "elsewhere"])
async def test_in_the_loop_the_simulator_is_where_it_was_before(
    robot: UploadedRobot, position: Literal["here", "elsewhere"]
) -> None:
    """The emulated board is gone, so that the bring-up ends once it has taken it out of the water."""
    robot.settings = replace(
        robot.settings,
        robot=replace(robot.settings.robot, mode="hil"),
        hil=HilConfig(simulator=position),
    )
    robot.settings.data.board_tty.touch()

    async with robot.serve() as served:
        bring_up, simulator = served.get(BringUpRun), served.get(ProcessSupervisor).get("simulator")
        assert simulator is not None
        at_first = "running" if position == "here" else "paused"
        await until(lambda: simulator.state == at_first, "the simulator")
        async with disarming(served):
            await bring_up.begin()
        await until(lambda: bring_up.state().phase == "idle", "its end")
        assert "no emulated board" in bring_up.state().problem
        await until(lambda: simulator.state == at_first, "the simulator again")
        assert (simulator.problem == SIMULATION_ELSEWHERE) == (position == "elsewhere")
