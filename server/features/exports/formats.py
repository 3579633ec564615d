"""The export formats by name, with their writers and the endings of file names."""

from collections.abc import Callable
from typing import BinaryIO, NamedTuple

from server.analysis.schemas import DEFAULT_SIGNALS, REPORT_POINTS, ComparisonQuery
from server.features.exports.archive import write_archive
from server.features.exports.film_file import check_overlay, require_film, write_film
from server.features.exports.grid import write_grid
from server.features.exports.mcap_file import check_compression, check_mcap, write_mcap
from server.features.exports.parquet import check_parquet, write_parquet
from server.features.exports.schemas import ExportOptions, Format
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.exports.tables import write_tables
from server.features.exports.workbook import require_sheets, write_workbook
from server.platform.store import Reader

Write = Callable[[Reader, ExportSelection, BinaryIO], None]


class ExportFormat(NamedTuple):
    """A format: its writer, the ending of its files' names, and their media type."""

    write: Write
    ending: str
    media_type: str
    check: Callable[[], None] = lambda: None
    """Raises ExportRequestError if a package for it is missing."""
    require: Callable[[ExportSelection], None] = lambda _: None
    """Raises ExportRequestError for more samples than a file of it holds."""

    def write_unpurged(self, store: Reader, source: ExportSelection, output: BinaryIO) -> None:
        """Write the session. Raise ExportRequestError where it was purged meanwhile."""
        self.write(store, source, output)
        source.refuse_purged()


def write_report(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write the figures and charts of a whole session as HTML. Raise StoreError, RecordingError."""
    from server.analysis import report  # Plotly and NumPy, only for this format
    from server.analysis.comparer import Comparer

    query = ComparisonQuery(
        sessions=[source.row.id or 0], signals=list(DEFAULT_SIGNALS), points=REPORT_POINTS
    )
    output.write(report.write_report(Comparer(store).compare(query)).encode())


ZIP = "application/zip"
WORKBOOK = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
KINDS: dict[Format, ExportFormat] = {
    "csv": ExportFormat(write_tables, ".csv.zip", ZIP),
    "csv-grid": ExportFormat(write_grid, ".grid.zip", ZIP),
    "xlsx": ExportFormat(write_workbook, ".xlsx", WORKBOOK, require=require_sheets),
    "parquet": ExportFormat(write_parquet, ".parquet.zip", ZIP, check_parquet),
    "mcap": ExportFormat(write_mcap, ".mcap", "application/octet-stream", check_mcap),
    "archive": ExportFormat(write_archive, ".mucat.zip", ZIP),
    "report": ExportFormat(write_report, ".html", "text/html"),
    "mp4": ExportFormat(write_film, ".mp4", "video/mp4", require=require_film),
}

WHOLE_ONLY = ("archive", "report")
NO_TOPICS = {
    "csv-grid": "columns",
    "mp4": "nothing: it holds the film",
    **dict.fromkeys(WHOLE_ONLY, "nothing: it holds the whole session"),
}
"""Choice in place of topics, by formats."""


def check(options: ExportOptions) -> ExportFormat:
    """Return the chosen format. Raise ExportRequestError for options that exclude each other."""
    if options.columns is not None and options.format != "csv-grid":
        raise ExportRequestError("Columns are chosen for csv-grid alone; the other formats take topics.")
    if options.topics is not None and options.format in NO_TOPICS:
        choose = NO_TOPICS[options.format]
        raise ExportRequestError(f"For {options.format} choose {choose}, not topics.")
    if options.format in WHOLE_ONLY and (options.start is not None or options.end is not None):
        raise ExportRequestError(f"The {options.format} holds the whole session; leave start and end out.")
    if options.spreadsheet != "none" and options.format not in ("csv", "csv-grid"):
        raise ExportRequestError("A spreadsheet's decimal sign is chosen for csv and csv-grid alone.")
    if options.overlay != "none":
        if options.format != "mp4":
            raise ExportRequestError("Subtitles and lines are chosen for mp4 alone.")
        check_overlay(options.overlay)
    if options.compression != "none":
        if options.format != "mcap":
            raise ExportRequestError("Compression is chosen for mcap alone.")
        check_compression(options.compression)
    kind = KINDS[options.format]
    kind.check()
    return kind
