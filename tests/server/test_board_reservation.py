"""The robot's board passed between runtime and lab. For uploads to a board see test_reserved_board.py."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import server.board_reservation as handover_module
import server.stream.bridge as bridge_module
from robot_runtime.errors import RefusedError
from server.board_reservation import BoardReservation
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.processes.supervisor import ProcessSupervisor
from tests.server.blocks import state_block
from tests.server.features.board.real_board import UploadedRobot, disarming
from tests.server.serving import Served
from tests.server.waiting import until


@pytest.fixture
def robot(settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> UploadedRobot:
    return UploadedRobot(settings, tmp_path, monkeypatch)


@pytest.fixture
async def served(robot: UploadedRobot) -> AsyncIterator[Served]:
    async with robot.serve() as served:
        yield served


def runtime_state(served: Served) -> str:
    part = served.get(ProcessSupervisor).get("runtime")
    assert part is not None
    return part.state


async def health(served: Served) -> dict[str, tuple[str, str]]:
    processes = (await served.api.get("/health")).json()["parts"]
    return {part["name"]: (part["state"], part["text"]) for part in processes}


@asynccontextmanager
async def reserved_reason(served: Served, name: str = "tested") -> AsyncIterator[list[str]]:
    """Reserve the board, with a runtime that reports after STOP that the robot is disarmed."""
    async with (
        disarming(served),
        served.get(BoardReservation).reserve(f"The communication test “{name}”") as arguments,
    ):
        yield arguments


async def test_the_board_is_reserved_and_released(robot: UploadedRobot) -> None:
    async with robot.serve() as served:
        await until(robot.started.exists, "the runtime")
        async with reserved_reason(served, "grid") as arguments:
            assert served.runtime.asked == [("stop", {})]
            assert arguments[:2] == ["--port", robot.settings.link.port]
            assert arguments[-2:] == ["--reset", "dtr"]
            assert (runtime_state(served), robot.marker.exists(), robot.uploads.exists()) == (
                *("paused", True),
                False,
            )
            processes = await health(served)
            for name in ("runtime", "link", "board"):
                assert processes[name][0] == "absent"
                assert "The communication test “grid” has the robot's board" in processes[name][1]
            for path, body in (("robot/commands/arm", None), ("sessions", {})):
                answer = await served.api.post(f"/{path}", json=body)
                assert (answer.status_code, "“grid”" in answer.json()["detail"]) == (409, True)
            assert (await served.api.post("/robot/stop")).status_code == 204
            with pytest.raises(RefusedError, match="grid"):
                async with served.get(BoardReservation).reserve("The communication test “another”"):
                    pass
            assert runtime_state(served) == "paused"
        assert "--restore" in robot.uploads.read_text()
        assert not robot.marker.exists()
        await until(lambda: runtime_state(served) == "running", "the runtime again")
        assert (await served.api.post("/robot/commands/arm")).status_code == 204
        assert (await served.api.post("/sessions", json={})).status_code == 201


async def test_no_reservation_while_a_session_records(robot: UploadedRobot) -> None:
    async with robot.serve() as served:
        assert (await served.api.post("/sessions", json={"name": "dive"})).status_code == 201
        with pytest.raises(RefusedError, match="“dive” is being recorded"):
            async with served.get(BoardReservation).reserve("tested"):
                pass
        assert served.runtime.asked == []


@pytest.mark.parametrize("state", [{"armed": True}, {"armed": False, "time": 0.0}, None])
async def test_no_reservation_before_the_robot_reports_that_it_is_disarmed(
    robot: UploadedRobot, monkeypatch: pytest.MonkeyPatch, state: dict[str, Any] | None
) -> None:
    monkeypatch.setattr(handover_module, "DISARM_SECONDS", 0.3)

    async with robot.serve() as served:
        await until(robot.started.exists, "the runtime")
        if state is not None:
            served.runtime.publish(state_block(0, **{"time": served.container.clock.now() + 60} | state))
            await until(served.get(HealthMonitor).state, "the state")
        with pytest.raises(RefusedError, match="was not disarmed within"):
            async with served.get(BoardReservation).reserve("tested"):
                pass
        assert (runtime_state(served), robot.marker.exists()) == ("running", False)
        assert (await served.api.post("/robot/commands/arm")).status_code == 204


async def test_no_reservation_without_an_answer_to_stop(
    robot: UploadedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bridge_module, "ANSWER_SECONDS", 0.3)

    async with robot.serve() as served:
        served.runtime.gates["stop"].clear()
        with pytest.raises(RefusedError, match="could not be disarmed before"):
            async with served.get(BoardReservation).reserve("tested"):
                pass
        served.runtime.gates["stop"].set()
        assert not robot.marker.exists()


async def test_no_reservation_without_its_note_on_the_disk(robot: UploadedRobot) -> None:
    async with robot.serve() as served:
        robot.marker.mkdir()
        with pytest.raises(RefusedError, match="firmware-away cannot be written"):
            async with reserved_reason(served):
                pass
        assert not robot.uploads.exists()
        await until(lambda: runtime_state(served) == "running", "the runtime again")


async def test_no_reservation_where_an_external_runtime_cannot_be_paused(robot: UploadedRobot) -> None:
    robot.runtime = replace(robot.runtime, external=True)

    async with robot.serve() as served:
        runtime = served.get(ProcessSupervisor).get("runtime")
        assert runtime is not None
        served.settings.data.runtime_paused.mkdir()
        with pytest.raises(RefusedError, match="cannot be written"):
            async with reserved_reason(served):
                pass
        assert not robot.marker.exists()
        await until(lambda: runtime.state == "waiting", "the runtime to be watched again")


async def test_firmware_stays_away_where_an_external_runtime_cannot_be_paused(robot: UploadedRobot) -> None:
    robot.runtime = replace(robot.runtime, external=True)
    robot.marker.touch()
    robot.settings.data.runtime_paused.mkdir()

    async with robot.serve() as served:
        monitor, runtime = served.get(HealthMonitor), served.get(ProcessSupervisor).get("runtime")
        await until(lambda: monitor.firmware_away is not None, "the reason")
        assert "cannot be written" in (monitor.firmware_away or "")
        assert (robot.marker.exists(), robot.uploads.exists()) == (True, False)
        assert runtime is not None
        await until(lambda: runtime.state == "waiting", "the runtime to be watched")


async def test_a_failed_firmware_restore_is_reported_and_the_next_test_retries_it(
    robot: UploadedRobot,
) -> None:
    async with robot.serve() as served:
        robot.upload_does("echo avrdude: not in sync; exit 1")
        async with reserved_reason(served):
            pass
        assert robot.marker.exists()
        served.runtime.publish(state_block(1500, connected=False, connection="no answer"))
        await until(lambda: (served.get(HealthMonitor).state() or {}).get("connected") is False, "the state")
        state, text = (await health(served))["link"]
        assert state == "failed"
        assert "not in sync" in text
        assert "start the server again" in text
        await until(lambda: runtime_state(served) == "running", "the runtime all the same")
        robot.upload_does("exit 0")
        async with reserved_reason(served):
            pass
        assert not robot.marker.exists()
        assert "not in sync" not in (await health(served))["link"][1]


async def test_of_a_restore_without_output_the_end_of_its_process_is_reported(robot: UploadedRobot) -> None:
    async with robot.serve() as served:
        robot.upload_does("echo avrdude: not in sync; exit 1")
        async with reserved_reason(served):
            pass
        robot.upload_does("kill -KILL $$")
        async with reserved_reason(served):
            pass
        problem = served.get(HealthMonitor).firmware_away
        assert problem is not None
        assert "on its board: the upload was ended by signal SIGKILL. Check" in problem


async def test_after_an_interrupted_test_the_firmware_is_restored_before_the_runtime_starts(
    robot: UploadedRobot,
) -> None:
    robot.marker.touch()

    async with robot.serve() as served:
        # The file is there a moment before its text.
        await until(lambda: robot.started.exists() and robot.started.read_text(), "the runtime")
        assert robot.started.read_text() == "True"
        assert not robot.marker.exists()
        assert (await served.api.post("/robot/commands/arm")).status_code == 204


async def test_without_a_port_the_runtime_starts_and_the_note_stays(
    robot: UploadedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(handover_module, "PORT_SECONDS", 0.1)
    Path(robot.settings.link.port).unlink()
    robot.marker.touch()

    async with robot.serve() as served:
        await until(robot.started.exists, "the runtime")
        assert (robot.marker.exists(), robot.uploads.exists()) == (True, False)
        assert f"there is no {robot.settings.link.port}" in (served.get(HealthMonitor).firmware_away or "")
