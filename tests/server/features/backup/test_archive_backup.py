"""Backup and restore of a lab: of an archive in PostgreSQL as of one in a file, and from one to the other."""

import asyncio
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import create_engine, delete, insert, pool, select
from sqlmodel import SQLModel, col

from server.cli import main
from server.library.listing import Listing
from server.platform.models import LayoutRow
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.sqlite import connect_to
from server.platform.store import Reader, Store
from tests.server.blocks import depth_block, film_block
from tests.server.features.exports.recordings import record
from tests.server.features.lab.labs import serve_lab
from tests.server.postgres import new_archive, postgres

LAYOUT = {"saved": 1.5, "document": "{}", "author": "", "version": 1}


class LabFolder:
    """A lab's data folder and configuration; `archive` is empty for a file."""

    def __init__(self, path: Path, archive: str) -> None:
        self.data = DataFolder(path)
        make_folders(self.data)
        self.config = self.data.config
        self.config.write_text(f'[robot]\nname = "tested"\n[lab]\ndatabase = "{archive}"\n')
        self.archive = archive

    def fill(self, settings: Settings, *names: str) -> None:
        """Record sessions with a film, and save a layout of the first one's name."""
        self.data.lab.write_text(self.archive)
        prepare(self.data)
        with closing(Store(self.data.database_location)) as store:
            for name in names:
                record(
                    store,
                    settings,
                    [depth_block(0, 100)],
                    [film_block(0, 101.0, bytes(range(256)))],
                    name=name,
                )
            asyncio.run(note_layout(store, names[0]))

    def run(self, *arguments: str) -> int:
        """Run `mucat`; return its status."""
        return main([*arguments, "--data", str(self.data.path), "--config", str(self.config)])

    def names(self) -> dict[int, str]:
        """Return the sessions' names, by their numbers."""
        with closing(Reader(self.data.database_location)) as reader:
            return {session.id: session.name for session in Listing(reader).page().sessions}

    def rows(self) -> dict[str, list[tuple[object, ...]]]:
        """Return all rows of all tables."""
        location = self.data.database_location
        engine = (
            create_engine(location, poolclass=pool.NullPool)
            if isinstance(location, str)
            else connect_to(location, "mode=ro", pool.NullPool)
        )
        with engine.connect() as connection:
            return {
                table.name: sorted(map(tuple, connection.execute(select(table))), key=repr)
                for table in SQLModel.metadata.sorted_tables
            }


def lab(folder: Path, database: str) -> LabFolder:
    return LabFolder(folder, new_archive() if database == "postgresql" else "")


async def note_layout(store: Store, name: str) -> None:
    """Save a layout, and add and remove another: its number is not given again."""
    await store.execute(insert(LayoutRow), [{**LAYOUT, "name": name}, {**LAYOUT, "name": "gone"}])
    await store.execute(delete(LayoutRow).where(col(LayoutRow.name) == "gone"))


@pytest.mark.parametrize("target", ["sqlite", "postgresql"])
@pytest.mark.parametrize("source", ["sqlite", "postgresql"])
def test_a_lab_is_whole_again_on_either_database(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str], source: str, target: str
) -> None:
    before, after, copy = (
        lab(tmp_path / "before", source),
        lab(tmp_path / "after", target),
        tmp_path / "copy.db",
    )
    before.fill(settings, "one", "two")
    assert before.run("backup", str(copy)) == 0
    assert "2 sessions, SHA-256" in capsys.readouterr().out
    config = after.config.read_text()
    assert after.run("restore", str(copy)) == 0
    output = capsys.readouterr().out
    assert f"{after.archive or after.data.database} was restored" in output
    assert f"The lab goes on with {after.config}" in output
    assert after.config.read_text() == config
    assert after.rows() == before.rows()
    after.fill(settings, "three")
    assert after.names() == {1: "one", 2: "two", 3: "three"}
    assert [row[:2] for row in after.rows()["layout"]] == [(1, "one"), (3, "three")]


