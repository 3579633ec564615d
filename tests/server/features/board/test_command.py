"""`mucat upload` and `mucat bring-up` beside no server, with a stand-in for the program that uploads."""

from pathlib import Path

import pytest

from robot_runtime.places import FIRMWARE_REMEDY
from robot_runtime.simulation.boards import firmware
from server.cli import main
from server.platform.settings import Settings
from tests.server.features.board.real_board import UploadedRobot


@pytest.fixture
def robot(settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> UploadedRobot:
    return UploadedRobot(settings, tmp_path, monkeypatch)


def run(robot: UploadedRobot, command: str) -> int:
    link = robot.settings.link
    robot.settings.config.write_text(
        f'[robot]\nmode = "robot"\n[link]\nport = "{link.port}"\nreset = "{link.reset}"\n'
    )
    return main([command, "--config", str(robot.settings.config), "--data", str(robot.settings.data.path)])


def test_an_upload_that_is_cut_off_is_noted_for_the_next_server(
    robot: UploadedRobot, capsys: pytest.CaptureFixture[str]
) -> None:
    robot.upload_does(f"if [ -e {robot.marker} ]; then echo noted >> {robot.uploads}; fi")
    assert run(robot, "upload") == 0
    output = robot.uploads.read_text().splitlines()
    assert [line.split()[2] for line in output if "--" in line] == ["--read-out", "--restore"]
    assert output.count("noted") == 2
    assert not robot.marker.exists()
    assert f"to {robot.settings.link.port}" in capsys.readouterr().out


def test_a_failed_upload_says_why_and_stays_noted(
    robot: UploadedRobot, capsys: pytest.CaptureFixture[str]
) -> None:
    robot.upload_does("echo avrdude: not in sync; exit 1")
    assert run(robot, "upload") == 1
    assert "not on its board: avrdude: not in sync" in capsys.readouterr().err
    assert robot.marker.exists()


def test_without_a_note_there_is_no_upload(robot: UploadedRobot, capsys: pytest.CaptureFixture[str]) -> None:
    robot.marker.mkdir()
    assert run(robot, "upload") == 1
    assert "firmware-away cannot be written" in capsys.readouterr().err
    assert not robot.uploads.exists()


def test_a_bring_up_without_its_sketch_says_what_makes_it(
    robot: UploadedRobot, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(firmware, "bring_up_path", lambda *_: Path("/nowhere/bring_up.hex"))
    assert run(robot, "bring-up") == 1
    assert f"There is no /nowhere/bring_up.hex; {FIRMWARE_REMEDY}." in capsys.readouterr().err
    assert not robot.marker.exists()
