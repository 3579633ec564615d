"""A database engine, as the store uses it: SQLite in the data folder, or a PostgreSQL server."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import NamedTuple

from sqlalchemy import Connection, Engine
from sqlalchemy.exc import DBAPIError

from server.platform.disk_reserve import DiskReserve

DISK_FULL = "the disk is full"


class Space(NamedTuple):
    """The room that a database takes, and the part of it that is free for reuse, in bytes."""

    size: int
    reusable: int


class DatabaseEngine(ABC):
    """The connections to one database, and what differs between databases.

    `held` says that another program writes it; `reserve` is the room that is given up on a full disk.
    """

    held: str
    reserve: DiskReserve | None = None

    @abstractmethod
    def hold(self) -> None:
        """Become the one writer. Raise BlockingIOError where another program is."""

    @abstractmethod
    def release(self) -> None:
        """Give up writing, so that another program may."""

    @abstractmethod
    def reading(self) -> Engine:
        """Return connections that only read."""

    @abstractmethod
    def writing(self) -> Engine:
        """Return the one connection that writes."""

    @abstractmethod
    def explain(self, problem: DBAPIError) -> str:
        """Return the reason of a failure, for a person; it begins with `DISK_FULL` where that is it."""

    @abstractmethod
    def touch(self, connection: Connection) -> None:
        """Change something without a meaning."""

    @abstractmethod
    def measure(self, connection: Connection) -> Space:
        """Return the room that the database takes."""

    @abstractmethod
    def free_some(self, connection: Connection, pages: int) -> int:
        """Return a few free pages to the disk; return how many are left, 0 where that is not needed."""


def read_location(text: str) -> Path | str:
    """Return the location of a database that a process was given as text."""
    return text if "://" in text else Path(text)
