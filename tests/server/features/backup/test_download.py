"""A copy of the database over the network."""

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import pytest

from server.cli import main
from server.features.backup import download
from server.features.backup.download import DatabaseDownloads
from server.http import listener
from server.platform.settings import Settings
from tests.server.serving import Served, serve
from tests.server.waiting import until


def names(database: Path) -> list[str]:
    with closing(sqlite3.connect(database)) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        return [name for (name,) in connection.execute("SELECT name FROM session ORDER BY id")]


async def test_a_downloaded_backup_is_complete_and_can_be_restored(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = tmp_path / "copy.db"

    async with serve(settings) as served:
        for name in ("one", "two"):
            session = (await served.api.post("/sessions", json={"name": name, "note": ""})).json()["id"]
            if name == "one":
                await served.api.post(f"/sessions/{session}/stop")
        answer = await served.api.get("/backup")
        assert answer.status_code == 200
        assert answer.headers["content-disposition"].startswith('attachment; filename="mucat-backup-')
        assert int(answer.headers["content-length"]) == len(answer.content)
        copy.write_bytes(answer.content)
        assert [*served.settings.data.backups.iterdir()] == []
    assert names(copy) == ["one", "two"]
    options = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert main(["restore", str(copy), *options]) == 0
    capsys.readouterr()


async def test_one_download_at_a_time_and_an_aborted_one_frees_its_place(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(download, "PIECE_BYTES", 16)

    async with serve(settings) as served:
        downloads = served.get(DatabaseDownloads)
        async with served.api.stream("GET", "/backup") as first:
            assert first.status_code == 200
            second = await served.api.get("/backup")
            assert (second.status_code, "already" in second.json()["detail"]) == (409, True)
        await until(lambda: not downloads._busy, "the end of the first")
        assert (await served.api.get("/storage")).status_code == 200


async def test_a_client_that_does_not_read_is_disconnected(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(listener, "USER_TIMEOUT_MS", 500)

    async with serve(settings) as served:
        # More than all buffers between the two ends can hold.
        with closing(sqlite3.connect(served.settings.data.database)) as database:
            database.execute("CREATE TABLE filler AS SELECT zeroblob(16000000)")
            database.commit()
        downloads = served.get(DatabaseDownloads)
        async with served.api.stream("GET", "/backup") as answer:
            assert (answer.status_code, downloads._busy) == (200, True)
            await until(lambda: not downloads._busy, "the end of the download")
        assert [*served.settings.data.backups.iterdir()] == []


async def test_a_full_disk_is_reported_and_no_file_is_left_behind(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    with monkeypatch.context() as full:
        full.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=1_000_000, total=10**9))
        answer = await served.api.get("/backup")
        assert (answer.status_code, answer.json()["detail"][:26]) == (507, "There is no room for a cop")
    with monkeypatch.context() as broken:
        broken.setattr(sqlite3, "connect", fail)
        answer = await served.api.get("/backup")
        assert answer.status_code == 507
    assert (await served.api.get("/backup")).status_code == 200
    assert [*served.settings.data.backups.iterdir()] == []


def fail(*_: object, **__: object) -> None:
    raise sqlite3.OperationalError("disk I/O error")


async def test_files_left_by_a_killed_server_are_deleted_at_the_next_start(settings: Settings) -> None:
    settings.data.backups.mkdir()
    remaining = settings.data.backups / "download.db.part"
    remaining.write_bytes(b"half")
    stored = settings.data.backups / "mucat-backup-2026-01-01_00-00-00.db"
    stored.write_bytes(b"whole")

    async with serve(settings) as served:
        assert [*served.settings.data.backups.iterdir()] == [stored]
