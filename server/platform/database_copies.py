"""Copies of the database, whole and on the disk, made while a server writes it."""

import hashlib
import os
import sqlite3
import time
from contextlib import closing
from pathlib import Path
from typing import Literal

from robot_runtime.durable_files import make_folder, unfinished, write_whole
from server.platform.settings import DataFolder

Kind = Literal["backup", "before", "replaced"]
"""Copies made by hand, before an upgrade, and of a database that a restore replaced."""
COPIES_MOST = 5
"""The greatest number of copies of each kind in the data folder."""
DAMAGED_REMEDY = "Put back a copy (`mucat restore`), or move it away to start with an empty one"
CHECKSUM = ".sha256"
SUM_BYTES = 1 << 20


def copy_database(database: Path, path: Path) -> None:
    """Copy a database as it is at this moment, looked through by SQLite; nobody else may read the copy.

    The source is only read: whoever writes it goes on meanwhile. Raises sqlite3.DatabaseError, OSError; then
    there is no copy.
    """
    with unfinished(path) as part:
        os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600))
        with closing(open_database(database, "ro")) as source, closing(sqlite3.connect(part)) as copy:
            copy.execute("PRAGMA synchronous = OFF")
            # In one step: one that is written to between two of them would be begun again, for ever.
            source.backup(copy)
            # One file, which also a medium that cannot be written shows.
            copy.execute("PRAGMA journal_mode = DELETE")
            (found,) = copy.execute("PRAGMA integrity_check(1)").fetchone()
            if found != "ok":
                raise sqlite3.DatabaseError(f"it is damaged ({found})")


def open_database(database: Path, mode: Literal["ro", "rw"]) -> sqlite3.Connection:
    """Open one that is there. Raises sqlite3.DatabaseError."""
    return sqlite3.connect(f"{database.absolute().as_uri()}?mode={mode}", uri=True)


def place(folder: DataFolder, kind: Kind, revision: str = "") -> Path:
    """Path for a new copy of this kind, in a folder that exists. Raises OSError."""
    make_folder(folder.backups)
    moment = time.strftime("%Y-%m-%d_%H-%M-%S", time.gmtime())
    return folder.backups / "-".join(["mucat", kind, *([revision] if revision else []), f"{moment}.db"])


def thin_out(folder: DataFolder, kind: Kind, made: Path) -> None:
    """Remove the oldest copies of this kind, but not the one just made. Raises OSError."""
    # By its name it is not the newest where the clock was ahead when others were made, or is behind now.
    others = [path for path in folder.backups.glob(f"mucat-{kind}-*.db") if path != made]
    for copy in sorted(others, key=lambda path: path.stem[-19:])[: 1 - COPIES_MOST]:
        for part in folder.backups.glob(f"{copy.name}*"):
            part.unlink()


def write_checksum(path: Path) -> str:
    """Write the file's SHA-256 beside it, as sha256sum(1) reads it. Raises OSError."""
    checksum = sum_file(path)
    write_whole(path.with_name(path.name + CHECKSUM), f"{checksum}  {path.name}\n".encode())
    return checksum


def sum_file(path: Path) -> str:
    """A file's SHA-256 in hexadecimal. Raises OSError."""
    checksum = hashlib.sha256()
    with path.open("rb") as file:
        while piece := file.read(SUM_BYTES):
            checksum.update(piece)
    return checksum.hexdigest()
