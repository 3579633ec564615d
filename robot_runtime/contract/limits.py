"""Limits of numbers in a configuration, and the error for a configuration that cannot be used."""

from dataclasses import dataclass


class ConfigError(ValueError):
    """A configuration that cannot be used; each of `problems` names an entry and what it may be."""

    def __init__(self, *problems: str) -> None:
        super().__init__("; ".join(problems))
        self.problems = problems


@dataclass(frozen=True, slots=True)
class Range:
    """Limits of a number, both included."""

    minimum: float
    maximum: float


SET_POINT = Range(0, 10)
"""m; what a wanted depth may be, in the file and later."""
VISION_RATE = Range(2, 30)
"""Hz; slower, and what was seen would be stale before the next look."""
