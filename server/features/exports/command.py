"""`mucat export` and `mucat import`: export and import of sessions from a shell."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from server.platform.command_line import FILE, NUMBER, CommandError, RowCommand, name_error, with_settings
from server.platform.name_completion import SESSION_NUMBER
from server.platform.terminal import echo

if TYPE_CHECKING:
    from server.features.exports.selection import ExportSelection
    from server.platform.settings import DataFolder, Settings

FORMATS = ("csv", "csv-grid", "xlsx", "parquet", "mcap", "archive", "report", "mp4")
IMPORT_SECONDS = 3600.0


@click.command("export", cls=RowCommand)
@click.argument("session", type=SESSION_NUMBER)
@click.option("--format", type=click.Choice(FORMATS), default="csv")
@click.option("--topics", multiple=True, metavar="TOPIC...", help="Default: all.")
@click.option("--columns", multiple=True, metavar="TOPIC.COLUMN...", help="For csv-grid. Default: all.")
@click.option("--start", type=NUMBER, metavar="S", help="Begin so many seconds after the session's start.")
@click.option("--end", type=NUMBER, metavar="S", help="End so many seconds after the session's start.")
@click.option("--period", type=NUMBER, metavar="S", help="Seconds between lines of csv-grid. Default: 0.1.")
@click.option(
    "--spreadsheet",
    type=click.Choice(("point", "comma")),
    help="For csv and csv-grid: as a spreadsheet with this decimal sign reads it.",
)
@click.option("--compression", type=click.Choice(("none", "zstd", "lz4")), help="For mcap. Default: none.")
@click.option(
    "--overlay",
    type=click.Choice(("none", "subtitles", "lines")),
    help="For mp4: values as subtitles, or as lines drawn into the pictures. Default: none.",
)
@click.option("-o", "--output", type=FILE, help="Default: a file here, named after the session.")
@with_settings
def export_session(settings: "Settings", session: int, output: Path | None, **choice: Any) -> None:
    """Write a session as a file, also beside a running server."""
    from pydantic import ValidationError

    from robot_runtime.durable_files import PART
    from server.features.exports.description import file_name
    from server.features.exports.files import put_in_place, write_part
    from server.features.exports.formats import check
    from server.features.exports.schemas import ExportOptions
    from server.features.exports.selection import ExportSelection
    from server.platform.folder_lock import record_command
    from server.platform.shell_store import open_reader
    from server.recording.session import find_row

    try:
        options = ExportOptions.model_validate(
            {
                name: list(value) if isinstance(value, tuple) else value
                for name, value in choice.items()
                if value not in (None, ())
            }
        )
        kind = check(options)
        record_command(settings.data)
        with open_reader(settings.data) as store:
            source = ExportSelection(store, find_row(store, session), options, _Progress().tell)
            if options.spreadsheet != "none":
                _warn_of_long_tables(source)
            path = output or Path(file_name(source, kind.ending))
            part = path.with_name(path.name + PART)
            written = write_part(part, lambda file: kind.write_unpurged(store, source, file))
            put_in_place(part, path)
    except ValidationError as problem:
        raise CommandError("; ".join(name_error(error) for error in problem.errors())) from problem
    echo(f"{path}: {written.bytes} bytes, SHA-256 {written.sha256}")


@click.command("import")
@click.argument("file", type=FILE)
@with_settings
def import_session(settings: "Settings", file: Path) -> None:
    """Import a session from an archive.

    FILE was written by `mucat export --format archive`.
    """
    from server.platform.folder_lock import claim
    from server.platform.running_server import send_file, server_runs

    if not file.is_file():
        raise CommandError(f"There is no file {file}.")
    if server_runs(settings.data):
        session = send_file(settings.data, "/imports", file, IMPORT_SECONDS)
        number, name = session["id"], session["name"]
    else:
        with claim(settings.data):
            number, name = _take(file, settings.data)
    echo(f"session {number}: {name}")


def _take(file: Path, folder: "DataFolder") -> tuple[int, str]:
    import asyncio

    from server.features.exports.imports import Imports
    from server.platform.shell_store import open_writer
    from server.recording.session import find_row

    async def take(imports: Imports) -> int:
        await imports.recover()
        return await imports.take(file)

    with open_writer(folder) as store:
        number = asyncio.run(take(Imports(folder, store)))
        return number, find_row(store, number).name


def _warn_of_long_tables(source: "ExportSelection") -> None:
    from server.features.exports.workbook import SHEET_LINES

    for name, count in source.samples.items() if source.options.format == "csv" else ():
        if count >= SHEET_LINES:
            echo(f"{name}.csv has {count + 1} lines; a spreadsheet shows {SHEET_LINES} of them.", err=True)


class _Progress:
    """The progress in percent, printed to a terminal."""

    def __init__(self) -> None:
        self._reported = -1

    def tell(self, share: float) -> None:
        percent = int(100 * share)
        if percent != self._reported and sys.stderr.isatty():
            self._reported = percent
            sys.stderr.write(f"\r{percent:3} %" + ("\r     \r" if percent == 100 else ""))
            sys.stderr.flush()
