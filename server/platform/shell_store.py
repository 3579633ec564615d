"""The database, opened by a command in a shell rather than by the server."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager

from migrations import HEAD
from server.platform.folder_lock import claim
from server.platform.schema import prepare, read_revision
from server.platform.settings import DataFolder, SetupError
from server.platform.store import Reader, Store, StoreError


@contextmanager
def open_reader(folder: DataFolder) -> Iterator[Reader]:
    """Open the database for reading alone, which may be done beside a running server.

    Creating or upgrading it needs the folder's lock. Raise SetupError where the folder is in use or
    the database fails.
    """
    if isinstance(folder.database_location, str):
        # It has a lock of its own for that.
        prepare(folder)
    elif not _is_current(folder):
        with claim(folder):
            prepare(folder)
    with _explained(folder), closing(Reader(folder.database_location)) as store:
        yield store


@contextmanager
def open_writer(folder: DataFolder) -> Iterator[Store]:
    """Create or upgrade the database of a claimed folder, and open it. Raise SetupError where it fails."""
    prepare(folder)
    with _explained(folder), closing(Store(folder.database_location)) as store:
        yield store


def _is_current(folder: DataFolder) -> bool:
    try:
        return read_revision(folder.database) == HEAD
    except sqlite3.DatabaseError:
        return False  # `prepare` says what is the matter


@contextmanager
def _explained(folder: DataFolder) -> Iterator[None]:
    try:
        yield
    except StoreError as problem:
        raise SetupError(f"The database {folder.database_location} fails: {problem}") from problem
