"""Sessions as the interface shows them, and how a new one begins."""

import json
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from robot_runtime.clock import Clock, boot
from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.provenance import hash_firmware, hash_software
from robot_runtime.simulation.boards.firmware import firmware_path
from server import VERSION
from server.features.sessions.chunks import describe_topics
from server.platform.models import SessionRow
from server.platform.settings import Settings
from server.platform.store import Reader

REMOVING = "removing"
"""State of a row whose samples are being removed: to everybody it is gone already."""
IMPORTING = "importing"
"""State of a row whose samples are not all here yet."""
HIDDEN = (REMOVING, IMPORTING)
"""States of rows that are no sessions to anybody but who removes or imports them."""

State = Literal["recording", "complete", "interrupted"]
Origin = Literal["operator", "arming", "scenario", "simulated", "import"]


Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=100)]
Note = Annotated[str, StringConstraints(strip_whitespace=True, max_length=10_000)]
Tag = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=40, pattern=r"^[^,]+$")
]


class Session(BaseModel):
    """One recording; "interrupted" where the server ended without closing it: what was stored is kept."""

    id: int
    name: str
    note: str
    tags: list[str] = Field(description="in alphabetical order")
    markers: int = Field(description="how many moments are marked")
    state: State
    origin: Origin = Field(
        description="who began it: an operator, arming, a scenario in real time, one in simulated time; "
        "or it was imported"
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
    kept: bool = Field(description="the retention rule leaves it alone")
    deleted: datetime | None = Field(description="UTC; since when it has been in the bin")


class Mark(BaseModel):
    """A moment that somebody pointed out."""

    id: int
    time: float = Field(description="s since the session's start")
    text: str
    made: datetime = Field(description="UTC")


class SessionGap(BaseModel):
    """Samples that are not in the session: `missed` of them, noticed at `time`."""

    topic: str
    kind: Literal["missed", "restarted", "not stored", "damaged"]
    time: float = Field(description="s since the session's start")
    missed: int


class RecordedColumn(BaseModel):
    """One column of a topic, as it is exported."""

    name: str
    unit: str
    meaning: str


class RecordedTopic(BaseModel):
    """What a session holds of one topic; times are of the first and the last sample, s since its start."""

    name: str
    meaning: str
    kind: Literal["rows", "documents", "picture"]
    count: int
    first: float
    last: float
    columns: list[RecordedColumn]


class SessionDetail(Session):
    """A session with everything that is known of it but the samples."""

    identifier: str = Field(description="the same wherever it is imported, 32 hexadecimal digits")
    scenario: str = Field(description="TOML; empty without one")
    configuration: str = Field(description="robot.toml as it was at the start")
    robot_state: dict[str, Any] | None = Field(description="the `state` document at the start")
    marks: list[Mark] = Field(description="in the order of their times")
    gaps: list[SessionGap]
    topics: list[RecordedTopic]


class SessionChanges(BaseModel):
    """What people say about a session; what is left out stays as it is."""

    model_config = ConfigDict(extra="forbid")
    name: Annotated[Name, Field(min_length=1)] | None = None
    note: Note | None = None
    tags: Annotated[list[Tag], Field(max_length=20)] | None = None
    kept: bool | None = None


def new_row(
    settings: Settings,
    clock: Clock,
    name: str,
    note: str,
    robot_state: str,
    *,
    origin: Origin = "operator",
    scenario: str = "",
    scenario_name: str = "",
    seed: int | None = None,
) -> SessionRow:
    """A session that begins now; without a name it is called after its moment. Raises OSError.

    It reads files: not for the event loop.
    """
    now = datetime.now(UTC)
    return SessionRow(
        name=name or f"{now:%Y-%m-%d %H:%M} UTC",
        note=note,
        state="recording",
        robot=settings.robot,
        version=VERSION,
        definitions=f"{DEFINITIONS_HASH:08x}",
        started=now.timestamp(),
        started_steady=clock.now(),
        configuration=settings.config.read_text(encoding="utf-8", errors="replace"),
        robot_state=robot_state,
        topics=json.dumps(describe_topics(), ensure_ascii=False),
        boot=boot(),
        origin=origin,
        scenario=scenario,
        scenario_name=scenario_name,
        seed=seed,
        firmware=hash_firmware(
            firmware_path(settings.build, settings.link.baud, ".hex", hil=settings.in_the_loop)
        ),
        software=hash_software(),
    )


def from_row(row: SessionRow, tags: Sequence[str] = (), markers: int = 0) -> Session:
    """The session that a row of the database is."""
    values = row.model_dump(include=set(Session.model_fields) - {"started", "ended", "deleted"})
    return Session(
        **values,
        tags=sorted(tags, key=str.casefold),
        markers=markers,
        started=datetime.fromtimestamp(row.started, UTC),
        ended=_moment(row.ended),
        deleted=_moment(row.deleted),
    )


def find_row(store: Reader, session: int) -> SessionRow | None:
    """The row of a session, also from the bin; None where there is none of this number. Raises StoreError."""
    with store.read() as database:
        row = database.get(SessionRow, session)
        return None if row is None or row.state in HIDDEN else row


def _moment(time: float | None) -> datetime | None:
    return None if time is None else datetime.fromtimestamp(time, UTC)
