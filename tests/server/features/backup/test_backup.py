"""Backup of a database in use, and its restore."""

import asyncio
import fcntl
import hashlib
import os
import re
import sqlite3
import stat
import threading
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from migrations import HEAD
from server.cli import main
from server.features.backup import command as backup_command
from server.library.listing import Listing
from server.platform import database_copies
from server.platform.schema import prepare, read_revision
from server.platform.settings import DataFolder, Settings
from server.platform.store import Reader, Store
from server.platform.user_files import NAMES
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import record
from tests.server.new_database import new_store
from tests.server.older import ROWS, make_session, upgrade_to
from tests.stack import ROOT


def run(settings: Settings, *arguments: str) -> int:
    return main([*arguments, "--data", str(settings.data.path), "--config", str(settings.config)])


def fill(settings: Settings, *names: str) -> None:
    with new_store(settings.data) as store:
        for name in names:
            record(store, settings, [depth_block(0, 100)], name=name)


def names(database: Path) -> list[str]:
    with closing(Reader(database)) as reader:
        return [session.name for session in Listing(reader).page().sessions]


def test_a_backup_is_complete_private_and_has_a_checksum(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one", "two")
    path = tmp_path / "copy.db"
    assert run(settings, "backup", str(path)) == 0
    checksum = hashlib.sha256(path.read_bytes()).hexdigest()
    assert f"2 sessions, SHA-256 {checksum}" in capsys.readouterr().out
    assert path.with_name("copy.db.sha256").read_text() == f"{checksum}  copy.db\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert sorted(file.name for file in tmp_path.iterdir()) == ["copy.db", "copy.db.sha256"]
    assert names(path) == ["two", "one"]
    assert run(settings, "backup", str(path)) == 1
    assert "exists already" in capsys.readouterr().err


def test_a_backup_of_a_database_in_use_is_consistent(settings: Settings, tmp_path: Path) -> None:
    with new_store(settings.data) as store:
        record(store, settings, [depth_block(0, 100)], name="0")
        ended = threading.Event()

        def write() -> None:
            for number in range(1, 1000):
                if ended.is_set():
                    break
                record(store, settings, [depth_block(0, 100)], name=str(number))

        writing = threading.Thread(target=write)
        writing.start()
        try:
            for number in range(5):
                path = tmp_path / f"{number}.db"
                database_copies.copy_database(settings.data.database, path)
                with closing(sqlite3.connect(path)) as copy:
                    rows = copy.execute(
                        "SELECT session.samples, coalesce(sum(count), 0) FROM session "
                        "LEFT JOIN chunk ON session_id = session.id GROUP BY session.id"
                    ).fetchall()
                assert rows
                assert all(answer == stored for answer, stored in rows)
        finally:
            ended.set()
            writing.join()


def test_a_restore_brings_back_the_backup_and_sets_the_present_database_aside(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    path = tmp_path / "copy.db"
    assert run(settings, "backup", str(path)) == 0
    fill(settings, "two")
    assert run(settings, "restore", str(path)) == 0
    (aside,) = settings.data.backups.glob("mucat-replaced-*.db")
    assert str(aside) in capsys.readouterr().out
    assert names(settings.data.database) == ["one"]
    assert names(aside) == ["two", "one"]
    fill(settings, "three")
    assert names(settings.data.database) == ["three", "one"]


def test_a_restore_replaces_a_damaged_database_and_its_journal_files(
    settings: Settings, tmp_path: Path
) -> None:
    fill(settings, "one")
    path = tmp_path / "copy.db"
    assert run(settings, "backup", str(path)) == 0
    settings.data.database.write_bytes(b"not a database any more" * 100)
    log = settings.data.database.with_name("mucat.db-wal")
    log.write_bytes(b"its log")
    assert run(settings, "restore", str(path)) == 0
    assert not log.exists()
    assert names(settings.data.database) == ["one"]
    (stored,) = settings.data.backups.glob("mucat-replaced-*.db-wal")
    assert stored.read_bytes() == b"its log"


def test_a_backup_of_an_older_version_is_restored_and_then_upgraded(
    settings: Settings, tmp_path: Path
) -> None:
    upgrade_to(settings, "0003")
    with closing(sqlite3.connect(settings.data.database)) as database:
        make_session(database)
    path = tmp_path / "old.db"
    assert run(settings, "backup", str(path)) == 0
    assert read_revision(path) == "0003"
    fill(settings, "new")
    assert run(settings, "restore", str(path)) == 0
    prepare(settings.data)
    assert read_revision(settings.data.database) == HEAD
    assert names(settings.data.database) == ["old"]
    assert ROWS


OWN = {
    "missions/class_one/1.toml": "first",
    "missions/class_one/2.toml": "second",
    "missions/class_one/authors.json": "{}",
    "scenarios/mine.toml": "mine",
    "panels/own.js": "panel",
    "craft.toml": "title = 'Heavy'\n[craft]\nmass = 3.1\n",
    "vision.json": "{}",
}


def write_own(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def read_own(folder: Path) -> dict[str, str]:
    paths = [path for name in (*NAMES, "tls") for path in (folder / name, *(folder / name).rglob("*"))]
    return {str(path.relative_to(folder)): path.read_text() for path in paths if path.is_file()}


def test_a_backup_gives_everything_that_people_have_made_back(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    write_own(settings.data.path, {**OWN, "tls/key.pem": "PRIVATE KEY"})
    path = tmp_path / "copy.db"
    assert run(settings, "backup", str(path)) == 0
    assert "Not in it: exported files, the audit log, and what is secret" in capsys.readouterr().out
    assert b"PRIVATE KEY" not in path.read_bytes()

    fresh = DataFolder(tmp_path / "fresh")
    assert main(["restore", str(path), "--data", str(fresh.path), "--config", str(settings.config)]) == 0
    assert f"{len(OWN) + 1} other files" in capsys.readouterr().out
    assert read_own(fresh.path) == {**OWN, "robot.toml": settings.config.read_text()}
    assert names(fresh.database) == ["one"]
    assert not (fresh.path / "restored").exists()


def test_a_restore_puts_files_aside_and_one_of_an_older_backup_leaves_them(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = iter(f"2026-01-0{day}_00-00-00" for day in range(1, 9))
    monkeypatch.setattr(time, "strftime", lambda *_: next(moments))
    fill(settings, "one")
    older, newer = tmp_path / "older.db", tmp_path / "newer.db"
    database_copies.copy_database(settings.data.database, older)
    write_own(settings.data.path, OWN)
    assert run(settings, "backup", str(newer)) == 0
    changed = {"missions/class_two/1.toml": "another", "craft.toml": "title = 'Light'\n[craft]\nmass = 2.5\n"}
    write_own(settings.data.path, changed)
    before = read_own(settings.data.path)
    assert run(settings, "restore", str(older)) == 0
    assert read_own(settings.data.path) == before
    assert run(settings, "restore", str(newer)) == 0
    assert read_own(settings.data.path).items() >= OWN.items()
    assert "missions/class_two/1.toml" not in read_own(settings.data.path)
    (aside,) = settings.data.backups.glob("*.files")
    assert read_own(aside) == before


def test_a_backup_with_a_file_that_leads_elsewhere_is_refused(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    path = tmp_path / "copy.db"
    for name in ("../evil", "missions/../../evil", "/etc/evil", "tls/key.pem", ""):
        path.unlink(missing_ok=True)
        database_copies.copy_database(
            settings.data.database,
            path,
            lambda copy, name=name: (  # type: ignore[misc]
                copy.execute("CREATE TABLE backup_file (name, content)"),
                copy.execute("INSERT INTO backup_file VALUES (?, 'x')", (name,)),
                copy.commit(),
            ),
        )
        assert run(settings, "restore", str(path)) == 1
        assert "none of a data folder" in capsys.readouterr().err
    assert not list(tmp_path.rglob("evil"))
    assert not (settings.data.path / "restored.db").exists()
    assert names(settings.data.database) == ["one"]


@pytest.mark.parametrize("revision", ["0003", HEAD])
def test_no_number_returns_with_a_backup(settings: Settings, tmp_path: Path, revision: str) -> None:
    path = tmp_path / "copy.db"
    if revision == HEAD:
        fill(settings, "one")
        assert run(settings, "backup", str(path)) == 0
    else:
        upgrade_to(settings, revision)
        assert run(settings, "backup", str(path)) == 0
    fill(settings, "two", "three")
    with closing(Reader(settings.data.database)) as reader:
        last = max(session.id for session in Listing(reader).page().sessions)
    assert run(settings, "restore", str(path)) == 0
    fill(settings, "four")
    with closing(Reader(settings.data.database)) as reader:
        (newest, *_) = Listing(reader).page().sessions
    assert (newest.name, newest.id) == ("four", last + 1)


def test_the_next_copy_removes_what_killed_ones_have_left(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    remaining = [
        tmp_path / "old.db.part",
        tmp_path / "old.db.part-journal",
        tmp_path / "lone.db.part-journal",
    ]
    for path in remaining:
        path.write_bytes(b"half")
    copied = tmp_path / "copied.db.part"
    with copied.open("wb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert run(settings, "backup", str(tmp_path / "copy.db")) == 0
        assert sorted(path.name for path in tmp_path.iterdir()) == [
            "copied.db.part",
            "copy.db",
            "copy.db.sha256",
        ]
        assert run(settings, "backup", str(tmp_path / "copied.db")) == 1
        assert "another backup is writing" in capsys.readouterr().err
    assert copied.exists()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        ("missing", "There is no file"),
        ("changed", "checksum"),
        ("no database", "file is not a database"),
        ("newer", "newer version"),
        ("damaged", "damaged|malformed"),
    ],
)
def test_a_failed_restore_changes_nothing(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str], spoil: str, message: str
) -> None:
    fill(settings, "one")
    path = tmp_path / "copy.db"
    assert run(settings, "backup", str(path)) == 0
    if spoil not in ("missing", "changed"):
        path.with_name("copy.db.sha256").unlink()
    SPOILS[spoil](path)
    before = settings.data.database.read_bytes()
    assert run(settings, "restore", str(path)) == 1
    assert re.search(message, capsys.readouterr().err)
    assert settings.data.database.read_bytes() == before
    assert not settings.data.backups.exists()


def rewrite(path: Path, revision: str) -> None:
    with closing(sqlite3.connect(path)) as database:
        database.execute("UPDATE alembic_version SET version_num = ?", (revision,))
        database.commit()


def damage(path: Path) -> None:
    content = bytearray(path.read_bytes())
    for page in range(3, len(content) // 4096):
        content[page * 4096 : page * 4096 + 200] = os.urandom(200)
    path.write_bytes(content)


def change(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1] + b"x")


def overwrite(path: Path) -> None:
    path.write_bytes(b"no database" * 1000)


SPOILS: dict[str, Callable[[Path], None]] = {
    "missing": Path.unlink,
    "changed": change,
    "no database": overwrite,
    "newer": lambda path: rewrite(path, "9999"),
    "damaged": damage,
}


def test_a_restore_beside_a_running_server_is_refused(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    path = tmp_path / "copy.db"
    assert run(settings, "backup", str(path)) == 0
    with settings.data.lock.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert run(settings, "restore", str(path)) == 1
    assert "Another server works on" in capsys.readouterr().err


def test_only_the_newest_backups_stay(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(settings, "one")
    moments = iter(f"2026-01-0{day}_00-00-00" for day in range(1, 9))
    monkeypatch.setattr(time, "strftime", lambda *_: next(moments))
    for _ in range(database_copies.COPIES_MOST + 2):
        backup_command.back_up(settings.data, settings.config, None)
    stored = sorted(path.name for path in settings.data.backups.glob("*.db"))
    assert stored == [f"mucat-backup-2026-01-0{day}_00-00-00.db" for day in range(3, 8)]
    assert len(list(settings.data.backups.iterdir())) == 2 * database_copies.COPIES_MOST


def test_copies_dated_in_the_future_do_not_cost_the_one_just_made(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    settings.data.backups.mkdir(exist_ok=True)
    for kind in ("backup", "replaced"):
        for day in range(1, 1 + database_copies.COPIES_MOST):
            (settings.data.backups / f"mucat-{kind}-2931-01-0{day}_00-00-00.db").touch()
    assert run(settings, "backup") == 0
    made = Path(capsys.readouterr().out.partition(": ")[0])
    assert names(made) == ["one"]
    assert run(settings, "restore", str(made)) == 0
    (replaced,) = re.findall(r"What was there before is now (\S+\.db)", capsys.readouterr().out)
    assert names(Path(replaced)) == ["one"]
    for kind in ("backup", "replaced"):
        copies = sorted(settings.data.backups.glob(f"mucat-{kind}-*.db"))
        assert len(copies) == database_copies.COPIES_MOST
        assert not copies[0].name.startswith(f"mucat-{kind}-2931")


def test_older_copies_that_cannot_be_deleted_are_a_remark_beside_what_was_done(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(settings, "one")
    for kind in ("backup", "replaced"):
        for day in range(1, 1 + database_copies.COPIES_MOST):
            (settings.data.backups / f"mucat-{kind}-2026-01-0{day}_00-00-00.db").mkdir(parents=True)
    assert run(settings, "backup") == 0
    output = capsys.readouterr().out
    assert "Older copies cannot be deleted: Is a directory" in output
    assert run(settings, "restore", output.partition(": ")[0]) == 0
    output = capsys.readouterr().out
    assert "was restored from" in output
    assert "Older copies cannot be deleted" in output


def test_a_second_writer_is_refused(settings: Settings) -> None:
    with new_store(settings.data) as store:
        with pytest.raises(Exception, match="another program writes"):
            Store(settings.data.database)
        asyncio.run(store.probe())
    Store(settings.data.database).close()


def test_the_documented_commands_do_what_they_say(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fill(settings, "one")
    text = (ROOT / "docs/run/backup.md").read_text(encoding="utf-8")
    commands = re.findall(r"^\.venv/bin/mucat (.*)$", text, re.MULTILINE)
    assert len(commands) == 3
    monkeypatch.chdir(tmp_path)
    assert [run(settings, *command.split()) for command in commands] == [0, 0, 0]
    assert names(settings.data.database) == ["one"]
