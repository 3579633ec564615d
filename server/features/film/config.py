"""The section [film] of robot.toml."""

from dataclasses import dataclass

from robot_runtime.contract.commands import FilmQuality
from robot_runtime.contract.limits import FilmRate


@dataclass(frozen=True, slots=True, kw_only=True)
class FilmConfig:
    """Film of recorded sessions, in the size of the camera's stream; `rate` in Hz, at most the stream's.

    What is chosen on the page replaces it, also for later starts.
    """

    record: bool = False
    rate: FilmRate = 15.0
    quality: FilmQuality = "medium"
