"""The rewriting of samples of other definitions to this version's, field by field.

A document that lacks a required number is left out. In rows, which cannot express "unknown", it is 0.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from math import copysign, inf, isnan
from struct import Struct, calcsize
from typing import Any

from robot_runtime.contract.hints import Form, Hint, read_fields, read_hint
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import TIME, AnyTopic

FLOAT_MAX = 3.4028235e38
"""The largest number of four bytes."""


class NoCounterpartError(ValueError):
    """A document that this version cannot express."""


class MissingFieldError(NoCounterpartError):
    """A document without a field that this version needs, as an older version may have written it."""


def rewrite_rows(rows: bytes, recorded: Mapping[str, Any], topic: AnyTopic) -> bytes:
    """Return the rows in the layout of this version's `topic`; `recorded` is their topic's description.

    Fields go by name, values by scale, rounded to the field's type. A field that was not there, or had
    another unit, is 0. Columns that are the same are copied whole, without NumPy: it costs a small computer
    memory, and its libraries may end the process.
    """
    assert issubclass(topic.record, Record)
    then = {column.name: column for column in _columns(recorded["fields"])}
    old_size, new_size = _row_bytes(then.values()), topic.row_bytes
    count, rest = divmod(len(rows), old_size)
    if rest:
        raise ValueError(f"{len(rows)} bytes are not whole rows of {old_size}")
    new = bytearray(count * new_size)
    for index in range(TIME.size):
        new[index::new_size] = rows[index::old_size]
    for column in _columns([{"name": name, **asdict(wire)} for name, wire in topic.record.wires.items()]):
        old = then.get(column.name)
        if old is None or old.unit != column.unit:
            continue
        if (old.code, old.scale) == (column.code, column.scale):
            for byte in range(calcsize(f"<{column.code}")):
                new[column.offset + byte :: new_size] = rows[old.offset + byte :: old_size]
        else:
            _convert(rows, old_size, old, new, new_size, column)
    return bytes(new)


@dataclass(frozen=True, slots=True)
class _Column:
    """A number in a row: its bytes begin at `offset`; multiplied by `scale` it is in its unit."""

    name: tuple[str, int]
    code: str
    scale: float
    unit: str
    offset: int


def _columns(fields_of_rows: Iterable[Mapping[str, Any]]) -> Iterator[_Column]:
    offset = TIME.size
    for field in fields_of_rows:
        for index in range(field["count"]):
            yield _Column((field["name"], index), field["code"], field["scale"], field["unit"], offset)
            offset += calcsize(f"<{field['code']}")


def _row_bytes(columns: Iterable[_Column]) -> int:
    return max((column.offset + calcsize(f"<{column.code}") for column in columns), default=TIME.size)


def _convert(
    rows: bytes, old_size: int, old: _Column, new: bytearray, new_size: int, column: _Column
) -> None:
    """Write a column of other type or scale, number by number."""
    source, packed = Struct(f"<{old.code}"), Struct(f"<{column.code}")
    ratio, whole = old.scale / column.scale, column.code not in "fd"
    most, lowest = (1 << 8 * packed.size) - 1, 0
    if column.code.islower():
        most, lowest = most >> 1, -(most >> 1) - 1
    for index in range(len(rows) // old_size):
        value = source.unpack_from(rows, index * old_size + old.offset)[0] * ratio
        if whole:
            value = 0 if isnan(value) else round(min(max(value, lowest), most))
        elif column.code == "f" and abs(value) > FLOAT_MAX:
            value = copysign(inf, value)
        packed.pack_into(new, index * new_size + column.offset, value)


def rewrite_document(document: Mapping[str, Any], topic: AnyTopic) -> dict[str, Any]:
    """Return the document as this version's `topic` has it: fields unknown now are dropped, missing ones get
    their default; without one None, an empty list or an empty text where that is allowed.

    Raise NoCounterpartError where a field is missing that has no such thing, or holds what is not allowed
    now.
    """
    made = _rewrite(document, read_hint(topic.record))
    assert isinstance(made, dict)
    return made


def _rewrite(value: Any, hint: Hint) -> Any:
    # A dive has a million values: the forms are told apart by a table.
    return _REWRITERS[hint.form](value, hint)


def _rewrite_list(value: Any, hint: Hint) -> Any:
    if not isinstance(value, list):
        raise _refuse(value, hint)
    part = hint.parts[0]
    rewrite = _REWRITERS[part.form]
    return [rewrite(item, part) for item in value]


def _rewrite_tuple(value: Any, hint: Hint) -> Any:
    if not isinstance(value, list) or len(hint.parts) != len(value):
        raise _refuse(value, hint)
    return [_rewrite(item, part) for item, part in zip(value, hint.parts, strict=True)]


def _rewrite_table(value: Any, hint: Hint) -> Any:
    if not isinstance(value, dict):
        raise _refuse(value, hint)
    return {name: _rewrite(item, hint.parts[0]) for name, item in value.items()}


def _rewrite_choice(value: Any, hint: Hint) -> Any:
    if value not in hint.choices:
        raise _refuse(value, hint)
    return value


def _rewrite_number(value: Any, hint: Hint) -> Any:
    if type(value) is not float and type(value) is not int:
        raise _refuse(value, hint)
    return value


def _rewrite_exactly(value: Any, hint: Hint) -> Any:
    if type(value) is not hint.cls:
        raise _refuse(value, hint)
    return value


def _refuse_all(value: Any, hint: Hint) -> Any:
    raise _refuse(value, hint)


def _refuse(value: Any, hint: Hint) -> NoCounterpartError:
    return NoCounterpartError(f"{value!r} is no {hint.form}")


def _rewrite_union(value: Any, hint: Hint) -> Any:
    problem: NoCounterpartError | None = None
    for member in hint.parts:
        try:
            return _rewrite(value, member)
        except NoCounterpartError as refusal:
            # Of `x | None` the first says what is wrong with a value.
            problem = problem or refusal
    raise problem or NoCounterpartError(f"{value!r} is of no kind")


def _rewrite_object(value: Any, hint: Hint) -> dict[str, Any]:
    target: Any = hint.cls
    if not isinstance(value, Mapping):
        raise NoCounterpartError(f"{value!r} is no {target.__name__}")
    return {
        name: _rewrite(value[name], field) if name in value else _stand_in(target, name, field)
        for name, field in read_fields(target).items()
    }


def _stand_in(owner: Any, name: str, hint: Hint) -> Any:
    field = next(entry for entry in fields(owner) if entry.name == name)
    if field.default is not MISSING:
        return field.default
    if field.default_factory is not MISSING:
        return field.default_factory()
    if hint.optional:
        return None
    if hint.form == "list":
        return []
    if hint.form == "text":
        return ""
    raise MissingFieldError(f"{name} is missing")


_REWRITERS: dict[Form, Callable[[Any, Hint], Any]] = {
    "object": _rewrite_object,
    "union": _rewrite_union,
    "list": _rewrite_list,
    "tuple": _rewrite_tuple,
    "table": _rewrite_table,
    "choice": _rewrite_choice,
    "number": _rewrite_number,
    "whole number": _rewrite_exactly,
    "text": _rewrite_exactly,
    "switch": _rewrite_exactly,
    "nothing": _rewrite_exactly,
    "class": _refuse_all,
}
