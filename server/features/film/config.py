"""The section [film] of robot.toml."""

from dataclasses import dataclass

from robot_runtime.contract.commands import FilmQuality
from robot_runtime.contract.limits import FilmRate


@dataclass(frozen=True, slots=True, kw_only=True)
class FilmConfig:
    """Film of recorded sessions, until the page chooses another, also for later starts; `rate` in Hz.

    It has the size of the camera's stream, and at most its rate.
    """

    record: bool = False
    rate: FilmRate = 15.0
    quality: FilmQuality = "medium"
