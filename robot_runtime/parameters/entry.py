"""One parameter: its limits, and how it is read and set."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from robot_runtime.contract.documents import ParameterType, ParameterValue, Where

_WORDS: dict[ParameterType, str] = {
    "number": "a number",
    "whole": "a whole number",
    "choice": "a text",
    "switch": "true or false",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A parameter. `set` gets values that `check` has passed, and does not fail.

    Numbers have a minimum and a maximum. `pending`: True until a set value is in force.
    """

    name: str
    type: ParameterType = "number"
    get: Callable[[], ParameterValue]
    set: Callable[..., None]
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    meaning: str
    choices: Callable[[], Sequence[str]] = tuple
    where: Where = "runtime"
    while_armed: bool = True
    pending: Callable[[], bool] = bool

    def check(self, value: object) -> ParameterValue:
        """Return the value in the type that `set` takes. Raise ValueError with a sentence for a person."""
        if self.type == "switch" and isinstance(value, bool):
            return value
        if self.type == "choice" and isinstance(value, str):
            choices = self.choices()
            if value in choices:
                return value
            raise ValueError(f"{self.name} is {value!r}; it must be one of {', '.join(choices)}")
        if self.type in ("number", "whole") and isinstance(value, int | float):
            return self._check_number(value)
        raise ValueError(f"{self.name} is {value!r}; it must be {_WORDS[self.type]}")

    def _check_number(self, value: float) -> float:
        kinds = (int,) if self.type == "whole" else (int, float)
        if type(value) not in kinds:
            raise ValueError(f"{self.name} is {value!r}; it must be {_WORDS[self.type]}")
        assert self.minimum is not None
        assert self.maximum is not None
        # Neither NaN nor infinity lies between; a whole number too large for a float is compared as it is.
        if not self.minimum <= value <= self.maximum:
            span = f"{self.minimum:g} and {self.maximum:g} {self.unit}".strip()
            raise ValueError(f"{self.name} is {_format(value)}; it must lie between {span}")
        return value if self.type == "whole" else float(value)


def _format(value: float) -> str:
    try:
        return f"{value:g}"
    except OverflowError:
        # A whole number that no float can hold.
        return "too large"
