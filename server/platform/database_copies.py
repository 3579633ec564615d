"""Copies of the database, whole and on the disk, made while a server writes it."""

import fcntl
import hashlib
import os
import shutil
import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Literal

from robot_runtime.durable_files import PART, make_folder, unfinished, write_whole
from server.platform.settings import DataFolder
from server.platform.sqlite_file import open_database

Kind = Literal["backup", "before", "replaced"]
"""Copies made by hand, before an upgrade, and of a database that a restore replaced."""
COPIES_MOST = 5
"""The greatest number of copies of each kind in the data folder."""
DAMAGED_REMEDY = "Put back a copy (`mucat restore`), or move it away to start with an empty one"
ENDING = ".db"
CHECKSUM = ".sha256"
FILES = ".files"
"""End of the name of the folder with the files that a restore replaced, beside the database."""
SUM_BYTES = 1 << 20


def copy_database(
    location: Path | str, path: Path, add: Callable[[sqlite3.Connection], object] = lambda _: None
) -> None:
    """Copy a database as it is at this moment, checked by SQLite; only its owner may read the copy.

    `location` is a file of SQLite, or the URL of an archive in PostgreSQL; the copy is a file of SQLite.
    `add` stores more in it. The source is only read: its writer goes on meanwhile. Parts that killed copies
    have left in that folder are removed. Raise sqlite3.DatabaseError, OSError, and SetupError for an archive
    that cannot be read; then there is no copy.
    """
    with _new_copy(path) as copy:
        if isinstance(location, str):
            # Only a lab has the driver of PostgreSQL.
            from server.platform.archive_copies import copy_archive

            copy_archive(location, copy)
        else:
            with closing(open_database(location, "ro")) as source:
                # In one step: one that is written to between two of them would be begun again, for ever.
                source.backup(copy)
        add(copy)


@contextmanager
def _new_copy(path: Path) -> Iterator[sqlite3.Connection]:
    """Yield an empty database that comes to this path once it is filled and checked."""
    remove_abandoned(path.parent)
    with (
        # First: a part that somebody else writes must stay.
        _held(path.with_name(path.name + PART)),
        unfinished(path) as part,
        closing(sqlite3.connect(part)) as copy,
    ):
        copy.execute("PRAGMA synchronous = OFF")
        yield copy
        # One file, which also a medium that cannot be written shows.
        copy.execute("PRAGMA journal_mode = DELETE")
        (result,) = copy.execute("PRAGMA integrity_check(1)").fetchone()
        if result != "ok":
            raise sqlite3.DatabaseError(f"it is damaged ({result})")


def remove_abandoned(folder: Path) -> None:
    """Remove the parts of killed copies in a folder, with their journals. Raise OSError."""
    for part in folder.glob(f"*{ENDING}{PART}"):
        handle = os.open(part, os.O_WRONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            part.unlink()
        except BlockingIOError:
            continue  # it is being written
        finally:
            os.close(handle)
    for journal in folder.glob(f"*{ENDING}{PART}-journal"):
        if not journal.with_name(journal.name.removesuffix("-journal")).exists():
            journal.unlink(missing_ok=True)


@contextmanager
def _held(part: Path) -> Iterator[None]:
    """Create the file, empty, and lock it: a part without a lock is abandoned. Raise OSError."""
    handle = os.open(part, os.O_WRONLY | os.O_CREAT, 0o600)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OSError(f"another backup is writing {part}") from None
        os.ftruncate(handle, 0)
        yield
    finally:
        os.close(handle)


def describe_sessions(database: Path) -> str:
    """Return the number of sessions in a file of SQLite, with the word. Raise sqlite3.DatabaseError."""
    with closing(open_database(database, "ro")) as connection:
        (sessions,) = connection.execute("SELECT count(*) FROM session").fetchone()
    return "1 session" if sessions == 1 else f"{sessions} sessions"


def new_copy_path(folder: DataFolder, kind: Kind, revision: str = "") -> Path:
    """Return the path for a new copy of this kind, in a folder that exists. Raise OSError."""
    make_folder(folder.backups)
    moment = time.strftime("%Y-%m-%d_%H-%M-%S", time.gmtime())
    return folder.backups / "-".join(["mucat", kind, *([revision] if revision else []), f"{moment}.db"])


def thin_out(folder: DataFolder, kind: Kind, made: Path) -> None:
    """Remove the oldest copies of this kind, but not the one just made. Raise OSError."""
    # By its name it is not the newest where the clock was ahead when others were made, or is behind now.
    others = [path for path in folder.backups.glob(f"mucat-{kind}-*.db") if path != made]
    for copy in sorted(others, key=lambda path: path.stem[-19:])[: 1 - COPIES_MOST]:
        for part in folder.backups.glob(f"{copy.name}*"):
            if part.name.endswith(FILES):
                shutil.rmtree(part)
            else:
                part.unlink()


def write_checksum(path: Path) -> str:
    """Write the file's SHA-256 beside it, as sha256sum(1) reads it. Raise OSError."""
    checksum = sum_file(path)
    write_whole(path.with_name(path.name + CHECKSUM), f"{checksum}  {path.name}\n".encode())
    return checksum


def sum_file(path: Path) -> str:
    """Return a file's SHA-256 in hexadecimal. Raise OSError."""
    checksum = hashlib.sha256()
    with path.open("rb") as file:
        while piece := file.read(SUM_BYTES):
            checksum.update(piece)
    return checksum.hexdigest()
