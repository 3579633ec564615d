"""Limits of missions: what a document may contain, and what this robot allows it."""

from dataclasses import dataclass
from typing import Annotated, Literal

from robot_runtime.contract.limits import ALONE, SET_POINT, Range

NODES_MAX = 200
LEVELS_MAX = 8
"""Levels of branches, the first of the document included."""
TIME_MAX = 3600.0
"""s; no mission lasts longer."""
WET_DEPTH = 0.1
"""m from which on the robot counts as under water; in an hour the weather changes the pressure by a tenth."""

MissionSeconds = Annotated[float, Range(0.1, TIME_MAX)]
"""s, of one step."""
MissionTime = Annotated[float, Range(1, TIME_MAX)]
"""s, of a whole mission."""
PauseSeconds = Annotated[float, Range(0, 600)]
UnwatchedSeconds = Annotated[float, Range(0, TIME_MAX)]
MissionDepth = Annotated[float, SET_POINT]
MissionAlone = Annotated[float, ALONE]
BatteryVolts = Annotated[float, Range(0, 12)]
MissionStatus = Literal["waiting", "running", "done", "failed", "stopped"]
"""Of a step; stopped: it was ended by another step, or with the mission."""
MissionPhase = Literal["running", "paused", "succeeded", "failed", "ended"]
"""Of a mission; ended: by an operator, a STOP or a fault."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionLimits:
    """The limits of every mission on this robot; a mission's own limits only tighten these.

    `depth`: m. `time`: s. `battery`: V, below which it ends; 0: none. `unwatched`: s without an operator's
    page; 0: any. `alone`: s without the server. `pause`: s in hands.
    """

    depth: MissionDepth = 3.0
    time: MissionTime = TIME_MAX
    battery: BatteryVolts = 0.0
    unwatched: UnwatchedSeconds = 0.0
    alone: MissionAlone = 600.0
    pause: PauseSeconds = 300.0


NO_LIMITS = MissionLimits()
"""The limits of a robot whose configuration has none."""
