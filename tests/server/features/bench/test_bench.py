"""`mucat bench`: figures of a running robot, and its report."""

import os
import time
from pathlib import Path

import pytest

from server.cli import main
from server.features.bench import process_figures
from server.features.bench.measurement import LoadFigures, StartFigures, measure_load, measure_start
from server.features.bench.report import write_report
from server.features.bench.robot_processes import find_processes
from server.platform.folder_lock import runner_of
from server.platform.settings import DataFolder, SetupError
from tests.stack import Stack

STATE = {
    "profile": "lean",
    "baud": 115200,
    "connected": True,
    "armed": False,
    "vision_rate": 2.0,
}


def test_processor_time_and_memory_are_counted_as_the_kernel_does() -> None:
    before = process_figures.cpu_seconds(os.getpid())
    end = time.process_time() + 0.2
    while time.process_time() < end:
        pass
    assert process_figures.cpu_seconds(os.getpid()) - before == pytest.approx(0.2, abs=0.1)
    held = process_figures.anonymous_mb(os.getpid())
    more = bytearray(b"1" * 30_000_000)
    assert process_figures.anonymous_mb(os.getpid()) - held == pytest.approx(30, abs=3)
    assert more
    assert os.getpid() in set(process_figures.family(os.getppid()))


def test_without_a_robot_it_says_how_one_is_started(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "--data", str(tmp_path)]) == 1
    assert "Start it with `mucat run`" in capsys.readouterr().err


def test_the_report_sums_up_what_a_robot_has_and_leaves_out_water_and_board() -> None:
    dive = LoadFigures(
        seconds=60.0,
        percent={"server": 2.0, "runtime": 3.0, "board": 9.0, "simulator": 8.0},
        mb={"server": 60.0, "runtime": 20.0, "board": 1.0, "simulator": 17.0},
        period_ms=100.0,
        jitter_ms=(0.1, 2.5, 7.0),
        ticks=600,
        samples=12_000,
        samples_lost=0,
        viewer_kb_per_s=42.4,
        viewer_left_out=0,
        alarms=("The depth is old.",),
    )
    text = write_report(StartFigures(page_s=12.3, cpu_s=4.5), dive, STATE)
    assert "| **the robot's software** | **5.0 %, 80 MB** |" in text
    assert "| board, not of a robot | 9.0 %, 1 MB |" in text
    assert "profile lean, 115200 baud, disarmed, vision at 2 Hz" in text
    assert "| alarms | The depth is old. |" in text


def test_a_server_s_start_is_measured_beside_a_robot_and_what_keeps_it_from_starting_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    figures = measure_start()
    assert figures.page_s > 0
    assert figures.cpu_s > 0
    monkeypatch.setenv("PYTHONPATH", "/nowhere")
    monkeypatch.setenv("PYTHONHOME", "/nowhere")
    with pytest.raises(SetupError, match="does not start here"):
        measure_start()


@pytest.mark.stack
def test_a_recording_is_measured_and_only_one_of_its_own_is_removed(shared_stack: Stack) -> None:
    folder = DataFolder(shared_stack.data)
    runner = runner_of(folder)
    assert runner is not None
    assert {"runner", "server", "runtime", "vision", "simulator", "board"} <= set(
        find_processes(runner, folder.run)
    )
    before = [session["id"] for session in shared_stack.api.get("/sessions").json()]
    lines: list[str] = []
    figures = measure_load(folder, 1.0, lines.append)
    assert 8 <= figures.ticks <= 12
    assert figures.period_ms == pytest.approx(100, abs=20)
    assert figures.samples > 100
    assert figures.viewer_kb_per_s > 1
    assert figures.robot_percent > 0
    assert lines
    assert [session["id"] for session in shared_stack.api.get("/sessions").json()] == before
    mine = shared_stack.api.post("/sessions", json={"name": "mine"}).raise_for_status().json()["id"]
    measure_load(folder, 1.0, lines.append)
    assert shared_stack.api.get("/sessions").json()[0]["id"] == mine
    shared_stack.api.post(f"/sessions/{mine}/stop").raise_for_status()