def test_an_archive_with_sessions_is_not_overwritten_and_nothing_changes(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, copy = lab(tmp_path / "before", "postgresql"), tmp_path / "copy.db"
    before.fill(settings, "one", "two")
    assert before.run("backup", str(copy)) == 0
    before.fill(settings, "three")
    rows = before.rows()
    assert before.run("restore", str(copy)) == 1
    assert "has sessions (3)" in capsys.readouterr().err
    assert before.rows() == rows


def test_an_archive_that_a_lab_writes_is_not_restored(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, after, copy = (
        lab(tmp_path / "before", "sqlite"),
        lab(tmp_path / "after", "postgresql"),
        tmp_path / "copy.db",
    )
    before.fill(settings, "one")
    assert before.run("backup", str(copy)) == 0
    with closing(Store(after.archive)):
        assert after.run("restore", str(copy)) == 1
    assert "A lab writes the archive" in capsys.readouterr().err
    assert after.run("restore", str(copy)) == 0


def test_a_backup_that_postgresql_does_not_take_leaves_the_archive_empty(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, after, copy = (
        lab(tmp_path / "before", "sqlite"),
        lab(tmp_path / "after", "postgresql"),
        tmp_path / "copy.db",
    )
    before.fill(settings, "one")
    assert before.run("backup", str(copy)) == 0
    copy.with_name("copy.db.sha256").unlink()
    with closing(sqlite3.connect(copy)) as database:
        database.execute("UPDATE session SET note = 'a' || char(0) || 'b'")
        database.execute("UPDATE alembic_version SET version_num = version_num")
        database.commit()
    assert after.run("restore", str(copy)) == 1
    assert "Nothing was restored into the archive" in capsys.readouterr().err
    with closing(Store(after.archive)) as store:
        assert Listing(store).page().sessions == []


def test_an_archive_that_is_away_or_of_another_version_is_named(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, copy = lab(tmp_path / "before", "postgresql"), tmp_path / "copy.db"
    before.fill(settings, "one")
    engine = create_engine(before.archive, poolclass=pool.NullPool)
    with engine.begin() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    assert before.run("backup", str(copy)) == 1
    assert "of another version (its revision is 9999" in capsys.readouterr().err
    before.data.lab.write_text(postgres().url("absent"))
    assert before.run("backup", str(copy)) == 1
    assert "cannot be read: PostgreSQL does not answer" in capsys.readouterr().err
    assert not [*tmp_path.glob("copy*")]


def test_a_lab_is_put_back_on_a_new_computer_with_its_configuration(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    before, copy = lab(tmp_path / "before", "sqlite"), tmp_path / "copy.db"
    before.fill(settings, "one")
    assert before.run("backup", str(copy)) == 0
    fresh = DataFolder(tmp_path / "fresh")
    # Away from the repository's robot.toml.
    monkeypatch.chdir(tmp_path)
    assert main(["restore", str(copy), "--data", str(fresh.path)]) == 0
    assert (fresh.lab.read_text(), fresh.config.read_text()) == ("", before.config.read_text())
    capsys.readouterr()


def test_a_robot_s_backup_goes_into_no_lab_and_a_lab_s_into_no_robot(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, copy = lab(tmp_path / "before", "sqlite"), tmp_path / "copy.db"
    before.fill(settings, "one")
    assert before.run("backup", str(copy)) == 0
    prepare(settings.data)
    robot = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert main(["restore", str(copy), *robot]) == 1
    assert "the backup of a lab" in capsys.readouterr().err
    copy.unlink()
    copy.with_name("copy.db.sha256").unlink()
    assert main(["backup", str(copy), *robot]) == 0
    assert before.run("restore", str(copy)) == 1
    assert "the backup of a robot" in capsys.readouterr().err
    assert before.names() == {1: "one"}


@pytest.mark.parametrize("database", ["sqlite", "postgresql"])
async def test_the_page_s_backup_is_the_same(settings: Settings, tmp_path: Path, database: str) -> None:
    copy = tmp_path / "copy.db"
    async with serve_lab(settings, new_archive() if database == "postgresql" else "") as served:
        await note_layout(served.get(Store), "turtle")
        answer = await served.api.get("/backup")
        assert answer.status_code == 200
        copy.write_bytes(answer.content)
    with closing(sqlite3.connect(copy)) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        assert connection.execute("SELECT name, document FROM layout").fetchall() == [("turtle", "{}")]
        assert connection.execute("SELECT count(*) FROM backup_file WHERE name = 'lab'").fetchone() == (1,)
