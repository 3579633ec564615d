"""The one reader of type hints: parsers, schema writers and descriptions of fields use its forms."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from robot_runtime.contract.limits import Range

Form = Literal[
    "number",
    "whole number",
    "text",
    "switch",
    "nothing",
    "choice",
    "list",
    "tuple",
    "table",
    "union",
    "object",
    "class",
]
_PLAIN: Mapping[Any, Form] = {
    float: "number",
    int: "whole number",
    str: "text",
    bool: "switch",
    NoneType: "nothing",
}
X = TypeVar("X")


@dataclass(frozen=True, slots=True)
class Hint:
    """A type hint: the form of its values, and their class.

    `parts` are the hints of a list's entries, of each entry of a tuple, of a table's values, or of a union's
    members. A tuple of any length is a list whose class is `tuple`. `choices` are the values of a choice.
    `extras` are the annotations. An "object" is a dataclass; any other class is a "class".
    """

    form: Form
    cls: Any
    parts: tuple["Hint", ...] = ()
    choices: tuple[Any, ...] = ()
    extras: tuple[Any, ...] = ()

    @property
    def limits(self) -> Range | None:
        """The range of a number; None without one."""
        return next(self.annotations(Range), None)

    @property
    def members(self) -> tuple["Hint", ...]:
        """The hints that a value other than None may have: the members of a union, else this one."""
        return (
            tuple(part for part in self.parts if part.form != "nothing") if self.form == "union" else (self,)
        )

    @property
    def optional(self) -> bool:
        """True where None is allowed."""
        return self.form == "nothing" or len(self.members) < len(self.parts)

    def annotations(self, kind: type[X]) -> Iterator[X]:
        """Return the annotations of this kind."""
        return (extra for extra in self.extras if isinstance(extra, kind))


def read_hint(hint: Any) -> Hint:
    """Read a type hint; one that has been read stays as it is."""
    return hint if isinstance(hint, Hint) else _read_hint(hint)


def read_fields(cls: type) -> Mapping[str, Hint]:
    """Return the hints of a dataclass's fields, by their names."""
    return _read_fields(cls)


@cache
def _read_hint(hint: Any) -> Hint:
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return replace(read_hint(inner[0]), extras=inner[1:])
    if origin is Literal:
        return Hint("choice", hint, choices=inner)
    parts = tuple(read_hint(argument) for argument in inner if argument is not Ellipsis)
    if origin in (Union, UnionType):
        return Hint("union", hint, parts)
    if origin is list or (origin is tuple and Ellipsis in inner):
        return Hint("list", origin, parts)
    if origin is tuple:
        return Hint("tuple", tuple, parts)
    if origin is dict:
        return Hint("table", dict, parts[1:])
    return Hint("object" if is_dataclass(hint) else _PLAIN.get(hint, "class"), hint)


@cache
def _read_fields(cls: Any) -> Mapping[str, Hint]:
    hints = get_type_hints(cls, include_extras=True)
    return {field.name: read_hint(hints[field.name]) for field in fields(cls)}
