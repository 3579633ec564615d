"""Turns tables, as TOML and JSON have them, into typed and checked values."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from reprlib import Repr
from typing import Any, TypeVar

from robot_runtime.contract.hints import Form, Hint, read_fields, read_hint
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.problems import DocumentEntry, EntryProblem

T = TypeVar("T")
TOP = DocumentEntry()


def parse(cls: type[T], table: Mapping[str, Any], where: DocumentEntry = TOP) -> T:
    """Return a dataclass from the table at `where`.

    Raise ConfigError with all problems: names that are unknown or missing, wrong types, numbers out of
    range, and what the dataclass itself refuses with a ValueError.
    """
    hints = read_fields(cls)
    known = {field.name: field for field in fields(cls)}  # type: ignore[arg-type]
    problems = [
        where.field(name, repr(name)).problem(f"is not known here; known are {', '.join(known)}")
        for name in table
        if name not in known
    ]
    problems += [
        where.field(name).problem("is missing")
        for name, field in known.items()
        if name not in table and field.default is MISSING and field.default_factory is MISSING
    ]
    given = [name for name in table if name in known]
    values = _values(((hints[name], table[name], where.field(name)) for name in given), problems)
    try:
        return cls(**dict(zip(given, values, strict=True)))
    except ConfigError as problem:
        raise ConfigError(*(problem.within(where) for problem in problem.problems)) from problem
    except ValueError as problem:
        raise ConfigError(where.sentence(str(problem))) from problem


_WORDS: Mapping[Form, str] = {
    "number": "a number",
    "whole number": "a whole number",
    "text": "a text",
    "switch": "true or false",
    "list": "a list",
    "tuple": "a list",
    "table": "a table",
}


def _values(
    parts: Iterable[tuple[Hint, Any, DocumentEntry]], problems: Iterable[EntryProblem] = ()
) -> list[Any]:
    """Return the value of each (hint, value, where).

    Raise ConfigError with these problems and those of the values.
    """
    values, collected = [], list(problems)
    for hint, value, where in parts:
        try:
            values.append(_read(hint, value, where))
        except ConfigError as problem:
            collected += problem.problems
    if collected:
        raise ConfigError(*collected)
    return values


def read_value(hint: Any, value: Any, where: DocumentEntry) -> Any:
    """Return the value in the type of its hint. Raise ConfigError with all problems."""
    return _read(read_hint(hint), value, where)


def _read(hint: Hint, value: Any, where: DocumentEntry) -> Any:
    result = _read_union(hint, value, where) if hint.form == "union" else _read_one(hint, value, where)
    limits = hint.limits
    if limits is not None and result is not None and not limits.minimum <= result <= limits.maximum:
        span = f"between {limits.minimum:.10g} and {limits.maximum:.10g}"
        raise ConfigError(where.problem(f"is {_shown(value)}; it must lie {span}"))
    return result


def _read_union(hint: Hint, value: Any, where: DocumentEntry) -> Any:
    if value is None and hint.optional:
        return None
    if len(hint.members) == 1:
        return _read(hint.members[0], value, where)
    for member in hint.members:
        try:
            return _read(member, value, where)
        except ConfigError:
            continue
    known = " or ".join(_WORDS[member.form] for member in hint.members)
    raise ConfigError(where.problem(f"is {_shown(value)}; it must be {known}"))


def _read_one(hint: Hint, value: Any, where: DocumentEntry) -> Any:
    parts = hint.parts
    match hint.form, value:
        case "object", dict():
            return parse(hint.cls, value, where)
        case "object", _:
            raise ConfigError(where.problem("must be a table"))
        case "choice", _:
            if value in hint.choices:
                return value
            known = ", ".join(map(repr, hint.choices))
            raise ConfigError(where.problem(f"is {_shown(value)}; it must be one of {known}"))
        case "list", list():
            return hint.cls(_values((parts[0], item, where.item(index)) for index, item in enumerate(value)))
        case "tuple", list():
            if len(parts) != len(value):
                text = f"is {_shown(value)}; it must be a list of {len(parts)} numbers"
                raise ConfigError(where.problem(text))
            entries = enumerate(zip(parts, value, strict=True))
            return tuple(_values((part, item, where.item(index)) for index, (part, item) in entries))
        case "table", dict():
            values = _values((parts[0], item, where.key(name)) for name, item in value.items())
            return dict(zip(value, values, strict=True))
        case "number", int() | float() if not isinstance(value, bool) and _finite(value):
            return float(value)
        case "whole number" | "text" | "switch", _ if type(value) is hint.cls:
            return value
    raise ConfigError(where.problem(f"is {_shown(value)}; it must be {_WORDS[hint.form]}"))


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        # A whole number that no float can hold.
        return False


def _shown(value: Any) -> str:
    """Return the value for an error message, shortened: it may have thousands of digits or letters."""
    short = Repr()
    short.maxdict = short.maxlist = short.maxtuple = 20
    short.maxstring = short.maxother = 200
    return short.repr(value)
