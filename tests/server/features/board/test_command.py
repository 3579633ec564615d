"""`mucat upload` beside no server, with a stand-in for the program that uploads."""

from pathlib import Path

import pytest

from server.cli import main
from server.platform.settings import Settings
from tests.server.features.board.real_board import Robot


@pytest.fixture
def robot(settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Robot:
    return Robot(settings, tmp_path, monkeypatch)


def upload(robot: Robot) -> int:
    link = robot.settings.link
    robot.settings.config.write_text(
        f'[robot]\nmode = "robot"\n[link]\nport = "{link.port}"\nreset = "{link.reset}"\n'
    )
    return main(["upload", "--config", str(robot.settings.config), "--data", str(robot.settings.data.path)])


def test_an_upload_that_is_cut_off_is_noted_for_the_next_server(
    robot: Robot, capsys: pytest.CaptureFixture[str]
) -> None:
    robot.upload_does(f"if [ -e {robot.marker} ]; then echo noted >> {robot.uploads}; fi")
    assert upload(robot) == 0
    said = robot.uploads.read_text().splitlines()
    assert [line.split()[2] for line in said if "--" in line] == ["--read-out", "--restore"]
    assert said.count("noted") == 2
    assert not robot.marker.exists()
    assert f"to {robot.settings.link.port}" in capsys.readouterr().out


def test_a_failed_upload_says_why_and_stays_noted(robot: Robot, capsys: pytest.CaptureFixture[str]) -> None:
    robot.upload_does("echo avrdude: not in sync; exit 1")
    assert upload(robot) == 1
    assert "not on its board: avrdude: not in sync" in capsys.readouterr().err
    assert robot.marker.exists()


def test_without_a_note_there_is_no_upload(robot: Robot, capsys: pytest.CaptureFixture[str]) -> None:
    robot.marker.mkdir()
    assert upload(robot) == 1
    assert "firmware-away cannot be written" in capsys.readouterr().err
    assert not robot.uploads.exists()
