"""All parameters of one robot: listed, and changed all or none between two control ticks."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from robot_runtime.contract.documents import ParameterValue, TunableParameter
from robot_runtime.errors import RefusedError
from robot_runtime.parameters.entry import Entry

Changed = dict[str, tuple[ParameterValue, ParameterValue]]
"""By name: the value before and after."""


class Registry:
    """The parameters of these entries. A parameter's default is its value when the registry is made.

    A control tick holds `tick_lock`, and so does a change of parameters: a tick sees all of a change or none.
    Every method may be called from any thread.
    """

    def __init__(
        self,
        entries: Iterable[Entry],
        armed: Callable[[], bool],
        tick_lock: AbstractContextManager[object],
    ) -> None:
        self._entries = {entry.name: entry for entry in entries}
        self._defaults = self.values()
        self._armed = armed
        self._tick_lock = tick_lock

    def values(self) -> dict[str, ParameterValue]:
        """Return the values in force, by name."""
        return {name: entry.get() for name, entry in self._entries.items()}

    def listed(self) -> list[TunableParameter]:
        """Return every parameter with its description and its value."""
        return [
            TunableParameter(
                name=entry.name,
                type=entry.type,
                value=entry.get(),
                default=self._defaults[entry.name],
                minimum=entry.minimum,
                maximum=entry.maximum,
                unit=entry.unit,
                meaning=entry.meaning,
                choices=list(entry.choices()),
                where=entry.where,
                while_armed=entry.while_armed,
                pending=entry.pending(),
            )
            for entry in self._entries.values()
        ]

    def is_pending(self, name: str) -> bool:
        """Return True until the board has confirmed a parameter's value."""
        return self._entries[name].pending()

    def find_problem(self, name: str, value: object) -> str:
        """Return the reason why an armed robot's parameter cannot have this value; empty if it can."""
        entry = self._entries.get(name)
        if entry is None:
            return f"There is no parameter {name!r}."
        if not entry.while_armed:
            return f"{name} can only be changed while the robot is disarmed."
        try:
            entry.check(value)
        except ValueError as problem:
            return f"{problem}."
        return ""

    @contextmanager
    def changing(self) -> Iterator[Changed]:
        """Hold the control ticks; yield a dict that is filled with the changed values at the end."""
        changed: Changed = {}
        with self._tick_lock:
            before = self.values()
            yield changed
            after = self.values()
        changed |= {name: (before[name], after[name]) for name in after if before[name] != after[name]}

    def apply(
        self, values: Mapping[str, Any], expected: Mapping[str, Any] | None = None, *, partly: bool = False
    ) -> dict[str, str]:
        """Set all of these values, or with `partly` those that are valid; return the problems by name.

        Raise RefusedError with every reason if a value is invalid, or differs from `expected`; then none is
        set.
        """
        problems: dict[str, str] = {}
        checked: dict[str, ParameterValue] = {}
        with self._tick_lock:
            for name, value in (expected or {}).items():
                if name in self._entries and (now := self._entries[name].get()) != value:
                    problems[name] = f"{name} is {now} now, and not {value} any more"
            for name, value in values.items():
                if name in problems:
                    continue
                try:
                    checked[name] = self._check(name, value)
                except ValueError as problem:
                    problems[name] = str(problem)
            if problems and not partly:
                raise RefusedError("; ".join(problems.values()) + ". Nothing was changed.")
            for name, value in checked.items():
                if value != self._entries[name].get():
                    self._entries[name].set(value)
        return problems

    def _check(self, name: str, value: object) -> ParameterValue:
        entry = self._entries.get(name)
        if entry is None:
            raise ValueError(f"there is no parameter {name!r}")
        checked = entry.check(value)
        if checked != entry.get() and not entry.while_armed and self._armed():
            raise ValueError(f"{name} can only be changed while the robot is disarmed")
        return checked
