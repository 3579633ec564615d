"""`mucat backup` and `mucat restore`: sessions, settings and own files, copied while a server records."""

import os
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import click

from robot_runtime.durable_files import put_in_place, sync, write_whole
from robot_runtime.places import DEFAULT_CONFIG
from robot_runtime.transport.lifetime import give_way
from server.platform.command_line import FILE, with_settings
from server.platform.database_copies import (
    CHECKSUM,
    FILES,
    Kind,
    copy_database,
    new_copy_path,
    open_database,
    sum_file,
    thin_out,
    write_checksum,
)
from server.platform.folder_lock import claim, record_command
from server.platform.numbers import carry_numbers
from server.platform.schema import explain, read_revision, refuse_unknown, upgrade
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.terminal import echo
from server.platform.user_files import LEFT_OUT, put_files, store_files, take_files

LOGS = ("-wal", "-journal")
"""Files beside a database that may hold a part of it."""
NICENESS = 15
"""Control and recording have priority."""


@click.command("backup")
@click.argument("file", type=FILE, required=False)
@with_settings
def backup(settings: Settings, file: Path | None) -> None:
    """Copy sessions, settings and own files, also while a server records.

    FILE is a new one in the folder `backups` of the data folder by default.
    """
    give_way(NICENESS)
    record_command(settings.data)
    echo(back_up(settings.data, settings.config, file))
    echo(LEFT_OUT)


@click.command("restore")
@click.argument("file", type=FILE)
@with_settings
def restore(settings: Settings, file: Path) -> None:
    """Replace the present database and files by a backup.

    FILE was written by `mucat backup`.
    """
    with claim(settings.data):
        echo(put_back(settings.data, file))
        if settings.config not in (settings.data.config, DEFAULT_CONFIG):
            echo(f"The robot goes on with {settings.config}; the restored one is {settings.data.config}.")


def back_up(folder: DataFolder, config: Path, file: Path | None) -> str:
    """Copy the database and the users' files; return a sentence. Raise SetupError."""
    if not folder.database.is_file():
        raise SetupError(f"There is no database in {folder.path} yet, and so nothing to back up.")
    if file is not None and file.exists():
        raise SetupError(f"{file} exists already. Name another file.")
    try:
        path = file or new_copy_path(folder, "backup")
        large: list[str] = []
        copy_database(folder.database, path, lambda copy: large.extend(store_files(copy, folder, config)))
        checksum = write_checksum(path)
    except (sqlite3.DatabaseError, OSError) as problem:
        where = folder.backups if file is None else file.parent
        raise SetupError(f"No backup was made: {explain(problem, where)}") from problem
    remark = _thin_out(folder, "backup", path) if file is None else ""
    if large:
        remark += f" Too large, and not in it: {', '.join(large)}."
    return f"{path}: {path.stat().st_size / 1e6:.1f} MB, {_count(path)}, SHA-256 {checksum}{remark}"


def put_back(folder: DataFolder, file: Path) -> str:
    """Replace the database and the files of a claimed folder by a copy; the old ones are put aside.

    The numbers of sessions go on after those of the replaced database. Raise SetupError.
    """
    revision = _examine(file)
    fresh, files = folder.database.with_name("restored.db"), folder.path / "restored"
    try:
        shutil.rmtree(files, ignore_errors=True)
        copy_database(file, fresh)
        names = take_files(fresh, files)
        upgrade(fresh)
        carry_numbers(folder.database, fresh)
        aside = _put_aside(folder) if folder.database.exists() else new_copy_path(folder, "replaced")
        put_in_place(fresh, folder.database)
    except (sqlite3.DatabaseError, OSError, SetupError) as problem:
        fresh.unlink(missing_ok=True)
        shutil.rmtree(files, ignore_errors=True)
        if isinstance(problem, SetupError):
            raise
        raise SetupError(f"Nothing was restored: {explain(problem, folder.path)}") from problem
    try:
        put_files(folder, files, aside.with_name(aside.name + FILES))
    except OSError as problem:
        raise SetupError(
            f"The database was restored, but not all files: {explain(problem, folder.path)} The rest is in "
            f"{files}."
        ) from problem
    shutil.rmtree(files, ignore_errors=True)
    return (
        f"{folder.database} was restored from {file} (revision {revision}): {_count(folder.database)}"
        f"{_describe_files(names)}.{_describe_aside(folder, aside)}"
    )


def _describe_files(names: list[str] | None) -> str:
    if names is None:
        return "; it is of an older version, without missions, scenarios, panels, craft and robot.toml"
    return f", {len(names)} other files" if len(names) != 1 else ", 1 other file"


def _describe_aside(folder: DataFolder, aside: Path) -> str:
    places = [str(path) for path in (aside, aside.with_name(aside.name + FILES)) if path.exists()]
    if not places:
        return ""
    return f" What was there before is now {' and '.join(places)}.{_thin_out(folder, 'replaced', aside)}"


def _thin_out(folder: DataFolder, kind: Kind, made: Path) -> str:
    """Remove the oldest copies; return a remark where they cannot be removed."""
    try:
        thin_out(folder, kind, made)
    except OSError as problem:
        return f" Older copies cannot be deleted: {problem.strerror} ({problem.filename})."
    return ""


def _examine(file: Path) -> str:
    if not file.is_file():
        raise SetupError(f"There is no file {file}.")
    try:
        listed = file.with_name(file.name + CHECKSUM)
        if listed.is_file() and listed.read_text(encoding="utf-8").split()[:1] != [sum_file(file)]:
            raise SetupError(
                f"{file} has changed since the backup: its checksum differs from the one in {listed}."
            )
        revision = read_revision(file)
    except (sqlite3.DatabaseError, OSError, UnicodeDecodeError) as problem:
        raise SetupError(f"{file} cannot be restored: {problem}.") from problem
    if revision is None:
        raise SetupError(f"{file} cannot be restored: it holds no sessions of µ-CAT.")
    refuse_unknown(revision, file)
    return revision


def _put_aside(folder: DataFolder) -> Path:
    """Give the present database a second name, so that the copy replaces it in one step.

    A working database is first merged into one file. For a damaged one, the files beside it are saved too;
    they must not stay in place, or SQLite would take them for the copy's.
    """
    aside = new_copy_path(folder, "replaced")
    logs = {path: _beside(aside, end) for end in LOGS if (path := _beside(folder.database, end)).exists()}
    for path, saved in logs.items():
        write_whole(saved, path.read_bytes(), 0o600)
    try:
        with closing(open_database(folder.database, "rw")) as database:
            database.execute("PRAGMA journal_mode = DELETE")
    except sqlite3.DatabaseError:
        pass
    else:
        for saved in logs.values():
            saved.unlink()
    os.link(folder.database, aside)
    sync(folder.backups)
    for end in (*LOGS, "-shm"):
        _beside(folder.database, end).unlink(missing_ok=True)
    sync(folder.path)
    return aside


def _beside(database: Path, end: str) -> Path:
    return database.with_name(database.name + end)


def _count(database: Path) -> str:
    with closing(open_database(database, "ro")) as connection:
        (sessions,) = connection.execute("SELECT count(*) FROM session").fetchone()
    return "1 session" if sessions == 1 else f"{sessions} sessions"
