"""Spans and settings of a session; times are s since its start."""

from dataclasses import dataclass
from typing import Any

from server.library.crafts import RecordedCraft, Water


@dataclass(frozen=True, slots=True)
class Span:
    """A time span, s since the session's start."""

    start: float
    end: float


@dataclass(frozen=True, slots=True)
class ControlPeriod:
    """The controller in force from `time` on, with its gains by name."""

    time: float
    controller: str
    gains: dict[str, float]
    title: str = ""
    """The controller's name for a person; empty where the recording lacks it."""


@dataclass(frozen=True, slots=True)
class ModePeriod:
    """The mode in force from `time` on."""

    time: float
    mode: str
    holds_depth: bool


@dataclass(frozen=True, slots=True)
class CardChange:
    """The card before the camera from `time` on; None: no card any more."""

    time: float
    card: str | None


@dataclass(frozen=True, slots=True)
class ParameterValues:
    """The value of every parameter from `time` on, by name."""

    time: float
    values: dict[str, Any]


@dataclass(frozen=True, slots=True)
class ControlHistory:
    """The armed spans, controllers and parameters of a session; times in s since its start."""

    armed: tuple[Span, ...]
    """The first may begin before the recording, if the state documents say so."""
    armed_at_start: bool
    """The robot was armed before the recording, at an unknown time."""
    controls: tuple[ControlPeriod, ...]
    state: dict[str, Any]
    """The newest state document at the first arming, or the first one; empty without any."""
    parameters: tuple[ParameterValues, ...] = ()
    """Empty in recordings of versions without parameters."""
    modes: tuple[ModePeriod, ...] = ()
    """Empty in recordings without state documents."""
    cards: tuple[CardChange, ...] = ()
    water: Water = "unknown"
    crafts: tuple[RecordedCraft, ...] = ()
    """The simulated ones; empty in real water, and in recordings of versions without them."""
