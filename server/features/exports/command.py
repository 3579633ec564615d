"""`mucat export` and `mucat import`: sessions taken home and brought back from a shell."""

import argparse
import asyncio
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from robot_runtime.durable_files import PART
from robot_runtime.errors import Refused
from server.features.exports.archive_reader import ArchiveRefused
from server.features.exports.description import file_name
from server.features.exports.files import FileFailed, put_in_place, write_part
from server.features.exports.formats import check
from server.features.exports.imports import Imports
from server.features.exports.schemas import Wanted
from server.features.exports.selection import ExportRefused, Source
from server.features.sessions.recording import RecordingError
from server.features.sessions.session import find_row
from server.platform.models import SessionRow
from server.platform.running_server import Claim, open_reader, send_file, server_runs
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.store import Store, StoreError

IMPORT_SECONDS = 3600.0


def export_session(options: argparse.Namespace, settings: Settings, claim: Claim) -> int:
    """Write a file, also beside a running server. Raises SetupError where it cannot be."""
    try:
        wanted = Wanted(
            format=options.format,
            topics=options.topics,
            columns=options.columns,
            start=options.start,
            end=options.end,
            **({} if options.period is None else {"period": options.period}),
        )
        kind = check(wanted)
        with open_reader(settings.data, claim) as store:
            row = find_row(store, options.session)
            if row is None:
                raise SetupError(f"There is no session {options.session} in {settings.data.path}.")
            source = Source(store, row, wanted, _Progress().tell)
            path = options.output or Path(file_name(source, kind.ending))
            part = path.with_name(path.name + PART)
            written = write_part(part, lambda output: kind.write(store, source, output))
            put_in_place(part, path)
    except ValidationError as problem:
        raise SetupError("; ".join(_words(error) for error in problem.errors())) from problem
    except (ExportRefused, FileFailed, RecordingError) as problem:
        raise SetupError(str(problem)) from problem
    except StoreError as problem:
        raise SetupError(f"The database {settings.data.database} fails: {problem}") from problem
    _say(f"{path}: {written.bytes} bytes, SHA-256 {written.sha256}")
    return 0


def import_session(options: argparse.Namespace, settings: Settings, claim: Claim) -> int:
    """Bring an archive in: through the server that runs, or without one by itself. Raises SetupError."""
    if not options.file.is_file():
        raise SetupError(f"There is no file {options.file}.")
    if server_runs(settings.data, claim):
        session = send_file(settings.data, "/imports", options.file, IMPORT_SECONDS)
        number, name = session["id"], session["name"]
    else:
        with claim(settings.data):
            number, name = _take(options.file, settings.data)
    _say(f"session {number}: {name}")
    return 0


def _take(file: Path, folder: DataFolder) -> tuple[int, str]:
    prepare(folder)
    try:
        with closing(Store(folder.database)) as store:
            number = asyncio.run(_import(store, folder, file))
            row = find_row(store, number)
            assert isinstance(row, SessionRow)
            return number, row.name
    except (ArchiveRefused, Refused, FileFailed) as problem:
        raise SetupError(str(problem)) from problem
    except StoreError as problem:
        raise SetupError(f"The database {folder.database} fails: {problem}") from problem


async def _import(store: Store, folder: DataFolder, file: Path) -> int:
    imports = Imports(folder, store)
    await imports.recover()
    return await imports.take(file)


def _words(error: Any) -> str:
    return f"{'.'.join(str(place) for place in error['loc'])}: {error['msg']}"


def _say(words: str) -> None:
    print(words)  # noqa: T201 - a command line speaks


class _Progress:
    """Writes percents to a terminal."""

    def __init__(self) -> None:
        self._told = -1

    def tell(self, share: float) -> None:
        percent = int(100 * share)
        if percent != self._told and sys.stderr.isatty():
            self._told = percent
            sys.stderr.write(f"\r{percent:3} %" + ("\r     \r" if percent == 100 else ""))
            sys.stderr.flush()
