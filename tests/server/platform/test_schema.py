import errno
import re
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import create_engine, pool
from sqlmodel import SQLModel, select

import server.platform.models  # noqa: F401 - declares the tables
from migrations import FOLDER, HEAD
from server.library.catalogue import Catalogue
from server.library.content import Recording
from server.library.listing import SessionSelection
from server.platform import schema
from server.platform.database_copies import COPIES_MOST, copy_database
from server.platform.settings import Settings, SetupError
from server.platform.sqlite_file import INCREMENTAL
from server.platform.store import Store
from tests.server.older import ROWS, fill_tables, make_session, read_tables, upgrade_to

Tables = dict[str, list[dict[str, Any]]]
OLDER = [
    revision.revision for revision in ScriptDirectory(FOLDER).walk_revisions() if revision.revision != HEAD
]


def test_the_newest_revision_is_the_server_s() -> None:
    assert ScriptDirectory(FOLDER).get_heads() == [HEAD]


def test_migrations_and_models_agree(settings: Settings) -> None:
    schema.prepare(settings.data)
    engine = create_engine(f"sqlite:///{settings.data.database}", poolclass=pool.NullPool)
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), SQLModel.metadata) == []


def test_a_new_database_is_made_once_and_without_a_copy(settings: Settings) -> None:
    schema.prepare(settings.data)
    assert schema.read_revision(settings.data.database) == HEAD
    before = settings.data.database.read_bytes()
    schema.prepare(settings.data)
    assert settings.data.database.read_bytes() == before
    assert not settings.data.backups.exists()


def test_a_new_database_is_what_the_migrations_make(settings: Settings) -> None:
    def dump() -> list[str]:
        with closing(sqlite3.connect(settings.data.database)) as database:
            # A table that was made anew has a line that says that no number was given yet.
            assert not any(database.execute("SELECT seq FROM sqlite_sequence WHERE seq != 0"))
            assert database.execute("PRAGMA auto_vacuum").fetchone() == (INCREMENTAL,)
            return sorted(line for line in database.iterdump() if "sqlite_sequence" not in line)

    schema._upgrade(settings.data.database)
    migrated = dump()
    settings.data.database.unlink()
    schema.prepare(settings.data)
    assert dump() == migrated


