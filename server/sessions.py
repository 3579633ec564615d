"""Sessions as the interface shows them, and how they are found in the database."""

import json
from datetime import UTC, datetime
from typing import Literal

from pydantic import BaseModel, Field
from sqlmodel import col, desc, select

from robot_runtime.clock import Clock, boot
from robot_runtime.packets import DEFINITIONS_HASH
from server import VERSION
from server.chunks import describe_topics
from server.models import SessionRow
from server.settings import Settings
from server.store import Store

IDENTIFIER_MAX = 2**63 - 1
"""SQLite's largest number."""

State = Literal["recording", "complete", "interrupted"]


class Session(BaseModel):
    """One recording; "interrupted" where the server ended without closing it: what was stored is kept."""

    id: int
    name: str
    note: str
    state: State
    started: datetime = Field(description="UTC")
    ended: datetime | None = Field(description="UTC; null while it records")
    duration: float = Field(description="s, up to the last samples that are stored")
    samples: int = Field(description="samples stored, all topics together")
    bytes: int = Field(description="bytes stored, compressed")
    robot: str
    definitions: str = Field(description="hash of the packet definitions, 8 hexadecimal digits")


def new_row(settings: Settings, clock: Clock, name: str, note: str, robot_state: str) -> SessionRow:
    """A session that begins now; without a name it is called after its moment. Raises OSError."""
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
        boot=boot(),
        configuration=settings.config.read_text(encoding="utf-8", errors="replace"),
        robot_state=robot_state,
        topics=json.dumps(describe_topics(), ensure_ascii=False),
    )


def from_row(row: SessionRow) -> Session:
    """The session that a row of the database is."""
    values = row.model_dump(include=set(Session.model_fields) - {"started", "ended"})
    ended = None if row.ended is None else datetime.fromtimestamp(row.ended, UTC)
    return Session(**values, started=datetime.fromtimestamp(row.started, UTC), ended=ended)


def list_sessions(store: Store) -> list[Session]:
    """All sessions, newest first. Raises StoreError."""
    with store.read() as database:
        return [from_row(row) for row in database.exec(select(SessionRow).order_by(desc(col(SessionRow.id))))]


def find_row(store: Store, session: int) -> SessionRow | None:
    """The row of a session; None where there is none of this number. Raises StoreError."""
    with store.read() as database:
        return database.get(SessionRow, session)
