"""A PostgreSQL database: the archive of a lab that outgrows one file."""

from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event, pool
from sqlalchemy.exc import DBAPIError

from server.platform.engine import DISK_FULL, DatabaseEngine, Space

WRITER = 0x6D75634174
"""The advisory lock of the one writer."""
CONNECT_SECONDS = 5
"""After which a PostgreSQL counts as unreachable."""
NO_ROOM = "53100"
"""PostgreSQL's code of a full disk (appendix A of its manual)."""


class PostgreSQL(DatabaseEngine):
    """A database that `postgresql_schema.prepare` has made or upgraded. Its writer holds an advisory lock."""

    def __init__(self, url: str) -> None:
        self._url = url
        self.held = f"another lab writes {url}: end it first"

    def hold(self) -> None:
        """Do nothing yet: the lock belongs to the connection that writes."""

    def release(self) -> None:
        """Do nothing: the lock has ended with its connection."""

    def reading(self) -> Engine:
        """Return connections that only read; those that a restart of PostgreSQL has cut are replaced."""
        return self._connect(pool.QueuePool, "-c default_transaction_read_only=on", pool_pre_ping=True)

    def writing(self) -> Engine:
        """Return the one connection that writes; where it breaks, the next change opens another."""
        writer = self._connect(pool.StaticPool, "")
        event.listen(writer, "connect", _lock)
        return writer

    def explain(self, problem: DBAPIError) -> str:
        """Return the reason of a failure, for a person."""
        message = " ".join(str(problem.orig).split())
        code = getattr(problem.orig, "sqlstate", None)
        if code == NO_ROOM:
            return f"{DISK_FULL}: free some space on the computer of PostgreSQL"
        if code is None or problem.connection_invalidated:
            return f"PostgreSQL does not answer: {message}"
        return f"the database refuses: {message}"

    def touch(self, connection: Connection) -> None:
        """Write the schema's revision again."""
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = version_num")

    def measure(self, connection: Connection) -> Space:
        """Return the room that the database takes; PostgreSQL reuses its own by itself."""
        return Space(
            int(connection.exec_driver_sql("SELECT pg_database_size(current_database())").scalar_one()), 0
        )

    def free_some(self, connection: Connection, pages: int) -> int:  # noqa: ARG002 - its autovacuum does
        """Return 0: PostgreSQL's autovacuum does it."""
        return 0

    def _connect(self, pool_class: type[pool.Pool], options: str, **more: Any) -> Engine:
        arguments = {"connect_timeout": CONNECT_SECONDS, "application_name": "mucat", "options": options}
        return create_engine(self._url, poolclass=pool_class, connect_args=arguments, **more)


def _lock(connection: Any, _record: object) -> None:
    with connection.cursor() as cursor:
        cursor.execute(f"SELECT pg_try_advisory_lock({WRITER})")
        (locked,) = cursor.fetchone()
    connection.commit()
    if not locked:
        connection.close()
        raise BlockingIOError
