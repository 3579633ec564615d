"""Export of an hour at full rate, compared with plain pandas and the mcap writer.

All but `wall` are s of a processor, which other work on the computer does not lengthen. Ours includes reading
and unpacking what is stored, and pictures; the others are given the rows in memory, and only write them.
"""

import io
import json
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from mcap.writer import CompressionType, Writer

from bench.hour import copy_hours
from robot_runtime.contract.chunks import row_layout
from server.features.exports.files import write_part
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.features.exports.zip_stream import LEVEL
from server.platform.store import Reader
from server.recording.session import find_row


def measure() -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        (session,) = copy_hours(data)
        # Two at once, each on a core: first ours, then the others.
        with ProcessPoolExecutor(2, get_context("spawn")) as pool:
            (csv, csv_wall), (mcap, mcap_wall) = pool.map(partial(_export, session, data), ("csv", "mcap"))
            plain_csv, plain_mcap = pool.map(partial(_write_plain, session, data), ("csv", "mcap"))
    return {
        "export.csv_1h_s": csv,
        "export.csv_1h_wall_s": csv_wall,
        "export.csv_1h_pandas_s": plain_csv,
        "export.csv_1h_ratio": csv / plain_csv,
        "export.mcap_1h_s": mcap,
        "export.mcap_1h_wall_s": mcap_wall,
        "export.mcap_1h_plain_s": plain_mcap,
        "export.mcap_1h_ratio": mcap / plain_mcap,
    }


def _export(session: int, data: Path, kind: Any) -> tuple[float, float]:
    """Return s of the processor, and of the wall's clock."""
    with closing(Reader(data / "mucat.db")) as reader:
        cpu, wall = time.process_time(), time.monotonic()
        row = find_row(reader, session)
        assert row is not None
        options = ExportOptions(format=kind)
        source = ExportSelection(reader, row, options)
        write_part(data / kind, lambda output: check(options).write(reader, source, output))
        return time.process_time() - cpu, time.monotonic() - wall


def _write_plain(session: int, data: Path, kind: str) -> float:
    """Return s of the processor for writing the rows alone, which are in memory before."""
    with closing(Reader(data / "mucat.db")) as reader:
        row = find_row(reader, session)
        assert row is not None
        source = ExportSelection(reader, row, ExportOptions(format="csv"))
        tables = {
            name: _table(source, name) for name in source.names if source.topics[name]["kind"] != "picture"
        }
    write = {"csv": _write_pandas, "mcap": _write_mcap}[kind]
    before = time.process_time()
    write(tables, data)
    return time.process_time() - before


def _table(source: ExportSelection, name: str) -> pd.DataFrame:
    topic = source.topics[name]
    if topic["kind"] == "rows":
        names = [column.partition(" [")[0] for column in row_layout(topic).columns]
        times, values = source.columns(name, names)
        columns: dict[str, Any] = {f"value {column}": values[column] for column in names}
    else:
        documents = list(source.documents(name))
        times = np.array([document["time"] for document in documents])
        columns = {
            field["name"]: [document[field["name"]] for document in documents]
            for field in topic["fields"]
            if field["name"] != "time"
        }
    since = times - source.row.started_steady
    utc = pd.to_datetime(source.row.started + since, unit="s", utc=True)
    return pd.DataFrame({"time [s]": since, "utc": utc, **columns})


def _write_pandas(tables: dict[str, pd.DataFrame], data: Path) -> None:
    for name, table in tables.items():
        packed = {"method": "zip", "compresslevel": LEVEL}
        table.to_csv(data / f"{name}.zip", index=False, compression=packed)


def _write_mcap(tables: dict[str, pd.DataFrame], data: Path) -> None:
    with (data / "plain.mcap").open("wb") as file:
        writer = Writer(io.BufferedWriter(file.raw), compression=CompressionType.NONE)
        writer.start()
        for name, table in tables.items():
            schema = writer.register_schema(name, "jsonschema", b'{"type": "object"}')
            channel = writer.register_channel(name, "json", schema)
            for time_ns, message in _messages(table):
                writer.add_message(channel, time_ns, json.dumps(message).encode(), time_ns)
        writer.finish()  # type: ignore[no-untyped-call]


def _messages(table: pd.DataFrame) -> Iterator[tuple[int, dict[str, Any]]]:
    names = [name for name in table.columns if name != "utc"]
    columns = [table[name].tolist() for name in names]
    times = table["utc"].astype("int64").tolist()
    for time_ns, *values in zip(times, *columns, strict=True):
        yield time_ns, dict(zip(names, values, strict=True))
