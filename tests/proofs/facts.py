"""The contents of a database as named facts, to compare with the acknowledged ones."""

import sqlite3
import zlib
from contextlib import closing
from pathlib import Path
from typing import Any, Literal

FACTS = {
    "samples": "SELECT id, samples FROM session",
    "name": "SELECT id, name FROM session",
    "state": "SELECT id, state FROM session",
    "chunk": "SELECT session_id || '/' || topic || '/' || number, data FROM chunk",
    "gap": "SELECT session_id || '/' || id, missed FROM gap",
    "marker": "SELECT session_id || '/' || id, text FROM marker",
    "tag": "SELECT session_id || '/' || tag, 1 FROM session_tag",
    "run": "SELECT id, state FROM comm_test_run",
    "cell": "SELECT run_id || '/' || number, right FROM comm_test_cell",
}


class DamagedDataError(Exception):
    """The database is damaged, according to SQLite."""


def read_facts(database: Path, mode: Literal["ro", "rw"]) -> dict[str, Any]:
    """Return every fact by its name; rows of samples as checksums. Raise DamagedDataError.

    After a cut SQLite must be able to write ("rw"), since it rolls back what was not finished.
    """
    results: dict[str, Any] = {}
    try:
        with closing(sqlite3.connect(f"{database.as_uri()}?mode={mode}", uri=True)) as connection:
            (health,) = connection.execute("PRAGMA integrity_check").fetchone()
            if health != "ok":
                raise DamagedDataError(health)
            tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
            for kind, query in FACTS.items():
                if query.rpartition(" ")[2] not in tables:
                    continue
                for name, value in connection.execute(query):
                    fact = zlib.crc32(value) if isinstance(value, bytes) else value
                    results[f"{kind}/{name}"] = fact
    except sqlite3.DatabaseError as problem:
        raise DamagedDataError(str(problem)) from problem
    return results


def holds(fact: Any, allowed: list[Any], *, grows: bool) -> bool:
    """Return True if a fact has an allowed value, or a larger one if it only grows."""
    return fact in allowed or (grows and isinstance(fact, int) and fact >= min(allowed))
