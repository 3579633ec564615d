"""Rewrites samples of other definitions to those of this version, field by field.

A document that lacks a required number is left out. In rows, which cannot express "unknown", it is 0.
"""

from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import Topic


class NoCounterpartError(ValueError):
    """A document that this version cannot express."""


class MissingFieldError(NoCounterpartError):
    """A document without a field that this version needs, as an older version may have written it."""


def rewrite_rows(rows: bytes, recorded: Mapping[str, Any], topic: Topic) -> bytes:
    """The rows as this version's `topic` has them; `recorded` is what `chunks.describe_topics` said of them.

    Fields go by name, values by scale, rounded to what the field can hold. A field that was not there, or had
    another unit, is 0.
    """
    import numpy as np  # only where definitions differ: it costs a small computer memory

    assert topic.record is not None
    assert issubclass(topic.record, Record)
    wires = topic.record.wires
    then = {field["name"]: field for field in recorded["fields"]}
    # Struct's codes mean the same to NumPy. Several records have a field of their own named time.
    old_fields = [(f"field {name}", "<" + field["code"], (field["count"],)) for name, field in then.items()]
    new_fields = [(f"field {name}", "<" + wire.code, (wire.count,)) for name, wire in wires.items()]
    old = np.frombuffer(rows, np.dtype([("time", "<f8"), *old_fields]))
    new = np.zeros(len(old), np.dtype([("time", "<f8"), *new_fields]))
    new["time"] = old["time"]
    for name, wire in wires.items():
        field = then.get(name)
        if field is None or field["unit"] != wire.unit:
            continue
        shared = min(field["count"], wire.count)
        values = old[f"field {name}"][:, :shared].astype(np.float64) * (field["scale"] / wire.scale)
        if wire.code not in "fd":
            limits = np.iinfo(new[f"field {name}"].dtype)
            values = np.clip(np.round(np.nan_to_num(values)), limits.min, limits.max)
        new[f"field {name}"][:, :shared] = values
    return new.tobytes()


def rewrite_document(document: Mapping[str, Any], topic: Topic) -> dict[str, Any]:
    """The document as this version's `topic` has it: fields unknown now are dropped, missing ones get their
    default; without one None, an empty list or an empty text where that is allowed.

    Raises NoCounterpartError where a field is missing that has no such thing, or holds what is not allowed
    now.
    """
    assert topic.record is not None
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
