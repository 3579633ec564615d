"""Turns tables, as TOML and JSON have them, into typed and checked values."""

import math
import types
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from reprlib import Repr
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.problems import DocumentEntry, EntryProblem

T = TypeVar("T")
TOP = DocumentEntry()


def parse(cls: type[T], table: Mapping[str, Any], where: DocumentEntry = TOP) -> T:
    """A dataclass from the table at `where`.

    Raises ConfigError with all problems: names that are unknown or missing, wrong types, numbers out of
    range, and what the dataclass itself refuses with a ValueError.
    """
    hints = _hints(cls)  # type: ignore[arg-type]
    known = {one.name: one for one in fields(cls)}  # type: ignore[arg-type]
    problems = [
        where.field(name, repr(name)).problem(f"is not known here; known are {', '.join(known)}")
        for name in table
        if name not in known
    ]
    problems += [
        where.field(name).problem("is missing")
        for name, one in known.items()
        if name not in table and one.default is MISSING and one.default_factory is MISSING
    ]
    given = [name for name in table if name in known]
    values = _values(((hints[name], table[name], where.field(name)) for name in given), problems)
    try:
        return cls(**dict(zip(given, values, strict=True)))
    except ConfigError as problem:
        raise ConfigError(*(one.within(where) for one in problem.problems)) from problem
    except ValueError as problem:
        raise ConfigError(where.sentence(str(problem))) from problem


_WORDS = {
    float: "a number",
    int: "a whole number",
    str: "a text",
    bool: "true or false",
    list: "a list",
    tuple: "a list",
    dict: "a table",
}


@cache
def _hints(cls: type) -> Mapping[str, Any]:
    return get_type_hints(cls, include_extras=True)


def _values(
    parts: Iterable[tuple[Any, Any, DocumentEntry]], problems: Iterable[EntryProblem] = ()
) -> list[Any]:
    """The value of each (hint, value, where). Raises ConfigError with these problems and their own."""
    values, found = [], list(problems)
    for hint, value, where in parts:
        try:
            values.append(read_value(hint, value, where))
        except ConfigError as problem:
            found += problem.problems
    if found:
        raise ConfigError(*found)
    return values


def read_value(hint: Any, value: Any, where: DocumentEntry) -> Any:
    """The value as its type hint wants it. Raises ConfigError with all problems."""
    if get_origin(hint) is Annotated:
        inner, limits = get_args(hint)
        number = read_value(inner, value, where)
        if number is not None and not limits.minimum <= number <= limits.maximum:
            span = f"between {limits.minimum:.10g} and {limits.maximum:.10g}"
            raise ConfigError(where.problem(f"is {_shown(value)}; it must lie {span}"))
        return number
    if is_dataclass(hint) and isinstance(hint, type):
        if not isinstance(value, dict):
            raise ConfigError(where.problem("must be a table"))
        return parse(hint, value, where)
    if get_origin(hint) is Literal:
        if value not in get_args(hint):
            known = ", ".join(map(repr, get_args(hint)))
            raise ConfigError(where.problem(f"is {_shown(value)}; it must be one of {known}"))
        return value
    if get_origin(hint) in (types.UnionType, Union):
        return _read_union(get_args(hint), value, where)
    return _plain(hint, value, where)


def _read_union(hints: tuple[Any, ...], value: Any, where: DocumentEntry) -> Any:
    if value is None and types.NoneType in hints:
        return None
    kinds = [one for one in hints if one is not types.NoneType]
    if len(kinds) == 1:
        return read_value(kinds[0], value, where)
    for kind in kinds:
        try:
            return read_value(kind, value, where)
        except ConfigError:
            continue
    known = " or ".join(_WORDS[kind] for kind in kinds)
    raise ConfigError(where.problem(f"is {_shown(value)}; it must be {known}"))


def _plain(hint: Any, value: Any, where: DocumentEntry) -> Any:
    origin, inner = get_origin(hint), get_args(hint)
    if origin is list and isinstance(value, list):
        return _values((inner[0], one, where.item(index)) for index, one in enumerate(value))
    if origin is tuple and isinstance(value, list):
        hints = (inner[0],) * len(value) if inner[-1] is Ellipsis else inner
        if len(hints) != len(value):
            raise ConfigError(where.problem(f"is {_shown(value)}; it must be a list of {len(hints)} numbers"))
        entries = enumerate(zip(hints, value, strict=True))
        return tuple(_values((hint, one, where.item(index)) for index, (hint, one) in entries))
    if origin is dict and isinstance(value, dict):
        return dict(
            zip(value, _values((inner[1], one, where.key(name)) for name, one in value.items()), strict=True)
        )
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool) and _finite(value):
        return float(value)
    if isinstance(hint, type) and type(value) is hint and hint is not float:
        return value
    raise ConfigError(where.problem(f"is {_shown(value)}; it must be {_WORDS[origin or hint]}"))


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        # A whole number that no float can hold.
        return False


def _shown(value: Any) -> str:
    """The value in an error message; one from outside may have thousands of digits or letters."""
    short = Repr()
    short.maxdict = short.maxlist = short.maxtuple = 20
    short.maxstring = short.maxother = 200
    return short.repr(value)
