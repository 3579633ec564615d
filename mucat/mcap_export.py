"""Reads the exports of `mucat export --format mcap`; needs the package mcap."""

import json
import math
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from mucat.errors import RobotError
from mucat.tables import SessionTables, TopicTable, text_of_value, typed_column
from robot_runtime.contract.chunks import si_fields

MAGIC = b"\x89MCAP0\r\n"
OWN = "mucat."
"""The beginning of our own schemas' names."""


def read_mcap(path: Path) -> SessionTables:
    """Return the tables of a file. Raise RobotError."""
    try:
        from mcap.exceptions import McapError
        from mcap.reader import make_reader
    except ImportError as problem:
        raise RobotError("MCAP files need the package mcap: pip install mcap") from problem
    try:
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            summary = reader.get_summary()
            described = [
                attachment.data
                for attachment in reader.iter_attachments()
                if attachment.name == "session.json"
            ]
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
    columns: dict[str, Sequence[Any]] = {"time": [message["time"] for message in messages], "utc": utc}
    units = {"time": "s"}
    if described["kind"] == "rows":
        for field in si_fields(described):
            values = [message.get(field.name) for message in messages]
            for index, column in enumerate(field.columns):
                numbers = values if field.count == 1 else [value and value[index] for value in values]
                columns[column] = [*map(_number, numbers)]
                if field.unit:
                    units[column] = field.unit
        return TopicTable(columns, units)
    for name in (field["name"] for field in described["fields"] if field["name"] != "time"):
        columns[name] = typed_column([text_of_value(message.get(name)) for message in messages])
    return TopicTable(columns, units)


def _number(value: float | None) -> float:
    """Return a number; NaN where JSON has null, or nothing."""
    return math.nan if value is None else float(value)
