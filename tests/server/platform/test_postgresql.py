"""An archive in PostgreSQL: its schema, its one writer, and what happens where the server is away."""

from contextlib import closing

import pytest
from sqlalchemy import create_engine, func, insert, pool, text
from sqlmodel import select

from migrations import HEAD
from server.platform.models import SessionRow
from server.platform.postgresql_schema import prepare_archive
from server.platform.searching import fold
from server.platform.settings import SetupError
from server.platform.store import Reader, Store, StoreError
from tests.server.platform.test_store import SESSION
from tests.server.postgres import new_archive, postgres


def execute(url: str, *statements: str) -> None:
    """Execute statements beside the archive's own connections."""
    engine = create_engine(url, poolclass=pool.NullPool)
    with engine.begin() as connection:
        for statement in statements:
            connection.exec_driver_sql(statement)


def count(store: Reader) -> int:
    with store.read() as database:
        return int(database.exec(select(func.count()).select_from(SessionRow)).one())


async def add(store: Store, **values: object) -> None:
    row = {name: value for name, value in SESSION.items() if name != "id"} | values
    await store.write(lambda connection: connection.execute(insert(SessionRow).values(**row)))


async def test_one_lab_writes_and_others_read() -> None:
    url = new_archive()
    with closing(Store(url)) as store:
        with pytest.raises(StoreError, match="another lab"):
            Store(url)
        await add(store, identifier="a", seed=2**61, bytes=2**40)
        with closing(Reader(url)) as reader:
            assert count(reader) == 1
            with pytest.raises(StoreError, match="read-only"), reader.read() as database:
                database.execute(text("DELETE FROM session"))
        assert store.measure().size > 1_000_000
    Store(url).close()


async def test_it_goes_on_where_postgresql_was_stopped_and_started() -> None:
    server, url = postgres(), new_archive()
    with closing(Store(url)) as store:
        await add(store, identifier="a")
        assert count(store) == 1
        server.stop()
        try:
            with pytest.raises(StoreError, match="PostgreSQL does not answer"):
                await add(store, identifier="b")
            assert (store.failing or "").startswith("PostgreSQL does not answer")
            with pytest.raises(StoreError, match="PostgreSQL does not answer"):
                count(store)
        finally:
            server.start()
        await add(store, identifier="c")
        assert (count(store), store.failing) == (2, None)
        with pytest.raises(StoreError, match="another lab"):
            Store(url)


async def test_a_failed_change_leaves_nothing_and_the_next_one_works() -> None:
    with closing(Store(new_archive())) as store:
        await add(store, identifier="a")
        with pytest.raises(StoreError, match="refuses"):
            await add(store, identifier="a")
        await store.probe()
        assert (count(store), store.failing) == (1, None)


def test_a_newer_a_foreign_and_an_absent_archive_are_refused_in_words() -> None:
    url = new_archive()
    prepare_archive(url)
    execute(url, "UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(SetupError, match=rf"newer version .*9999.*{HEAD}"):
        prepare_archive(url)
    execute(url, "DROP TABLE alembic_version")
    with pytest.raises(SetupError, match="another program"):
        prepare_archive(url)
    with pytest.raises(SetupError, match=r"cannot be used.*docs/run/lab\.md"):
        prepare_archive(postgres().url("absent"))


def test_texts_are_compared_as_in_sqlite() -> None:
    texts = ["Öö ﬁ ß", "Σίσυφος", "Ångström", "ÇA VA", "Ⅷ", "straße STRASSE", "İstanbul"]
    engine = create_engine(new_archive(), poolclass=pool.NullPool)
    with engine.connect() as connection:
        for name in texts:
            folded = connection.execute(text("SELECT fold(:name)"), {"name": name}).scalar_one()
            assert folded == fold(name), name
