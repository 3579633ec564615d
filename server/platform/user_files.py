"""Files that people have made, inside a backup: a table of the copied database.

So a backup stays one file, which SQLite examines and one checksum covers. An older version restores its
sessions and leaves the table alone.
"""

import sqlite3
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from robot_runtime.durable_files import make_folder, write_whole
from server.platform.settings import DataFolder, SetupError

TABLE = "backup_file"
CONFIG = "robot.toml"
NAMES = (
    "missions",
    "scenarios",
    "panels",
    "craft.toml",
    "craft-before.toml",
    "vision.json",
    "bring-up.html",
    CONFIG,
)
"""Files and folders of the data folder; the configuration may come from elsewhere."""
LEFT_OUT = (
    "Not in it: exported files, the audit log, and what is secret (the keys in tls and zenoh, and files of "
    "passwords that robot.toml names)."
)
FILE_BYTES_MAX = 50_000_000


def store_files(copy: sqlite3.Connection, folder: DataFolder, config: Path) -> list[str]:
    """Store the files beside the copied tables; returns the names of files that are too large.

    Raises sqlite3.DatabaseError, OSError.
    """
    copy.execute(f"DROP TABLE IF EXISTS {TABLE}")
    copy.execute(f"CREATE TABLE {TABLE} (name TEXT PRIMARY KEY, content BLOB NOT NULL)")
    large = []
    for name, path in _files(folder, config):
        if path.stat().st_size > FILE_BYTES_MAX:
            large.append(name)
        else:
            copy.execute(f"INSERT INTO {TABLE} VALUES (?, ?)", (name, path.read_bytes()))
    copy.commit()
    return large


def take_files(database: Path, target: Path) -> list[str] | None:
    """Move the files of a backup out of its copy `database` into the new folder `target`.

    Returns their names, None where the backup has no such table. Raises SetupError for a name that leads
    elsewhere, sqlite3.DatabaseError, OSError.
    """
    connection = sqlite3.connect(database)
    try:
        query = "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = ?"
        if not connection.execute(query, (TABLE,)).fetchone()[0]:
            return None
        names = []
        make_folder(target)
        for name, content in connection.execute(f"SELECT name, content FROM {TABLE}"):
            parts = PurePosixPath(name).parts
            if not parts or parts[0] not in NAMES or ".." in parts:
                raise SetupError(f"The backup holds a file {name!r}, which is none of a data folder.")
            path = target.joinpath(*parts)
            make_folder(path.parent)
            write_whole(path, content, 0o600)
            names.append(name)
        connection.execute(f"DROP TABLE {TABLE}")
        connection.commit()
        return names
    finally:
        connection.close()


def put_files(folder: DataFolder, fresh: Path, aside: Path) -> None:
    """Give the files in `fresh` their places; what was there goes into the new folder `aside`.

    What the backup lacks goes aside as well: afterwards the files are those of the backup. Without `fresh`
    all stay as they are. Raises OSError.
    """
    if not fresh.is_dir():
        return
    for name in NAMES:
        present, restored = folder.path / name, fresh / name
        if present.exists():
            make_folder(aside)
            present.rename(aside / name)
        if restored.exists():
            restored.rename(present)


def _files(folder: DataFolder, config: Path) -> Iterator[tuple[str, Path]]:
    """Their names and paths; links and unusual names are left alone."""
    for name in NAMES:
        path = config if name == CONFIG else folder.path / name
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            inner = file.relative_to(path).parts if path.is_dir() else ()
            place = "/".join((name, *inner))
            if file.is_file() and (not file.is_symlink() or name == CONFIG) and place.isprintable():
                yield place, file
