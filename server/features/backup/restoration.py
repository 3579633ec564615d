"""The restore of a backup: into the data folder, or into a lab's archive in PostgreSQL."""

import os
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

from robot_runtime.durable_files import put_in_place, sync, write_whole
from robot_runtime.places import DEFAULT_CONFIG
from server.platform.database_copies import (
    CHECKSUM,
    FILES,
    Kind,
    copy_database,
    describe_sessions,
    new_copy_path,
    sum_file,
    thin_out,
)
from server.platform.lab_config import LabConfig
from server.platform.numbers import carry_numbers
from server.platform.schema import explain, read_revision, refuse_unknown, upgrade
from server.platform.settings import DataFolder, Settings, SetupError, read_settings
from server.platform.sqlite_file import open_database
from server.platform.user_files import CONFIG, LAB, NAMES, put_files, take_files

LOGS = ("-wal", "-journal")
"""Files beside a database that may hold a part of it."""


def put_back(settings: Settings, file: Path) -> str:
    """Replace the database and the files of a claimed folder by a copy; return sentences.

    The old ones are put aside; an archive in PostgreSQL must be without sessions. The numbers of sessions go
    on after those of the replaced database. Raise SetupError.
    """
    folder = settings.data
    revision = _examine(file)
    fresh, files = folder.database.with_name("restored.db"), folder.path / "restored"
    try:
        shutil.rmtree(files, ignore_errors=True)
        copy_database(file, fresh)
        names = take_files(fresh, files)
        lab = (files / LAB).exists()
        _refuse_other_kind(folder, file, lab=lab)
        upgrade(fresh)
        sessions = describe_sessions(fresh)
        archive = _find_archive(settings, files) if lab else ""
        if lab:
            write_whole(folder.lab, archive.encode())
        aside = _replace(folder, archive, fresh)
    except (sqlite3.DatabaseError, OSError, SetupError) as problem:
        fresh.unlink(missing_ok=True)
        shutil.rmtree(files, ignore_errors=True)
        if isinstance(problem, SetupError):
            raise
        raise SetupError(f"Nothing was restored: {explain(problem, folder.path)}") from problem
    stays = lab and settings.config != DEFAULT_CONFIG
    try:
        # A lab's own robot.toml says where its archive is.
        placed = [name for name in NAMES if name != CONFIG or not stays]
        put_files(folder, files, aside.with_name(aside.name + FILES), placed)
    except OSError as problem:
        raise SetupError(
            f"The database was restored, but not all files: {explain(problem, folder.path)} The rest is in "
            f"{files}."
        ) from problem
    shutil.rmtree(files, ignore_errors=True)
    return (
        f"{archive or folder.database} was restored from {file} (revision {revision}): {sessions}"
        f"{_describe_files(names)}.{_describe_aside(folder, aside)}{_describe_config(settings, stays=stays)}"
    )


def _replace(folder: DataFolder, archive: str, fresh: Path) -> Path:
    """Put the copy in force; return the path beside which the replaced database and files belong."""
    if archive:
        from server.platform.archive_copies import restore_archive
        from server.platform.postgresql_schema import prepare_archive

        prepare_archive(archive)
        restore_archive(archive, fresh)
        fresh.unlink()
        return new_copy_path(folder, "replaced")
    carry_numbers(folder.database, fresh)
    aside = _put_aside(folder) if folder.database.exists() else new_copy_path(folder, "replaced")
    put_in_place(fresh, folder.database)
    return aside


def _refuse_other_kind(folder: DataFolder, file: Path, *, lab: bool) -> None:
    """Raise SetupError where a lab's backup would go over a robot's data, or the other way round."""
    if lab and folder.database.exists() and not folder.lab.exists():
        kinds = ("a lab", "a robot")
    elif not lab and folder.lab.exists():
        kinds = ("a robot", "a lab")
    else:
        return
    raise SetupError(
        f"{file} is the backup of {kinds[0]}, and {folder.path} holds the data of {kinds[1]}. Choose another "
        "folder with --data. Nothing was restored."
    )


def _find_archive(settings: Settings, files: Path) -> str:
    """Return the URL of the lab's archive, empty where it is a file.

    Without a configuration here that of the backup will be in force. Raise SetupError.
    """
    if settings.config == DEFAULT_CONFIG and (files / CONFIG).exists():
        settings = read_settings(files / CONFIG, settings.data.path, None, None, {})
    return settings.section(LabConfig).database


def _describe_files(names: list[str] | None) -> str:
    if names is None:
        return "; it is of an older version, without missions, scenarios, panels, craft and robot.toml"
    return f", {len(names)} other files" if len(names) != 1 else ", 1 other file"


def _describe_aside(folder: DataFolder, aside: Path) -> str:
    places = [str(path) for path in (aside, aside.with_name(aside.name + FILES)) if path.exists()]
    if not places:
        return ""
    return f" What was there before is now {' and '.join(places)}.{remove_oldest(folder, 'replaced', aside)}"


def _describe_config(settings: Settings, *, stays: bool) -> str:
    if stays:
        return f"\nThe lab goes on with {settings.config}."
    if settings.config in (settings.data.config, DEFAULT_CONFIG):
        return ""
    return f"\nThe robot goes on with {settings.config}; the restored one is {settings.data.config}."


def remove_oldest(folder: DataFolder, kind: Kind, made: Path) -> str:
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
