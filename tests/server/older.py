"""Databases as older versions left them."""

import json
import sqlite3

from alembic import command
from alembic.config import Config
from sqlalchemy import create_engine, pool

from robot_runtime.topics import BY_NAME
from server import schema
from server.sessions.chunks import describe_topics, encode_rows
from server.settings import Settings
from tests.server.blocks import depth_block

ROWS = depth_block(0, 10).payload


def upgrade_to(settings: Settings, revision: str) -> None:
    """Make the database, with the tables of this revision."""
    engine = create_engine(f"sqlite:///{settings.data.database}", poolclass=pool.NullPool)
    config = Config()
    config.set_main_option("script_location", str(schema._scripts()))
    config.set_main_option("path_separator", "os")
    with engine.connect() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
        connection.commit()


def make_session(database: sqlite3.Connection) -> None:
    """Store session 1 as 0.0.9 did, complete, with ROWS of depth; committed."""
    data, first, last = encode_rows([ROWS], BY_NAME["depth"].row_bytes)
    topics = {name: one for name, one in describe_topics().items() if name != "thumbnail"}
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
