"""Files that people have made, inside a backup: a table of the copied database.

So a backup stays one file, which SQLite examines and one checksum covers. An older version restores its
sessions and leaves the table alone.
"""

import sqlite3
from collections.abc import Iterator, Sequence
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
    "robots.json",
    CONFIG,
)
"""Files and folders of the data folder; the configuration may come from elsewhere."""
LEFT_OUT = (
    "Not in it: exported files, the audit log, and what is secret (the keys in tls and zenoh, and files of "
    "passwords that robot.toml names)."
)
LAB = "lab"
"""An empty file in the backup of a lab. A lab says itself where its archive is."""
FILE_BYTES_MAX = 50_000_000


def store_files(copy: sqlite3.Connection, folder: DataFolder, config: Path) -> list[str]:
    """Store the files beside the copied tables; return the names of files that are too large.

    Raise sqlite3.DatabaseError, OSError.
    """
    copy.execute(f"DROP TABLE IF EXISTS {TABLE}")
    copy.execute(f"CREATE TABLE {TABLE} (name TEXT PRIMARY KEY, content BLOB NOT NULL)")
    if folder.lab.exists():
        copy.execute(f"INSERT INTO {TABLE} VALUES (?, ?)", (LAB, b""))
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

    Return their names, None where the backup has no such table. Raise SetupError for a name that leads
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
            if not parts or parts[0] not in (*NAMES, LAB) or ".." in parts:
                raise SetupError(f"The backup holds a file {name!r}, which is none of a data folder.")
            path = target.joinpath(*parts)
            make_folder(path.parent)
            write_whole(path, content, 0o600)
            if name != LAB:
                names.append(name)
        connection.execute(f"DROP TABLE {TABLE}")
        connection.commit()
        return names
    finally:
        connection.close()


def put_files(folder: DataFolder, fresh: Path, aside: Path, names: Sequence[str] = NAMES) -> None:
    """Move the files of these names in `fresh` to their paths; existing ones go into the new folder `aside`.

    Files that the backup lacks go aside as well: afterwards the files are those of the backup. Without
    `fresh` all stay as they are. Raise OSError.
    """
    if not fresh.is_dir():
        return
    for name in names:
        present, restored = folder.path / name, fresh / name
        if present.exists():
            make_folder(aside)
            present.rename(aside / name)
        if restored.exists():
            restored.rename(present)


def _files(folder: DataFolder, config: Path) -> Iterator[tuple[str, Path]]:
    """Yield the files' names and paths; links and unusual names are omitted."""
    for name in NAMES:
        path = config if name == CONFIG else folder.path / name
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            inner = file.relative_to(path).parts if path.is_dir() else ()
            relative = "/".join((name, *inner))
            if file.is_file() and (not file.is_symlink() or name == CONFIG) and relative.isprintable():
                yield relative, file
