import asyncio
import hashlib
import zipfile
from pathlib import Path
from typing import get_args

import pytest

from server.cli import main
from server.features.exports import workbook
from server.features.exports.command import FORMATS
from server.features.exports.schemas import Format
from server.platform.running_server import announce
from server.platform.server_config import ServerConfig
from server.platform.settings import Settings
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import record
from tests.server.new_database import new_store
from tests.server.serving import serve


@pytest.fixture
def session(settings: Settings) -> int:
    with new_store(settings.data) as store:
        return record(store, settings, [depth_block(0, 20)])


def run(settings: Settings, *arguments: str, data: Path | None = None) -> int:
    where = ["--data", str(data or settings.data.path), "--config", str(settings.config)]
    return main([*arguments, *where])


def test_a_session_is_exported_and_imported_by_shell_commands(
    settings: Settings, session: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "dive.zip"
    assert run(settings, "export", str(session), "--format", "archive", "-o", str(path)) == 0
    assert hashlib.sha256(path.read_bytes()).hexdigest() in capsys.readouterr().out
    assert [file.name for file in tmp_path.iterdir()] == ["dive.zip"]
    assert run(settings, "import", str(path), data=tmp_path / "other") == 0
    assert capsys.readouterr().out == "session 1: Dive no. 1: Öresund/../x\n"
    assert run(settings, "import", str(path), data=tmp_path / "other") == 1
    assert "is here already, as number 1" in capsys.readouterr().err
    tables = tmp_path / "tables.zip"
    expected = ["--format", "csv", "--topics", "depth", "--start", "0.6", "--end", "0.7"]
    assert run(settings, "export", "1", *expected, "-o", str(tables), data=tmp_path / "other") == 0
    assert len(zipfile.ZipFile(tables).read("depth.csv").splitlines()) == 7


async def test_the_import_command_uses_a_running_server(
    settings: Settings, session: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "dive.zip"
    assert run(settings, "export", str(session), "--format", "archive", "-o", str(path)) == 0

    async with serve(settings) as served:
        lock = settings.data.lock.open("w")
        import fcntl

        fcntl.flock(lock, fcntl.LOCK_EX)
        announce(served.settings)
        assert await asyncio.to_thread(run, settings, "import", str(path)) == 1
        assert "is here already, as number 1" in capsys.readouterr().err
        announce(settings.with_section(ServerConfig(port=1)))
        assert await asyncio.to_thread(run, settings, "import", str(path)) == 1
        assert "does not answer at http://127.0.0.1:1" in capsys.readouterr().err
        lock.close()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["export", "9"], "There is no session 9"),
        (["export", "1", "--topics", "x"], "no topic x"),
        (["export", "1", "--topics", "depth", "x"], "no topic x"),
        (["export", "1", "--topics", "depth", "--topics", "x"], "no topic x"),
        (["export", "1", "--format", "csv-grid", "--period", "0"], "period: "),
        (["export", "1", "-o", "/nowhere/x"], "/nowhere cannot be written"),
        (["import", "/nowhere"], "There is no file /nowhere"),
        (["import", "robot.toml"], "It is no zip file"),
    ],
)
def test_impossible_requests_are_refused_with_the_reason(
    settings: Settings, session: int, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert session == 1
    assert run(settings, *arguments) == 1
    assert message in capsys.readouterr().err


def test_the_shell_knows_every_format() -> None:
    assert set(FORMATS) == set(get_args(Format))


@pytest.mark.parametrize("typed", ["1,5", "1_0", "nan", "1.234,5", "0x1"])
def test_a_number_in_another_notation_is_refused_in_words(
    settings: Settings, session: int, typed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(settings, "export", str(session), "--start", typed) == 2
    assert "is not a number. Write a decimal point" in " ".join(capsys.readouterr().err.split())


def test_a_spreadsheet_that_shows_too_little_is_said(
    settings: Settings,
    session: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(workbook, "SHEET_LINES", 20)
    choice = ("export", str(session), "--format", "csv", "-o", str(tmp_path / "dive.zip"))
    assert run(settings, *choice) == 0
    assert capsys.readouterr().err == ""
    assert run(settings, *choice, "--spreadsheet", "comma") == 0
    assert capsys.readouterr().err == "depth.csv has 21 lines; a spreadsheet shows 20 of them.\n"
    assert run(settings, "export", str(session), "--format", "xlsx", "-o", str(tmp_path / "dive.xlsx")) == 1
    assert "A sheet holds 19 samples, and depth has 20 in this range." in capsys.readouterr().err
