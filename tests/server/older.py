"""Databases as older versions left them."""

import json
import sqlite3
from collections.abc import Collection
from typing import Any

from alembic import command
from sqlalchemy import create_engine, pool

from migrations import make_config
from robot_runtime.contract.chunks import describe_topics, encode_rows
from robot_runtime.contract.topics import BY_NAME
from server.platform.settings import Settings
from tests.server.blocks import depth_block

ROWS = depth_block(0, 10).payload
SOMETHING: dict[str, Any] = {"INTEGER": 1, "BOOLEAN": True, "FLOAT": 1.5, "VARCHAR": "µ", "BLOB": b"\x00\xff"}
"""For a column of each type; the 1 also leads to the first row of any other table."""


def upgrade_to(settings: Settings, revision: str) -> None:
    """Make the database, with the tables of this revision."""
    engine = create_engine(f"sqlite:///{settings.data.database}", poolclass=pool.NullPool)
    config = make_config()
    with engine.connect() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
        connection.commit()


def make_session(database: sqlite3.Connection) -> None:
    """Store session 1 as version 0.0.9 did, complete, with ROWS of depth; committed."""
    data, first, last = encode_rows([ROWS], BY_NAME["depth"].row_bytes)
    topics = {name: topic for name, topic in describe_topics().items() if name != "thumbnail"}
    session = (1, "old", "cold", "complete", "turtle", "0.0.9", "00c0ffee", 1e9, 100.0, 1e9 + 1, 1.0, 10)
    database.execute(
        "INSERT INTO session (id, name, note, state, robot, version, definitions, started, "
        "started_steady, ended, duration, samples, bytes, configuration, robot_state, topics) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 100, '', 'null', ?)",
        (*session, json.dumps(topics)),
    )
    database.execute(
        "INSERT INTO chunk (session_id, topic, number, first_time, last_time, first, count, encoding, "
        "data) VALUES (1, 'depth', 0, ?, ?, 0, 10, 'shuffle-zlib', ?)",
        (first, last, data),
    )
    database.commit()


def fill_tables(database: sqlite3.Connection, skip: Collection[str] = ()) -> None:
    """Add a row to every empty table, with a value in each of its columns but `skip`; committed."""
    for table, rows in read_tables(database).items():
        if not rows:
            described = database.execute(f"PRAGMA table_info({table})")
            columns = [(name, kind) for _, name, kind, *_ in described if name not in skip]
            names, marks = ", ".join(name for name, _ in columns), ", ".join("?" * len(columns))
            values = [SOMETHING[kind] for _, kind in columns]
            database.execute(f"INSERT INTO {table} ({names}) VALUES ({marks})", values)
    database.commit()


def read_tables(database: sqlite3.Connection) -> dict[str, list[dict[str, Any]]]:
    """Return the rows of each table, without Alembic's own."""
    tables = database.execute(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' "
        "AND name != 'alembic_version'"
    ).fetchall()
    database.row_factory = sqlite3.Row
    rows = {name: [dict(row) for row in database.execute(f"SELECT * FROM {name}")] for (name,) in tables}
    database.row_factory = None
    return rows
