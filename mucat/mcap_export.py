"""Reads what `mucat export --format mcap` writes; needs the package mcap."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from mucat.errors import RobotError
from mucat.tables import SessionTables, TopicTable, si_column, text_of_value, typed_column

MAGIC = b"\x89MCAP0\r\n"
OWN = "mucat."
"""The beginning of our own schemas' names."""


def read_mcap(path: Path) -> SessionTables:
    """The tables of a file. Raises RobotError."""
    try:
        from mcap.exceptions import McapError
        from mcap.reader import make_reader
    except ImportError as problem:
        raise RobotError("MCAP files need the package mcap: pip install mcap") from problem
    try:
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            summary = reader.get_summary()
            described = [one.data for one in reader.iter_attachments() if one.name == "session.json"]
    except (McapError, ValueError) as problem:
        raise RobotError(f"{path} cannot be read: {problem}.") from problem
    if summary is None or not described:
        raise RobotError(f"{path} is no session of µ-CAT.")
    about = json.loads(described[0])
    schemas = [summary.schemas[channel.schema_id].name for channel in summary.channels.values()]
    own = [name.removeprefix(OWN) for name in schemas if name.startswith(OWN)]
    return SessionTables(
        about, {name: partial(_read_topic, path, name, about["topics"][name]) for name in own}
    )


def _read_topic(path: Path, name: str, described: Mapping[str, Any]) -> TopicTable:
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    messages: list[dict[str, Any]] = []
    utc: list[str] = []
    try:
        with path.open("rb") as file:
            for _, _, message in make_reader(file, validate_crcs=True).iter_messages(topics=[f"/{name}"]):
                messages.append(json.loads(message.data))
                moment = datetime.fromtimestamp(message.log_time / 1e9, UTC)
                utc.append(moment.isoformat(timespec="milliseconds").replace("+00:00", "Z"))
    except (McapError, ValueError) as problem:
        raise RobotError(f"{path} cannot be read: {problem}.") from problem
    columns: dict[str, Sequence[Any]] = {"time": [one["time"] for one in messages], "utc": utc}
    units = {"time": "s"}
    for field in described["fields"]:
        if described["kind"] == "rows":
            for column, unit, values in _number_columns(field, messages):
                columns[column] = values
                if unit:
                    units[column] = unit
        elif field["name"] != "time":
            columns[field["name"]] = typed_column([text_of_value(one.get(field["name"])) for one in messages])
    return TopicTable(columns, units)


def _number_columns(
    field: Mapping[str, Any], messages: list[dict[str, Any]]
) -> Iterator[tuple[str, str, list[float]]]:
    """Name, unit and values of each column of a field; NaN where JSON has null, or nothing."""
    name, unit, _ = si_column(field["name"], field["unit"], ())
    values = [one.get(name) for one in messages]
    if field["count"] == 1:
        yield name, unit, [*map(_number, values)]
        return
    for place in range(field["count"]):
        yield f"{name}_{place}", unit, [math.nan if one is None else _number(one[place]) for one in values]


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
