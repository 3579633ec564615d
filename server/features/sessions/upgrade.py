"""Rewrites samples of other definitions to those of this version, field by field.

A document that lacks a required number is left out. In rows, which cannot express "unknown", it is 0.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import MISSING, asdict, dataclass, fields, is_dataclass
from functools import cache
from math import copysign, inf, isnan
from struct import Struct, calcsize
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import TIME, AnyTopic

FLOAT_MAX = 3.4028235e38
"""The largest number of four bytes."""


class NoCounterpartError(ValueError):
    """A document that this version cannot express."""


class MissingFieldError(NoCounterpartError):
    """A document without a field that this version needs, as an older version may have written it."""


def rewrite_rows(rows: bytes, recorded: Mapping[str, Any], topic: AnyTopic) -> bytes:
    """The rows as this version's `topic` has them; `recorded` is what `chunks.describe_topics` said of them.

    Fields go by name, values by scale, rounded to what the field can hold. A field that was not there, or had
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
    for place in range(TIME.size):
        new[place::new_size] = rows[place::old_size]
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
    """A number in a row: its bytes begin at `offset`; times `scale` it is in its unit."""

    name: tuple[str, int]
    code: str
    scale: float
    unit: str
    offset: int


def _columns(fields_of_rows: Iterable[Mapping[str, Any]]) -> Iterator[_Column]:
    offset = TIME.size
    for field in fields_of_rows:
        for place in range(field["count"]):
            yield _Column((field["name"], place), field["code"], field["scale"], field["unit"], offset)
            offset += calcsize(f"<{field['code']}")


def _row_bytes(columns: Iterable[_Column]) -> int:
    return max((one.offset + calcsize(f"<{one.code}") for one in columns), default=TIME.size)


def _convert(
    rows: bytes, old_size: int, old: _Column, new: bytearray, new_size: int, column: _Column
) -> None:
    """Write a column of other type or scale, number by number."""
    one, packed = Struct(f"<{old.code}"), Struct(f"<{column.code}")
    ratio, whole = old.scale / column.scale, column.code not in "fd"
    most, lowest = (1 << 8 * packed.size) - 1, 0
    if column.code.islower():
        most, lowest = most >> 1, -(most >> 1) - 1
    for place in range(len(rows) // old_size):
        value = one.unpack_from(rows, place * old_size + old.offset)[0] * ratio
        if whole:
            value = 0 if isnan(value) else round(min(max(value, lowest), most))
        elif column.code == "f" and abs(value) > FLOAT_MAX:
            value = copysign(inf, value)
        packed.pack_into(new, place * new_size + column.offset, value)


def rewrite_document(document: Mapping[str, Any], topic: AnyTopic) -> dict[str, Any]:
    """The document as this version's `topic` has it: fields unknown now are dropped, missing ones get their
    default; without one None, an empty list or an empty text where that is allowed.

    Raises NoCounterpartError where a field is missing that has no such thing, or holds what is not allowed
    now.
    """
    made = _rewrite(document, topic.record)
    assert isinstance(made, dict)
    return made


def _rewrite(value: Any, target: Any) -> Any:
    if is_dataclass(target):
        return _rewrite_object(value, target)
    kind, arguments = get_origin(target), get_args(target)
    if kind in (Union, UnionType):
        return _rewrite_union(value, arguments)
    if kind is list and isinstance(value, list):
        return [_rewrite(one, arguments[0]) for one in value]
    if kind is tuple and isinstance(value, list):
        hints = arguments[:1] * len(value) if Ellipsis in arguments else arguments
        if len(hints) == len(value):
            return [_rewrite(one, hint) for one, hint in zip(value, hints, strict=True)]
    if kind is dict and isinstance(value, dict):
        return {name: _rewrite(one, arguments[1]) for name, one in value.items()}
    if kind is Literal and value in arguments:
        return value
    if target is float and isinstance(value, int | float) and not isinstance(value, bool):
        return value
    if target in (int, str, bool, NoneType) and type(value) is target:
        return value
    raise NoCounterpartError(f"{value!r} is no {target}")


def _rewrite_union(value: Any, members: tuple[Any, ...]) -> Any:
    problem: NoCounterpartError | None = None
    for one in members:
        try:
            return _rewrite(value, one)
        except NoCounterpartError as found:
            # Of `x | None` the first says what is wrong with a value.
            problem = problem or found
    raise problem or NoCounterpartError(f"{value!r} is of no kind")


def _rewrite_object(value: Any, target: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise NoCounterpartError(f"{value!r} is no {target.__name__}")
    return {
        name: _rewrite(value[name], hint) if name in value else _stand_in(target, name, hint)
        for name, hint in _hints(target).items()
    }


def _stand_in(owner: Any, name: str, hint: Any) -> Any:
    field = next(one for one in fields(owner) if one.name == name)
    if field.default is not MISSING:
        return field.default
    if field.default_factory is not MISSING:
        return field.default_factory()
    if get_origin(hint) in (Union, UnionType) and NoneType in get_args(hint):
        return None
    if get_origin(hint) is list:
        return []
    if hint is str:
        return ""
    raise MissingFieldError(f"{name} is missing")


@cache
def _hints(owner: Any) -> dict[str, Any]:
    hints = get_type_hints(owner)
    return {field.name: hints[field.name] for field in fields(owner)}
