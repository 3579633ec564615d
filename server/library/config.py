"""The section [sessions] of robot.toml."""

from dataclasses import dataclass, replace
from typing import Annotated

from robot_runtime.contract.limits import Range
from server.platform.settings import Settings


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionsConfig:
    """Automatic recording and retention; times in days, free space in GB of 10^9 bytes; 0 disables a rule."""

    record_at_arming: bool = True
    undo_days: Annotated[float, Range(0, 3650)] = 7.0
    keep_days: Annotated[float, Range(0, 36500)] = 0.0
    keep_free: Annotated[float, Range(0, 100_000)] = 0.5


def read_rules(settings: Settings) -> SessionsConfig:
    """Return the rules in force. A lab's archive removes nothing by itself: it may be the last copy."""
    rules = settings.section(SessionsConfig)
    return replace(rules, keep_days=0.0, keep_free=0.0) if settings.lab else rules
