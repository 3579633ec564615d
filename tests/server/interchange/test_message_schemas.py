"""Messages of MCAP files and the Foxglove door, whatever they hold, are valid by their channels' schemas."""

import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import jsonschema_rs
import pytest
from mcap.reader import SeekingReader

from robot_runtime.contract.packets.layout import Wire
from robot_runtime.contract.topics import BY_NAME, TOPICS, AnyTopic, Kind
from robot_runtime.transport.blocks import Block, row
from server.features.doors.channels import HEALTH, Sample, encode_json, read_samples
from server.features.doors.foxglove_channels import foxglove_channels, schema_text
from server.features.exports.mcap_file import write_mcap
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.features.exports.recordings import record

DOCUMENTS = [topic for topic in TOPICS if topic.kind is Kind.DOCUMENTS]
ROWS = [topic for topic in TOPICS if topic.kind is Kind.ROWS]
FLOATS = "fd"


def examples(hint: Any) -> list[Any]:
    """Values of a type, as JSON holds them: of a union each kind, of an object all fields in all kinds."""
    origin, inner = get_origin(hint), get_args(hint)
    if hint in (NoneType, None):
        return [None]
    if origin in (Union, UnionType):
        return [value for schema in inner for value in examples(schema)]
    if origin is Literal:
        return [*inner]
    if origin is list:
        return [[], examples(inner[0])]
    if origin is tuple:
        several = [inner[0]] * 2 if inner[-1] is Ellipsis else inner
        return [[examples(schema)[0] for schema in several]]
    if (origin is not None and issubclass(origin, dict)) or getattr(origin, "__name__", "") == "Mapping":
        return [{}, {"one": examples(inner[1])[0]}]
    if is_dataclass(hint):
        return objects(hint)
    plain: dict[Any, list[Any]] = {
        float: [0.5, 3],
        int: [2],
        str: ["a"],
        bool: [True],
        object: [None, {"any": [1, None]}],
    }
    return plain[hint]


def objects(record: Any) -> list[dict[str, Any]]:
    hints = get_type_hints(record)
    names = [field.name for field in fields(record)]
    columns = [examples(hints[name]) for name in names]
    return [
        {name: column[position % len(column)] for name, column in zip(names, columns, strict=True)}
        for position in range(max(map(len, columns)))
    ]


def document_block(topic: AnyTopic) -> Block:
    documents = [
        document | {"time": 100.0 + index / 10} for index, document in enumerate(objects(topic.record))
    ]
    return Block.of(topic, len(documents), 0, json.dumps(documents).encode())


def rows_block(topic: AnyTopic) -> Block:
    """Return two rows: all numbers are there; every number that may be NaN is."""
    wires: dict[str, Wire] = topic.record.wires
    rows = b""
    for index, value in enumerate((1.0, float("nan"))):
        counts = [value if wire.code in FLOATS else 1 for wire in wires.values() for _ in range(wire.count)]
        rows += row(100.0 + index / 10, topic.record.layout.pack(*counts))
    return Block.of(topic, 2, 0, rows)


def block_of(topic: AnyTopic) -> Block:
    return rows_block(topic) if topic.kind is Kind.ROWS else document_block(topic)


def check(name: str, schema: dict[str, Any], message: Any) -> None:
    for problem in jsonschema_rs.validator_for(schema).iter_errors(message):
        pytest.fail(f"{name}: {problem.message} at {problem.instance_path} of {message}")


def test_every_message_of_a_file_is_valid_by_its_schema(
    store: Store, settings: Settings, tmp_path: Path
) -> None:
    recorded = [topic for topic in (*ROWS, *DOCUMENTS) if topic.recorded]
    session = record(store, settings, [block_of(topic) for topic in recorded])
    with (tmp_path / "dive.mcap").open("wb") as output:
        options = ExportOptions(format="mcap")
        write_mcap(store, ExportSelection(store, find_row(store, session), options), output)
    seen = set()
    with (tmp_path / "dive.mcap").open("rb") as file:
        for schema, channel, message in SeekingReader(file).iter_messages():
            assert schema is not None
            seen.add(channel.topic)
            check(channel.topic, json.loads(schema.data), json.loads(message.data))
    assert seen >= {f"/{topic.name}" for topic in recorded}


def samples_of(sources: tuple[str, ...]) -> list[Sample]:
    """Samples of these topics in order of time."""
    return sorted(_samples_of(sources), key=lambda sample: sample.time)


def _samples_of(sources: tuple[str, ...]) -> Iterator[Sample]:
    parts = [{"name": "runtime", "state": "ok", "text": "It runs."}]
    for source in sources:
        if source == HEALTH:
            yield Sample(HEALTH, 5, {"parts": parts})
        elif BY_NAME[source].kind is Kind.PICTURE:
            yield Sample(source, 5, b"jpeg")
        else:
            for time, value in read_samples(block_of(BY_NAME[source])):
                yield Sample(source, round(time * 1e9), value)


@pytest.mark.parametrize(
    "channel",
    [channel for channel in foxglove_channels(True) if not channel.hidden],
    ids=lambda item: item.name,
)
def test_every_live_message_is_valid_by_its_schema(channel: Any) -> None:
    schema, sent = json.loads(schema_text(channel)), 0
    for sample in samples_of(channel.sources):
        message = channel.convert(sample)
        if message is not None:
            sent += 1
            check(channel.name, schema, json.loads(encode_json(message)))
    assert sent


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/craft.craft.size[0]", "number"),
        ("/turning.set_point[2]", "number"),
        ("/state.loops[0].set_point", "number"),
        ("/detection.box.width", "number"),
        ("/detection.markers[0].corners[7]", "number"),
        ("/calibration.values.done[0]", "string"),
        ("/mission.deepest", "number"),
    ],
)
def test_foxglove_offers_a_path_for_a_plot(path: str, kind: str) -> None:
    name, *steps = path.split(".")
    (channel,) = (channel for channel in foxglove_channels(True) if channel.name == name)
    schema = json.loads(schema_text(channel))
    for step in steps:
        member, several, _ = step.partition("[")
        schema = schema["properties"][member]
        schema = schema["items"] if several else schema
    assert schema["type"] == kind


def test_a_number_that_is_nan_is_left_out_of_a_row_and_null_in_an_array() -> None:
    (channel,) = (channel for channel in foxglove_channels(True) if channel.name == "/turning")
    _, last = samples_of(channel.sources)
    assert json.loads(encode_json(channel.convert(last)))["set_point"] == [None, None, None]
    (channel,) = (channel for channel in foxglove_channels(True) if channel.name == "/control")
    first, last = samples_of(channel.sources)
    whole, nothing = channel.convert(first), channel.convert(last)
    assert whole is not None
    assert whole["depth"] == 1.0
    assert nothing == {}


@pytest.mark.parametrize("topic", DOCUMENTS, ids=lambda item: item.name)
def test_the_examples_of_a_document_hold_every_field(topic: AnyTopic) -> None:
    (first, *_) = objects(topic.record)
    assert {"time"} < first.keys()
