"""`mucat backup` and `mucat restore`: sessions, settings and own files, copied while a server records."""

import sqlite3
from pathlib import Path

import click

from robot_runtime.transport.lifetime import give_way
from server.features.backup.restoration import put_back, remove_oldest
from server.platform.command_line import FILE, with_settings
from server.platform.database_copies import copy_database, describe_sessions, new_copy_path, write_checksum
from server.platform.folder_lock import claim, record_command
from server.platform.schema import explain
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.terminal import echo
from server.platform.user_files import LEFT_OUT, store_files

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

    FILE was written by `mucat backup`. A lab's archive in PostgreSQL must be empty.
    """
    with claim(settings.data):
        echo(put_back(settings, file))


def back_up(folder: DataFolder, config: Path, file: Path | None) -> str:
    """Copy the database and the users' files; return a sentence. Raise SetupError."""
    location = folder.database_location
    if isinstance(location, Path) and not location.is_file():
        raise SetupError(f"There is no database in {folder.path} yet, and so nothing to back up.")
    if file is not None and file.exists():
        raise SetupError(f"{file} exists already. Name another file.")
    try:
        path = file or new_copy_path(folder, "backup")
        large: list[str] = []
        copy_database(location, path, lambda copy: large.extend(store_files(copy, folder, config)))
        checksum = write_checksum(path)
    except (sqlite3.DatabaseError, OSError) as problem:
        where = folder.backups if file is None else file.parent
        raise SetupError(f"No backup was made: {explain(problem, where)}") from problem
    remark = remove_oldest(folder, "backup", path) if file is None else ""
    if large:
        remark += f" Too large, and not in it: {', '.join(large)}."
    return (
        f"{path}: {path.stat().st_size / 1e6:.1f} MB, {describe_sessions(path)}, SHA-256 {checksum}{remark}"
    )
