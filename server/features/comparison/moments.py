"""Spans and settings of a session; times are s since its start."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Span:
    """From one moment to another, s since the session's start."""

    start: float
    end: float


@dataclass(frozen=True, slots=True)
class ControlPeriod:
    """The controller in force from `time` on, with its gains by name."""

    time: float
    controller: str
    gains: dict[str, float]


@dataclass(frozen=True, slots=True)
class Tuned:
    """Every parameter's value from `time` on, by name."""

    time: float
    values: dict[str, Any]


@dataclass(frozen=True, slots=True)
class ControlHistory:
    """When the robot was armed, and how it was controlled; times in s since the session's start."""

    armed: tuple[Span, ...]
    """The first may begin before the recording did, which is known where the state documents say so."""
    armed_at_start: bool
    """It was armed before the recording began, and nothing says when."""
    controls: tuple[ControlPeriod, ...]
    state: dict[str, Any]
    """The newest state document at the first arming, or the first of all; empty where there is none."""
    parameters: tuple[Tuned, ...] = ()
    """Empty in recordings from before there were any."""