def test_an_older_database_is_copied_before_it_is_upgraded(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    schema.prepare(settings.data)
    older = settings.data.database.read_bytes()
    upgraded: list[bool] = []
    monkeypatch.setattr(schema, "HEAD", "9998")
    monkeypatch.setattr(schema, "_upgrade", lambda _: upgraded.append(settings.data.backups.exists()))
    schema.prepare(settings.data)
    (copy,) = settings.data.backups.iterdir()
    assert schema.read_revision(copy) == HEAD
    assert copy.stat().st_size == len(older)
    assert upgraded == [True]


def test_a_newer_database_is_refused_and_left_alone(settings: Settings) -> None:
    schema.prepare(settings.data)
    with closing(sqlite3.connect(settings.data.database)) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
        connection.commit()
    before = settings.data.database.read_bytes()
    with pytest.raises(SetupError, match=r"newer version .*9999"):
        schema.prepare(settings.data)
    assert settings.data.database.read_bytes() == before


def test_a_newer_database_is_refused_with_the_backup_that_fits(settings: Settings) -> None:
    schema.prepare(settings.data)
    settings.data.backups.mkdir(exist_ok=True)
    names = ["before-0006-2026-01-01_00-00-00", "backup-2026-01-02_00-00-00", "backup-2026-01-03_00-00-00"]
    copies = [settings.data.backups / f"mucat-{name}.db" for name in names]
    for copy in copies:
        copy_database(settings.data.database, copy)
    for database in (settings.data.database, copies[-1]):
        with closing(sqlite3.connect(database)) as connection:
            connection.execute("UPDATE alembic_version SET version_num = '9999'")
            connection.commit()
    (settings.data.backups / "mucat-backup-2026-01-04_00-00-00.db").write_bytes(b"no database" * 100)
    with pytest.raises(SetupError, match=re.escape(f"`mucat restore {copies[1]}`")):
        schema.prepare(settings.data)


@pytest.mark.parametrize("content", [b"no database at all, but long enough to look like one" * 20])
def test_a_file_that_is_no_database_is_refused(settings: Settings, content: bytes) -> None:
    settings.data.database.write_bytes(content)
    with pytest.raises(SetupError, match="cannot be used"):
        schema.prepare(settings.data)
    assert settings.data.database.read_bytes() == content


def test_a_full_disk_is_reported_in_a_sentence(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(schema, "_create", fail)
    with pytest.raises(SetupError, match=r"the disk that holds .* is full\. Free some space"):
        schema.prepare(settings.data)


def test_the_database_of_another_program_is_refused(settings: Settings) -> None:
    with closing(sqlite3.connect(settings.data.database)) as connection:
        connection.execute("CREATE TABLE theirs (id INTEGER)")
        connection.commit()
    with pytest.raises(SetupError, match="another program"):
        schema.prepare(settings.data)


@pytest.mark.parametrize("revision", OLDER)
def test_a_session_of_an_older_version_is_upgraded_found_and_read(settings: Settings, revision: str) -> None:
    upgrade_to(settings, revision)
    with closing(sqlite3.connect(settings.data.database)) as database:
        make_session(database)
    schema.prepare(settings.data)
    (copy,) = settings.data.backups.glob(f"mucat-before-{revision}-*.db")
    assert schema.read_revision(copy) == revision
    with closing(Store(settings.data.database)) as store:
        catalogue = Catalogue(store)
        (result,) = catalogue.page(SessionSelection(search="COLD")).sessions
        assert (result.name, result.origin, result.tags, result.kept, result.deleted) == (
            "old",
            "operator",
            [],
            False,
            None,
        )
        (topic,) = catalogue.detail(1).topics
        assert (topic.name, topic.count, topic.first, topic.last) == ("depth", 10, 0.0, pytest.approx(0.18))
        assert b"".join(Recording.open(store, 1).rows("depth")) == ROWS
    with closing(sqlite3.connect(settings.data.database)) as database:
        assert database.execute("PRAGMA auto_vacuum").fetchone() == (INCREMENTAL,)
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_an_upgrade_leaves_its_copy_where_others_are_dated_in_the_future(settings: Settings) -> None:
    upgrade_to(settings, "0003")
    settings.data.backups.mkdir(exist_ok=True)
    for day in range(1, 1 + COPIES_MOST):
        (settings.data.backups / f"mucat-before-0002-2931-01-0{day}_00-00-00.db").touch()
    schema.prepare(settings.data)
    (copy,) = settings.data.backups.glob("mucat-before-0003-*.db")
    assert schema.read_revision(copy) == "0003"


REMOVED = {"lab_robot"}
"""Tables that this version has no more."""


@pytest.fixture(params=OLDER)
def before(settings: Settings, request: pytest.FixtureRequest) -> Tables:
    """The rows of an older version's database, which has a row in each table, before it was upgraded."""
    upgrade_to(settings, request.param)
    with closing(sqlite3.connect(settings.data.database)) as database:
        make_session(database)
        fill_tables(database)
        rows = read_tables(database)
    schema.prepare(settings.data)
    return {table: rows[table] for table in rows.keys() - REMOVED}


def test_an_upgrade_keeps_every_value_of_every_table_and_the_models_read_them(
    settings: Settings, before: Tables
) -> None:
    with closing(sqlite3.connect(settings.data.database)) as database:
        after = read_tables(database)
        assert database.execute("PRAGMA foreign_key_check").fetchall() == []
    for table, rows in before.items():
        assert len(rows) == 1
        assert after[table] == [after[table][0] | rows[0]], table
    with closing(Store(settings.data.database)) as store, store.read() as reader:
        for model in SQLModel.__subclasses__():
            if model.__tablename__ in before:
                assert len(reader.exec(select(model)).all()) == 1


def describe(database: Path) -> list[tuple[str, ...]]:
    with closing(sqlite3.connect(database)) as connection:
        return connection.execute("SELECT type, name, sql FROM sqlite_master ORDER BY name").fetchall()


def test_an_interrupted_upgrade_changes_nothing_and_can_be_repeated(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    upgrade_to(settings, "0003")
    with closing(sqlite3.connect(settings.data.database)) as database:
        make_session(database)
    before = describe(settings.data.database)
    with monkeypatch.context() as broken:
        broken.setattr("alembic.op.create_index", lambda *_, **__: interrupt())
        with pytest.raises(KeyboardInterrupt):
            schema.prepare(settings.data)
    assert describe(settings.data.database) == before
    assert schema.read_revision(settings.data.database) == "0003"
    schema.prepare(settings.data)
    assert schema.read_revision(settings.data.database) == HEAD


def interrupt() -> None:
    raise KeyboardInterrupt


def test_reasons_of_older_cells_stand_on_lines_of_their_own(settings: Settings) -> None:
    upgrade_to(settings, "0008")
    older = "checksum: 3 packets; 5 of 9 numbers are lost; injected faults: 4 drops; framing error: 1"
    with closing(sqlite3.connect(settings.data.database)) as database:
        fill_tables(database)
        change = "UPDATE comm_test_cell SET causes = 'checksum, framing error', explanation = ?"
        database.execute(change, (older,))
        database.commit()
    schema.prepare(settings.data)
    with closing(sqlite3.connect(settings.data.database)) as database:
        (newer,) = database.execute("SELECT explanation FROM comm_test_cell").fetchone()
    assert newer.splitlines() == [
        "checksum: 3 packets; 5 of 9 numbers are lost",
        "injected faults: 4 drops",
        "framing error: 1",
    ]


def test_a_session_s_contents_are_read_from_an_index_alone(store: Store) -> None:
    with store.read() as database:
        query = "EXPLAIN QUERY PLAN SELECT topic, sum(count), min(first_time), max(last_time) FROM chunk "
        plan = database.connection().exec_driver_sql(f"{query} WHERE session_id = 1 GROUP BY topic").all()
    assert "USING COVERING INDEX chunk_time" in str(plan)


INNER = {
    "pulled_session",
    "run_figures",
    "sweep_run",
    "session_figures",
    "chunk",
    "gap",
    "session_tag",
    "session_summary",
    "comm_test_cell",
    "alembic_version",
}
"""Tables whose numbers nobody outside the database knows."""


def test_no_table_gives_a_number_twice(settings: Settings) -> None:
    schema.prepare(settings.data)
    with closing(sqlite3.connect(settings.data.database)) as database:
        made = database.execute(
            "SELECT name, sql FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'"
        ).fetchall()
    assert {name for name, text in made if "AUTOINCREMENT" not in text} == INNER


def test_the_number_of_a_removed_session_is_not_given_again_after_an_upgrade(
    settings: Settings, before: Tables
) -> None:
    with closing(sqlite3.connect(settings.data.database)) as database:
        assert database.execute("PRAGMA foreign_key_check").fetchall() == []
        (session,) = read_tables(database)["session"]
        assert session.items() >= before["session"][0].items()
        tables = set(before) - INNER
        for table in before:
            database.execute(f"DELETE FROM {table}")
        fill_tables(database, skip=("id",))
        assert {table: read_tables(database)[table][0]["id"] for table in tables} == dict.fromkeys(tables, 2)
