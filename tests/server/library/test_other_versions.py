"""Samples of every topic pass unchanged through what rewrites those of other versions."""

import json
from dataclasses import fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import pytest

from robot_runtime.contract.chunks import describe_topics
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import RECORDED, AnyTopic, Kind
from server.library.upgrade import rewrite_document, rewrite_rows

ROWS = [topic for topic in RECORDED if topic.kind is Kind.ROWS]
DOCUMENTS = [topic for topic in RECORDED if topic.kind is Kind.DOCUMENTS]


def list_values(hint: Any) -> list[Any]:
    """Return one value of each alternative of a type, as JSON has it."""
    kind, arguments = get_origin(hint), get_args(hint)
    if is_dataclass(hint):
        return list_documents(hint)
    if kind in (Union, UnionType):
        return [value for argument in arguments for value in list_values(argument)]
    if kind is Literal:
        return list(arguments)
    if kind is list:
        return [[], list_values(arguments[0])]
    if kind is tuple:
        return [[list_values(argument)[0] for argument in arguments if argument is not Ellipsis]]
    if kind is dict:
        return [{}, {f"key {index}": value for index, value in enumerate(list_values(arguments[1]))}]
    plain: dict[Any, list[Any]] = {
        float: [1.5, 2],
        int: [3],
        str: ["text", ""],
        bool: [True, False],
        NoneType: [None],
    }
    return plain[hint]


def list_documents(record: Any) -> list[dict[str, Any]]:
    """Documents of a record that together have each alternative of each field."""
    hints = get_type_hints(record)
    columns = {field.name: list_values(hints[field.name]) for field in fields(record)}
    return [
        {name: values[position % len(values)] for name, values in columns.items()}
        for position in range(max(map(len, columns.values())))
    ]


@pytest.mark.parametrize("topic", DOCUMENTS, ids=lambda topic: topic.name)
def test_documents_of_equal_definitions_pass_unchanged(topic: AnyTopic) -> None:
    for document in list_documents(topic.record):
        assert json.dumps(rewrite_document(document, topic)) == json.dumps(document)


@pytest.mark.parametrize("topic", ROWS, ids=lambda topic: topic.name)
def test_rows_of_equal_definitions_pass_unchanged(topic: AnyTopic) -> None:
    assert issubclass(topic.record, Record)
    described = describe_topics()[topic.name]
    # The float 0x3F3F3F3F is a number, and so are its bytes in any other field.
    rows = b"\x3f" * (3 * topic.row_bytes)
    if any(wire.code == "?" for wire in topic.record.wires.values()):
        rows = b"\x01" * len(rows)
    assert rewrite_rows(rows, described, topic) == rows
