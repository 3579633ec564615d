import asyncio
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest
from sqlalchemy import insert, text
from sqlmodel import select

from server.platform.models import Gap, SessionRow
from server.platform.schema import prepare
from server.platform.settings import Settings
from server.platform.store import Store, StoreError

SESSION = {
    "id": 1,
    "name": "n",
    "note": "",
    "state": "recording",
    "robot": "r",
    "version": "v",
    "definitions": "d",
    "started": 0.0,
    "started_steady": 0.0,
    "duration": 0.0,
    "samples": 0,
    "bytes": 0,
    "configuration": "",
    "robot_state": "null",
    "topics": "{}",
}


def test_written_rows_are_read_by_another_connection(store: Store) -> None:
    asyncio.run(store.write(lambda connection: connection.execute(insert(SessionRow).values(**SESSION))))
    with store.read() as database:
        assert [row.name for row in database.exec(select(SessionRow))] == ["n"]


def test_writing_is_durable_and_reading_cannot_write(store: Store) -> None:
    settings = asyncio.run(
        store.write(
            lambda connection: [
                connection.exec_driver_sql(f"PRAGMA {name}").scalar()
                for name in ("journal_mode", "synchronous", "foreign_keys")
            ]
        )
    )
    full = 2
    assert settings == ["wal", full, 1]
    with pytest.raises(StoreError), store.read() as database:
        database.execute(text("DELETE FROM session"))


def test_a_failed_change_is_rolled_back_and_reported(store: Store) -> None:
    def change(connection: object) -> None:
        connection.execute(insert(SessionRow).values(**SESSION))  # type: ignore[attr-defined]
        gap = {"session_id": 99, "topic": "t", "kind": "missed", "time": 0.0, "missed": 1}
        connection.execute(insert(Gap).values(**gap))  # type: ignore[attr-defined]

    with pytest.raises(StoreError, match="FOREIGN KEY"):
        asyncio.run(store.write(change))
    assert store.failing is not None
    with store.read() as database:
        assert database.exec(select(SessionRow)).first() is None
    asyncio.run(store.probe())
    assert store.failing is None


async def test_a_full_disk_is_reported_and_writing_works_again_with_free_space(settings: Settings) -> None:
    prepare(settings.data)
    store = Store(settings.data.database)

    def limit(pages: int) -> None:
        store_limit = f"PRAGMA max_page_count = {pages}"
        store._thread.submit(lambda: store._connection.exec_driver_sql(store_limit).scalar()).result()
        store._thread.submit(store._connection.rollback).result()

    large = SESSION | {"note": "x" * 500_000}
    limit(1)
    with pytest.raises(StoreError, match="disk is full"):
        await store.write(lambda connection: connection.execute(insert(SessionRow).values(**large)))
    limit(100_000)
    await store.write(lambda connection: connection.execute(insert(SessionRow).values(**large)))
    assert store.failing is None
    store.close()


def test_committed_changes_survive_a_kill(settings: Settings, tmp_path: Path) -> None:
    prepare(settings.data)
    program = tmp_path / "killed.py"
    program.write_text(
        "import asyncio, os, signal, sys\n"
        "from pathlib import Path\n"
        "from sqlalchemy import insert\n"
        "from server.platform.models import SessionRow\n"
        "from server.platform.store import Store\n"
        "store = Store(Path(sys.argv[1]))\n"
        f"row = {SESSION!r}\n"
        "asyncio.run(store.write(lambda c: c.execute(insert(SessionRow).values(**row))))\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n",
        encoding="utf-8",
    )
    subprocess.run(
        [sys.executable, program, settings.data.database], cwd=Path(__file__).parents[3], check=False
    )
    with sqlite3.connect(settings.data.database) as connection:
        assert connection.execute("SELECT count(*) FROM session").fetchone() == (1,)
    connection.close()
