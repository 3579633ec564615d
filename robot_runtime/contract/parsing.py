"""Turns tables, as TOML and JSON have them, into typed and checked values."""

import math
import types
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from reprlib import Repr
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.limits import ConfigError

T = TypeVar("T")


def parse(cls: type[T], table: Mapping[str, Any], where: str = "") -> T:
    """A dataclass from a table; `where` is put before each problem.

    Raises ConfigError with all problems: names that are unknown or missing, wrong types, numbers out of
    range, and what the dataclass itself refuses with a ValueError.
    """
    hints = get_type_hints(cls, include_extras=True)
    known = {one.name: one for one in fields(cls)}  # type: ignore[arg-type]
    problems = [
        f"{place(where, repr(name))} is not known here; known are {', '.join(known)}"
        for name in table
        if name not in known
    ]
    problems += [
        f"{place(where, name)} is missing"
        for name, one in known.items()
        if name not in table and one.default is MISSING and one.default_factory is MISSING
    ]
    given = [name for name in table if name in known]
    values = _values(((hints[name], table[name], place(where, name)) for name in given), problems)
    try:
        return cls(**dict(zip(given, values, strict=True)))
    except ConfigError:
        raise
    except ValueError as problem:
        raise ConfigError(place(where, str(problem))) from problem


_WORDS = {
    float: "a number",
    int: "a whole number",
    str: "a text",
    bool: "true or false",
    list: "a list",
    tuple: "a list",
    dict: "a table",
}


def place(where: str, name: str) -> str:
    """Returns the name of an entry in error messages."""
    return f"{where}: {name}" if where else name


def _values(parts: Iterable[tuple[Any, Any, str]], problems: Iterable[str] = ()) -> list[Any]:
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


def read_value(hint: Any, value: Any, where: str) -> Any:
    """The value as its type hint wants it. Raises ConfigError with all problems."""
    if get_origin(hint) is Annotated:
        inner, limits = get_args(hint)
        number = read_value(inner, value, where)
        if number is not None and not limits.minimum <= number <= limits.maximum:
            span = f"between {limits.minimum:.10g} and {limits.maximum:.10g}"
            raise ConfigError(f"{where} is {_shown(value)}; it must lie {span}")
        return number
    if is_dataclass(hint) and isinstance(hint, type):
        if not isinstance(value, dict):
            raise ConfigError(f"{where} must be a table")
        return parse(hint, value, where)
    if get_origin(hint) is Literal:
        if value not in get_args(hint):
            raise ConfigError(
                f"{where} is {_shown(value)}; it must be one of {', '.join(map(repr, get_args(hint)))}"
            )
        return value
    if get_origin(hint) in (types.UnionType, Union):
        return _read_union(get_args(hint), value, where)
    return _plain(hint, value, where)


def _read_union(hints: tuple[Any, ...], value: Any, where: str) -> Any:
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
    raise ConfigError(f"{where} is {_shown(value)}; it must be {' or '.join(_WORDS[kind] for kind in kinds)}")


def _plain(hint: Any, value: Any, where: str) -> Any:
    origin, inner = get_origin(hint), get_args(hint)
    if origin is list and isinstance(value, list):
        return _values((inner[0], one, f"{where}[{index}]") for index, one in enumerate(value))
    if origin is tuple and isinstance(value, list):
        hints = (inner[0],) * len(value) if inner[-1] is Ellipsis else inner
        if len(hints) != len(value):
            raise ConfigError(f"{where} is {_shown(value)}; it must be a list of {len(hints)} numbers")
        entries = enumerate(zip(hints, value, strict=True))
        return tuple(_values((hint, one, f"{where}[{index}]") for index, (hint, one) in entries))
    if origin is dict and isinstance(value, dict):
        return dict(
            zip(
                value, _values((inner[1], one, f"{where}.{name}") for name, one in value.items()), strict=True
            )
        )
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool) and _finite(value):
        return float(value)
    if isinstance(hint, type) and type(value) is hint and hint is not float:
        return value
    raise ConfigError(f"{where} is {_shown(value)}; it must be {_WORDS[origin or hint]}")


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
