"""A parameter of a sweep: an entry of the scenario with the values that it takes."""

from collections.abc import Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from random import Random
from typing import Annotated, Any, Literal

from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import read_value
from robot_runtime.contract.problems import DocumentEntry

Value = float | int | str
Kind = Literal["list", "range", "random", "search"]
Path = tuple[str | int, ...]
COUNT_MAX = 1000
"""Values of one parameter."""
STEPS = Range(2, COUNT_MAX)
SAMPLES = Range(1, COUNT_MAX)
INDEX_DIGITS = 6
"""Of an entry's number in a list; Python refuses to read thousands."""
DIGITS = 12
"""Significant digits of a value of a range, so that it is what a person would write."""
_WORDS = (
    "is a list of values, { from, to, steps }, { uniform = [least, most] } or, with [search], { from, to }"
)
_NAMES = frozenset({"from", "to", "steps", "uniform", "samples"})


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptParameter:
    """An entry of the scenario that varies; `low` and `high` are the limits of a drawn or searched number.

    `values` is empty where each seed draws its own value, or a search chooses it.
    """

    name: str
    kind: Kind
    where: DocumentEntry
    values: tuple[Value, ...] = ()
    low: float = 0.0
    high: float = 0.0

    @property
    def path(self) -> Path:
        """The path of the entry in the scenario's table."""
        return tuple(
            int(part) if part.isdecimal() and len(part) <= INDEX_DIGITS else part
            for part in self.name.split(".")
        )

    @property
    def count(self) -> int:
        """The number of values that variants have."""
        return max(len(self.values), 1)

    @property
    def by_seed(self) -> bool:
        """True where each seed draws its own value, the same in every variant."""
        return self.kind == "random" and not self.values

    @property
    def checked(self) -> list[tuple[DocumentEntry, Value]]:
        """The values that are checked before the sweep begins, each with its place in the document."""
        if self.kind == "list":
            return [(self.where.item(index), value) for index, value in enumerate(self.values)]
        if self.kind == "range":
            return [(self.where, self.values[0]), (self.where, self.values[-1])]
        return [(self.where, self.low), (self.where, self.high)]

    def draw(self, seed: int) -> float:
        """Return the value that a seed draws, the same in every variant."""
        return neat(Random(f"{self.name} {seed}").uniform(self.low, self.high))


def neat(value: float) -> float:
    """Return a number of `DIGITS` significant digits."""
    return float(f"{value:.{DIGITS}g}")


def find_specifications(
    table: Mapping[str, Any], where: DocumentEntry, prefix: str = ""
) -> Iterator[tuple[str, DocumentEntry, Any]]:
    """Yield name, container and specification of each parameter; a dotted name may be quoted or not."""
    for key, value in table.items():
        name, entry = f"{prefix}{key}", where.key(key)
        if isinstance(value, dict) and value and not value.keys() & _NAMES:
            yield from find_specifications(value, entry, f"{name}.")
        else:
            yield name, entry, value


def read_parameter(name: str, where: DocumentEntry, given: Any, *, searched: bool) -> SweptParameter:
    """Return a parameter of a specification. Raise ConfigError with all problems."""
    if isinstance(given, list):
        return _read_list(name, where, given, searched=searched)
    if not isinstance(given, dict) or not given.keys() <= _NAMES:
        raise ConfigError(where.problem(_WORDS))
    match frozenset(given):
        case names if names in ({"uniform"}, {"uniform", "samples"}):
            return _read_random(name, where, given, searched=searched)
        case names if names == {"from", "to", "steps"}:
            if searched:
                raise ConfigError(where.problem("has steps; with [search] a range is { from, to }"))
            return _read_range(name, where, given)
        case names if names == {"from", "to"}:
            if not searched:
                raise ConfigError(where.problem("needs steps, or the document a table [search]"))
            low, high = _read_limits(where, given["from"], given["to"])
            return SweptParameter(name=name, kind="search", where=where, low=low, high=high)
    raise ConfigError(where.problem(_WORDS))


def change_table(table: Mapping[str, Any], changes: Iterable[tuple[Path, Value]]) -> dict[str, Any]:
    """Return a copy of a scenario's table with these entries changed. Raise ConfigError."""
    changed = deepcopy(dict(table))
    for path, value in changes:
        _change(changed, path, value)
    return changed


def _change(table: dict[str, Any], path: Path, value: Value) -> None:
    container: Any = table
    *above, last = path
    for index, part in enumerate(above):
        if isinstance(container, dict):
            container = container.setdefault(str(part), {})
        elif isinstance(container, list) and isinstance(part, int) and part < len(container):
            container = container[part]
        else:
            _refuse(path[: index + 1], container)
    if isinstance(container, dict):
        container[str(last)] = value
    elif isinstance(container, list) and isinstance(last, int) and last < len(container):
        container[last] = value
    else:
        _refuse(path, container)


def _refuse(path: Path, container: Any) -> None:
    name = ".".join(map(str, path))
    if isinstance(container, list):
        raise ConfigError(f"{name}: the scenario's list has the entries 0 to {len(container) - 1}")
    raise ConfigError(f"{name}: the scenario has a value where a table would be")


def _read_list(name: str, where: DocumentEntry, given: list[Any], *, searched: bool) -> SweptParameter:
    if searched:
        raise ConfigError(where.problem("is a list; with [search] it is { from, to } or { uniform }"))
    if not 1 <= len(given) <= COUNT_MAX:
        raise ConfigError(where.problem(f"has {len(given)} values; there are 1 to {COUNT_MAX}"))
    values: list[Value] = []
    for index, value in enumerate(given):
        item = where.item(index)
        if isinstance(value, str):
            values.append(value)
        elif type(value) is int:
            # As it is written: some entries are whole numbers.
            values.append(value)
        else:
            values.append(read_value(float, value, item))
    if len(set(values)) < len(values):
        raise ConfigError(where.problem("has a value twice"))
    return SweptParameter(name=name, kind="list", where=where, values=tuple(values))


def _read_range(name: str, where: DocumentEntry, given: Mapping[str, Any]) -> SweptParameter:
    low, high = _read_limits(where, given["from"], given["to"])
    steps: int = read_value(Annotated[int, STEPS], given["steps"], where.key("steps"))
    values = tuple(neat(low + index * (high - low) / (steps - 1)) for index in range(steps))
    return SweptParameter(name=name, kind="range", where=where, values=values)


def _read_random(
    name: str, where: DocumentEntry, given: Mapping[str, Any], *, searched: bool
) -> SweptParameter:
    ends = read_value(tuple[float, float], given["uniform"], where.key("uniform"))
    low, high = _read_limits(where, *ends)
    values: tuple[Value, ...] = ()
    if "samples" in given:
        if searched:
            raise ConfigError(where.problem("has samples; with [search] it is { from, to } or { uniform }"))
        samples: int = read_value(Annotated[int, SAMPLES], given["samples"], where.key("samples"))
        drawn = Random(f"{name} samples")
        values = tuple(neat(drawn.uniform(low, high)) for _ in range(samples))
    return SweptParameter(name=name, kind="random", where=where, values=values, low=low, high=high)


def _read_limits(where: DocumentEntry, low: Any, high: Any) -> tuple[float, float]:
    low, high = read_value(float, low, where.key("from")), read_value(float, high, where.key("to"))
    if not low < high:
        raise ConfigError(where.problem(f"is from {low:g} to {high:g}; the first must be the smaller one"))
    return low, high
