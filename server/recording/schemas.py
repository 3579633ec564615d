"""Schemas of a recorded session in the interface."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from server.platform.limits import IDENTIFIER_MAX
from server.platform.schema_base import Schema

State = Literal["recording", "complete", "interrupted"]
GapKind = Literal["missed", "restarted", "not stored", "damaged", "removed"]
SessionNumber = Annotated[int, Field(ge=1, le=IDENTIFIER_MAX)]
Origin = Literal["operator", "arming", "scenario", "simulated", "import"]


CURVE_POINTS = 60
"""Depths of a summary's curve."""


class SessionSummary(Schema):
    """The summary of an ended session, for the list. Values that its samples lack are null or empty."""

    depth: float | None = Field(description="m, the greatest")
    armed: float = Field(description="s, all armed times together")
    controllers: list[str] = Field(description="titles of those that held the depth while armed")
    modes: list[str] = Field(description="in which it was while armed")
    cards: list[str] = Field(description="colours that were before the camera, in the order of their times")
    mission: str = Field(description="name of the first one; empty without")
    alarms: int = Field(description="number of alarms that began")
    curve: list[float | None] = Field(
        description="m, the greatest depth of each of equal parts of its duration; null: none was measured"
    )
    face: float | None = Field(
        description="s since the start: from here on the first small picture shows a card, or the deepest "
        "moment; null without pictures"
    )
    damaged: bool = Field(description="true: a part of the samples cannot be read, and is not in here")


class Session(Schema):
    """One recording; "interrupted" if the server ended without closing it: its stored samples remain."""

    id: int
    identifier: str = Field(description="the same wherever it is imported, 32 hexadecimal digits")
    name: str
    note: str
    tags: list[str] = Field(description="in alphabetical order")
    markers: int = Field(description="number of bookmarks")
    state: State
    origin: Origin = Field(
        description="started by an operator, arming, a scenario in real or in simulated time; or imported"
    )
    started: datetime = Field(description="UTC")
    ended: datetime | None = Field(description="UTC; null while it records")
    duration: float = Field(description="s, up to the last samples that are stored")
    samples: int = Field(description="samples stored, all topics together")
    bytes: int = Field(description="bytes stored, compressed")
    robot: str
    version: str = Field(description="of the server that recorded it")
    definitions: str = Field(description="hash of the packet definitions, 8 hexadecimal digits")
    firmware: str = Field(description="hash of the firmware, 16 hexadecimal digits; empty where unknown")
    software: str = Field(description="hash of the runtime's sources, 16 hexadecimal digits, or empty")
    scenario_name: str = Field(description="empty without a scenario")
    seed: int | None
    film: bool = Field(default=False, description="whether the camera was filmed")
    summary: SessionSummary | None = Field(
        default=None, description="null while it records, and until its samples have been read"
    )
    kept: bool = Field(description="protected from the rules of retention")
    deleted: datetime | None = Field(description="UTC; time of its deletion, while it is in the bin")
    archived: datetime | None = Field(
        default=None, description="UTC; time at which a lab said that it has it; null before"
    )
