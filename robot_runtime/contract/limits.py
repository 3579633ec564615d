"""Limits of quantities, each stated once for configuration, commands, HTTP interface and page."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import degrees, pi
from typing import Annotated, Any, Literal

from annotated_types import Ge, GroupedMetadata, Le

from robot_runtime.contract.problems import EntryProblem


class ConfigError(ValueError):
    """A configuration or command that cannot be used; each of `problems` names an entry and its range.

    A problem that is given as text is one of the whole document.
    """

    def __init__(self, *problems: str | EntryProblem) -> None:
        self.problems = tuple(
            EntryProblem((), problem, problem) if isinstance(problem, str) else problem
            for problem in problems
        )
        super().__init__("; ".join(self.texts))

    @property
    def texts(self) -> list[str]:
        """The texts of the problems."""
        return [problem.text for problem in self.problems]


class StrictNumber:
    """Annotation that makes pydantic accept only numbers, not `true` or "1", as `contract.parsing` does."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Return the schema of the annotated number."""
        schema = handler(source)
        make_strict(schema)
        return schema


def make_strict(schema: Any) -> None:
    """Make the numbers in a schema of pydantic's core strict."""
    if isinstance(schema, list):
        for part in schema:
            make_strict(part)
    elif isinstance(schema, dict):
        if schema.get("type") in ("float", "int"):
            schema["strict"] = True
        for part in schema.values():
            make_strict(part)


@dataclass(frozen=True, slots=True)
class Range(GroupedMetadata):
    """Limits of a number, both included; pydantic reads them as `ge` and `le`."""

    minimum: float
    maximum: float

    def __iter__(self) -> Iterator[Ge | Le | StrictNumber]:
        yield Ge(self.minimum)
        yield Le(self.maximum)
        yield StrictNumber()


LoopName = Literal["depth", "heading", "pitch", "roll"]
TILT_MAX = 0.5
"""rad."""
SCENE_WIDTH = Range(16, 1280)
SCENE_HEIGHT = Range(16, 960)
"""Pixels of a rendered picture."""
SET_POINT = Range(0, 10)
"""m, of the depth."""
DEEPEST = Range(0.1, SET_POINT.maximum)
"""m, of the greatest depth that a robot is allowed."""
SET_POINTS: dict[LoopName, Range] = {
    "depth": SET_POINT,
    "heading": Range(-pi, pi),
    "pitch": Range(-TILT_MAX, TILT_MAX),
    "roll": Range(-TILT_MAX, TILT_MAX),
}
"""Range of each loop's set point, in m or rad."""


def describe_value(loop: LoopName, value: float) -> str:
    """Return a loop's value with its unit; an angle in degrees, and in rad as commands have it."""
    return f"{value:.3g} m" if loop == "depth" else f"{degrees(value):.3g}° ({value:.3g} rad)"


STREAM_HEIGHT = Range(16, 960)
"""Pixels of the camera's stream."""
STREAM_RATE = Range(2, 30)
"""Hz of the camera's stream."""
VISION_RATE = Range(2, 30)
"""Hz; a lower rate leaves the newest detection stale before the next one."""
ALONE = Range(0, 3600)
"""s for which an armed robot may go on without a server."""

UNWATCHED = Range(5, 300)
"""s of the configuration; a page that is loaded again, or a network that is slow, stays below."""

DepthSetPoint = Annotated[float, SET_POINT]
DeepestDepth = Annotated[float, DEEPEST]
VisionRate = Annotated[float, VISION_RATE]
FilmRate = Annotated[float, STREAM_RATE]
FilmSeconds = Annotated[float, Range(0, 120)]
AloneSeconds = Annotated[float, ALONE]
UnwatchedLimit = Annotated[float, UNWATCHED]
ArmedUnwatched = Annotated[float, Range(0, 3600)]
"""s for which an armed robot may swim while nobody watches; 0: without an end."""
SettleSeconds = Annotated[float, Range(0, 120)]
"""Longest wait of an experiment for the loop to settle, in s."""
ExperimentSeconds = Annotated[float, Range(2, 300)]
RelayAmplitude = Annotated[float, Range(0.1, 1.0)]
"""Share of the largest command."""
RelayCycles = Annotated[int, Range(3, 20)]
