"""The page's types: rows with their layouts, documents as interfaces."""

import json
import typing
from collections.abc import Mapping
from enum import IntEnum, IntFlag

from robot_runtime.contract import documents
from robot_runtime.contract.hints import Form, Hint, read_fields, read_hint
from robot_runtime.contract.packets import DEFINITIONS_HASH, ENUMERATIONS
from robot_runtime.contract.packets.layout import Record, Wire
from robot_runtime.contract.topics import TIME, TOPICS, AnyTopic, Kind

_HEAD = f"""\
// Written by `make generate` from robot_runtime/contract/topics.py and what it names. Do not edit.

/** What the page was built for; the server says its own, and the page asks for a reload where they differ. */
export const DEFINITIONS_HASH = '{DEFINITIONS_HASH:08x}';

export type Code = 'b' | 'B' | 'h' | 'H' | 'i' | 'I' | 'f' | 'd';

/** One field of a row: `offset` counts from the row's first byte; the first eight are the time (f64, s). */
export interface Field {{
  readonly name: string;
  readonly code: Code;
  readonly offset: number;
  readonly count: number;
  readonly scale: number;
  readonly unit: string;
  readonly meaning: string;
}}

export interface RowTopic {{
  readonly id: number;
  readonly name: string;
  readonly rowBytes: number;
  readonly meaning: string;
  readonly fields: readonly Field[];
}}
"""


def module() -> str:
    """Return the whole text of topics.ts."""
    rows = [topic for topic in TOPICS if topic.kind is Kind.ROWS]
    documents = {topic.name: topic.record for topic in TOPICS if topic.kind is Kind.DOCUMENTS}
    names = "\n".join(f"  {name}: {_name(record)};" for name, record in documents.items())
    parts = [
        _HEAD,
        *map(_enum, ENUMERATIONS),
        "export const ROW_TOPICS = {\n" + "\n".join(_row_topic(topic) for topic in rows) + "\n} as const;\n",
        *(_row_interface(topic) for topic in rows),
        "export interface Rows {\n" + "\n".join(f"  {t.name}: {_row_name(t)};" for t in rows) + "\n}\n",
        _numbers("DOCUMENT_TOPICS", Kind.DOCUMENTS),
        _numbers("PICTURE_TOPICS", Kind.PICTURE),
        *(_interface(cls) for cls in _documents()),
        f"export interface Documents {{\n{names}\n}}\n",
    ]
    return "\n".join(parts)


def _numbers(name: str, kind: Kind) -> str:
    members = "\n".join(f"  {topic.name}: {topic.id}," for topic in TOPICS if topic.kind is kind)
    return f"export const {name} = {{\n{members}\n}} as const;\n"


def _enum(enum: type[IntEnum] | type[IntFlag]) -> str:
    members = "\n".join(f"  {member.name}: {member.value}," for member in enum)
    return f"export const {enum.__name__} = {{\n{members}\n}} as const;\n"


def _row_topic(topic: AnyTopic) -> str:
    record = typing.cast("type[Record]", topic.record)
    offset = TIME.size
    fields: list[str] = []
    for name, wire in record.wires.items():
        # The row's own time replaces the board's clock, which stays in the bytes unused.
        shown = "board_time" if name == "time" else name
        fields.append(f"      {_field(shown, wire, offset)},")
        offset += wire.size
    head = f"    id: {topic.id},\n    name: '{topic.name}',\n    rowBytes: {topic.row_bytes},\n"
    head += f"    meaning: {_quoted(topic.meaning)},\n"
    return f"  {topic.name}: {{\n{head}    fields: [\n" + "\n".join(fields) + "\n    ],\n  },"


def _field(name: str, wire: Wire, offset: int) -> str:
    entries = {
        "name": _quoted(name),
        "code": f"'{wire.code}'",
        "offset": offset,
        "count": wire.count,
        "scale": repr(wire.scale),
        "unit": _quoted(wire.unit),
        "meaning": _quoted(wire.meaning),
    }
    return "{ " + ", ".join(f"{key}: {value}" for key, value in entries.items()) + " }"


def _row_interface(topic: AnyTopic) -> str:
    record = typing.cast("type[Record]", topic.record)
    lines = ["  /** s, steady clock of the robot's computer */", "  time: number;"]
    for name, wire in record.wires.items():
        note = ", ".join(part for part in (wire.unit, wire.meaning) if part)
        lines += [f"  /** {note} */"] if note else []
        lines.append(
            f"  {'board_time' if name == 'time' else name}: {'number[]' if wire.count > 1 else 'number'};"
        )
    return f"export interface {_row_name(topic)} {{\n" + "\n".join(lines) + "\n}\n"


def _row_name(topic: AnyTopic) -> str:
    return f"{topic.name.capitalize()}Row"


def _documents() -> list[type]:
    """Return the documents, and before each one the dataclasses that it has as fields."""
    ordered: dict[type, None] = {}

    def add(hint: Hint) -> None:
        for part in hint.parts:
            add(part)
        if hint.form == "object" and hint.cls not in ordered:
            for part in read_fields(hint.cls).values():
                add(part)
            ordered[hint.cls] = None

    for topic in TOPICS:
        if topic.kind is Kind.DOCUMENTS:
            add(read_hint(topic.record))
    return list(ordered)


def _interface(cls: type) -> str:
    lines = [f"  {name}: {_type(hint)};" for name, hint in read_fields(cls).items()]
    return f"/** {cls.__doc__} */\nexport interface {_name(cls)} {{\n" + "\n".join(lines) + "\n}\n"


def _name(cls: type | None) -> str:
    # `Event` is the browser's own.
    return "RobotEvent" if cls is documents.Event else getattr(cls, "__name__", "")


PLAIN_TYPES: Mapping[Form, str] = {
    "number": "number",
    "whole number": "number",
    "text": "string",
    "switch": "boolean",
    "nothing": "null",
}


def _type(hint: Hint) -> str:
    match hint.form:
        case "choice":
            return " | ".join(
                f"'{value}'" if isinstance(value, str) else f"{value}" for value in hint.choices
            )
        case "union":
            return " | ".join(dict.fromkeys(map(_type, hint.parts)))
        case "list":
            entry = _type(hint.parts[0])
            return f"({entry})[]" if " | " in entry else f"{entry}[]"
        case "tuple":
            return f"[{', '.join(map(_type, hint.parts))}]"
        case "table":
            return f"Record<string, {_type(hint.parts[0])}>"
    return PLAIN_TYPES.get(hint.form) or _name(hint.cls)


def _quoted(text: str) -> str:
    return "'" + json.dumps(text, ensure_ascii=False)[1:-1].replace("'", "\\'") + "'"
