import sqlite3
from contextlib import closing

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import create_engine, pool
from sqlmodel import SQLModel

import server.models  # noqa: F401 - declares the tables
from migrations import HEAD
from server import schema
from server.sessions.catalogue import Catalogue
from server.sessions.recording import Recording
from server.settings import Settings, SetupError
from server.store import Store
from tests.server.older import ROWS, make_session, upgrade_to


def test_the_newest_revision_is_the_one_the_server_wants() -> None:
    assert ScriptDirectory(schema._scripts()).get_heads() == [HEAD]


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


@pytest.mark.parametrize("content", [b"no database at all, but long enough to look like one" * 20])
def test_what_is_no_database_is_refused(settings: Settings, content: bytes) -> None:
    settings.data.database.write_bytes(content)
    with pytest.raises(SetupError, match="cannot be used"):
        schema.prepare(settings.data)
    assert settings.data.database.read_bytes() == content


def test_the_database_of_another_program_is_refused(settings: Settings) -> None:
    with closing(sqlite3.connect(settings.data.database)) as connection:
        connection.execute("CREATE TABLE theirs (id INTEGER)")
        connection.commit()
    with pytest.raises(SetupError, match="another program"):
        schema.prepare(settings.data)


def test_a_session_of_an_older_version_is_upgraded_found_and_read(settings: Settings) -> None:
    upgrade_to(settings, "0003")
    with closing(sqlite3.connect(settings.data.database)) as database:
        make_session(database)
    schema.prepare(settings.data)
    with closing(Store(settings.data.database)) as store:
        catalogue = Catalogue(store)
        (found,) = catalogue.list("COLD")
        assert (found.name, found.origin, found.tags, found.kept, found.deleted) == (
            "old",
            "operator",
            [],
            False,
            None,
        )
        (topic,) = catalogue.detail(1).topics
        assert (topic.name, topic.count, topic.first, topic.last) == ("depth", 10, 0.0, pytest.approx(0.18))
        assert b"".join(Recording(store, catalogue.row(1)).rows("depth")) == ROWS
    with closing(sqlite3.connect(settings.data.database)) as database:
        assert database.execute("PRAGMA auto_vacuum").fetchone() == (schema.INCREMENTAL,)
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
