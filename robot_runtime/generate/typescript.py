"""The page's types: rows with their layouts, documents as interfaces."""

import dataclasses
import json
import types
import typing
from enum import IntEnum, IntFlag

from robot_runtime.contract import documents
from robot_runtime.contract.commands import RobotCommand, http_commands, is_required
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
    """The whole text of topics.ts."""
    rows = [topic for topic in TOPICS if topic.kind is Kind.ROWS]
    others = [topic for topic in TOPICS if topic.kind is not Kind.ROWS]
    ids = "\n".join(f"  {topic.name}: {topic.id}," for topic in others)
    documents = {topic.name: topic.record for topic in TOPICS if topic.kind is Kind.DOCUMENTS}
    names = "\n".join(f"  {name}: {_name(record)};" for name, record in documents.items())
    parts = [
        _HEAD,
        *map(_enum, ENUMERATIONS),
        "export const ROW_TOPICS = {\n" + "\n".join(_row_topic(topic) for topic in rows) + "\n} as const;\n",
        *(_row_interface(topic) for topic in rows),
        "export interface Rows {\n" + "\n".join(f"  {t.name}: {_row_name(t)};" for t in rows) + "\n}\n",
        f"export const OTHER_TOPICS = {{\n{ids}\n}} as const;\n",
        *(_interface(cls) for cls in _documents()),
        f"export interface Documents {{\n{names}\n}}\n",
    ]
    return "\n".join(parts)


def commands_module() -> str:
    """The whole text of commands.ts."""
    parts = [
        "// Written by `make generate` from robot_runtime/contract/commands.py. Do not edit.\n"
        "import type { CalibrationValues, ColourRange } from './topics';\n",
        *(_command(cls) for cls in http_commands()),
        "/** The body of each command, by its name. */\nexport interface Commands {\n"
        + "".join(f"  {cls.policy.name}: {cls.__name__};\n" for cls in http_commands())
        + "}\n",
    ]
    return "\n".join(parts)


def _command(cls: type[RobotCommand]) -> str:
    hints = typing.get_type_hints(cls)
    lines = []
    for one in dataclasses.fields(cls):
        note = one.metadata.get("description", "")
        lines += [f"  /** {note} */"] if note else []
        lines.append(f"  {one.name}{'' if is_required(one) else '?'}: {_type(hints[one.name])};")
    if not lines:
        return f"/** {cls.__doc__} */\nexport type {cls.__name__} = Record<string, never>;\n"
    return f"/** {cls.__doc__} */\nexport interface {cls.__name__} {{\n" + "\n".join(lines) + "\n}\n"


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
    """The documents, and before each one the dataclasses that it has as fields."""
    found: dict[type, None] = {}

    def add(hint: typing.Any) -> None:
        for part in typing.get_args(hint):
            add(part)
        if dataclasses.is_dataclass(hint) and isinstance(hint, type) and hint not in found:
            for part in typing.get_type_hints(hint).values():
                add(part)
            found[hint] = None

    for topic in TOPICS:
        if topic.kind is Kind.DOCUMENTS:
            add(topic.record)
    return list(found)


def _interface(cls: type) -> str:
    hints = typing.get_type_hints(cls)
    lines = [f"  {field.name}: {_type(hints[field.name])};" for field in dataclasses.fields(cls)]
    return f"/** {cls.__doc__} */\nexport interface {_name(cls)} {{\n" + "\n".join(lines) + "\n}\n"


def _name(cls: type | None) -> str:
    # `Event` is the browser's own.
    return "RobotEvent" if cls is documents.Event else getattr(cls, "__name__", "")


def _type(hint: typing.Any) -> str:
    origin = typing.get_origin(hint)
    if origin is typing.Literal:
        return " | ".join(f"'{value}'" for value in typing.get_args(hint))
    if origin is types.UnionType:
        return " | ".join(dict.fromkeys(_type(part) for part in typing.get_args(hint)))
    if origin is list:
        return _array(typing.get_args(hint)[0])
    if origin is tuple:
        first, *others = typing.get_args(hint)
        return _array(first) if Ellipsis in others else f"[{', '.join(map(_type, [first, *others]))}]"
    if origin is dict:
        return f"Record<string, {_type(typing.get_args(hint)[1])}>"
    simple = {float: "number", int: "number", str: "string", bool: "boolean", types.NoneType: "null"}
    return simple.get(hint) or _name(hint)


def _array(hint: typing.Any) -> str:
    one = _type(hint)
    return f"({one})[]" if " | " in one else f"{one}[]"


def _quoted(text: str) -> str:
    return "'" + json.dumps(text, ensure_ascii=False)[1:-1].replace("'", "\\'") + "'"
