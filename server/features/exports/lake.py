"""A lake of Parquet files for DuckDB and notebooks: figures of all sessions, and chosen topics of each.

    FOLDER/figures.parquet                       a row for each session and each of its segments
    FOLDER/<topic>/session=<identifier>/data.parquet

The folders' names are a column of their own to DuckDB, pyarrow and pandas. Files that are there stay.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sqlmodel import col, select

from robot_runtime.durable_files import unfinished
from server.features.exports.parquet import check_parquet, write_topic
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.library.listing import EVERY_SESSION, conditions
from server.platform.models import SessionFiguresRow, SessionRow
from server.platform.store import Reader
from server.recording.session import find_row

SESSION_COLUMNS = ("identifier", "name", "robot", "started", "firmware", "software", "scenario_name", "seed")


def write_lake(store: Reader, folder: Path, topics: Sequence[str]) -> int:
    """Write what is missing in the folder; return the number of sessions.

    Raise ExportRequestError without pyarrow, OSError, StoreError, RecordingError.
    """
    check_parquet()
    _write_figures(store, folder)
    query = select(SessionRow.id).where(*conditions(EVERY_SESSION), SessionRow.state != "recording")
    with store.read() as database:
        sessions = [number for number in database.exec(query.order_by(col(SessionRow.id))) if number]
    for session in sessions:
        row = find_row(store, session)
        source = ExportSelection(store, row, ExportOptions(format="parquet"))
        for topic in source.names:
            path = folder / topic / f"session={row.identifier}" / "data.parquet"
            if topic in topics and not path.exists():
                path.parent.mkdir(parents=True, exist_ok=True)
                with unfinished(path) as part, part.open("wb") as file:
                    write_topic(source, topic, file)
    return len(sessions)


def _write_figures(store: Reader, folder: Path) -> None:
    import pyarrow as pa
    from pyarrow.parquet import write_table

    figures = [name for name in SessionFiguresRow.model_fields if name != "session_id"]
    columns: list[Any] = [getattr(SessionRow, name) for name in SESSION_COLUMNS]
    columns += [getattr(SessionFiguresRow, name) for name in figures]
    query = select(*columns).join(SessionFiguresRow, col(SessionFiguresRow.session_id) == col(SessionRow.id))
    with store.read() as database:
        rows = [tuple(row) for row in database.connection().execute(query.where(*conditions(EVERY_SESSION)))]
    types = {"started": pa.float64(), "seed": pa.int64(), "segment": pa.int64()}
    texts = (*SESSION_COLUMNS, "controller", "gains", "craft")
    names = [*SESSION_COLUMNS, *figures]
    fields = [
        pa.field(name, types.get(name, pa.string() if name in texts else pa.float64())) for name in names
    ]
    values = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    table = pa.table(
        [pa.array(column, field.type) for column, field in zip(values, fields, strict=True)], names
    )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "figures.parquet"
    with unfinished(path) as part:
        write_table(table, part)
