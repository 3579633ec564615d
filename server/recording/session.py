"""The row of a session: creation, search, and its form in the interface."""

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import Connection
from sqlmodel import col, select

from robot_runtime.clock import Clock, boot
from robot_runtime.contract.chunks import describe_topics
from robot_runtime.contract.packets import DEFINITIONS_HASH
from server import VERSION
from server.platform.errors import ConflictError, NotFoundError
from server.platform.models import SessionRow
from server.platform.settings import Settings
from server.platform.store import Reader
from server.recording.provenance import read_provenance
from server.recording.schemas import Origin, Session, SessionSummary

REMOVING = "removing"
"""State of a row whose samples are being removed."""
IMPORTING = "importing"
"""State of a row whose samples are still being imported."""
HIDDEN = (REMOVING, IMPORTING)
"""States of rows that count as sessions only for retention and import."""
COLUMNS = tuple(name for name in Session.model_fields if name in SessionRow.model_fields)
"""Columns of a row that `from_columns` needs; not its long texts."""
EDITED: Mapping[str, Any] = {"edits": col(SessionRow.edits) + 1}
"""Values of an update that changes texts, dates or bookmarks of sessions."""
REAL_ORIGINS = ("operator", "arming", "scenario")
"""Origins of sessions in real time, whose steady times are those of this computer; the server itself computes
those in simulated time."""


class UnknownSessionError(NotFoundError):
    """There is no such session"""

    def __init__(self, session: int) -> None:
        super().__init__(f"There is no session {session}; choose one from the list of sessions.")


class SessionStateError(ConflictError):
    """Refused now"""


def new_row(
    settings: Settings,
    clock: Clock,
    name: str,
    note: str,
    robot_state: str,
    *,
    origin: Origin = "operator",
) -> SessionRow:
    """Return a session that begins now; its default name is its date and time.

    Its provenance is that of this process; `Recorder.start` replaces it by that of the robot. It reads files:
    not for the event loop.
    """
    now = datetime.now(UTC)
    provenance = read_provenance(settings)
    return SessionRow(
        name=name or default_name(now),
        note=note,
        state="recording",
        robot=settings.robot.name,
        version=VERSION,
        definitions=f"{DEFINITIONS_HASH:08x}",
        started=now.timestamp(),
        started_steady=clock.now(),
        configuration=provenance.configuration,
        robot_state=robot_state,
        topics=json.dumps(describe_topics(), ensure_ascii=False),
        boot=boot(),
        origin=origin,
        firmware=provenance.firmware,
        software=provenance.software,
    )


def default_name(moment: datetime, *, armed: bool = False) -> str:
    """Return the name of a session that nobody has named, by the moment of its start."""
    return f"{'Armed ' if armed else ''}{moment:%Y-%m-%d %H:%M} UTC"


def has_default_name(name: str, started: datetime) -> bool:
    """Return True where nobody has named a session; the name may be older than its start by a moment."""
    moments = (started, started - timedelta(minutes=1))
    return name in {default_name(moment, armed=armed) for moment in moments for armed in (False, True)}


def from_row(
    row: SessionRow,
    tags: Sequence[str] = (),
    markers: int = 0,
    *,
    film: bool = False,
    summary: str | None = None,
) -> Session:
    """Return the session of a row; `summary` is the stored one, as JSON."""
    columns = {name: getattr(row, name) for name in COLUMNS}
    return from_columns(columns, tags, markers, film=film, summary=summary)


def from_columns(
    columns: Mapping[str, Any],
    tags: Sequence[str] = (),
    markers: int = 0,
    *,
    film: bool = False,
    summary: str | None = None,
) -> Session:
    """Return the session of a row's `COLUMNS`; `summary` is the stored one, as JSON."""
    dates = {name: _moment(columns[name]) for name in ("started", "ended", "deleted", "archived")}
    return Session(
        **{**columns, **dates},
        tags=sorted(tags, key=str.casefold),
        markers=markers,
        film=film,
        summary=None if summary is None else SessionSummary.model_validate_json(summary),
    )


def find_row(store: Reader, session: int) -> SessionRow:
    """Return the row of a session, also from the bin. Raise UnknownSessionError, StoreError."""
    with store.read() as database:
        row = database.get(SessionRow, session)
    if row is None or row.state in HIDDEN:
        raise UnknownSessionError(session)
    return row


def require(connection: Connection, session: int) -> str:
    """Return the state of a session, within a transaction. Raise UnknownSessionError."""
    state = connection.execute(select(SessionRow.state).where(col(SessionRow.id) == session)).scalar()
    if state is None or state in HIDDEN:
        raise UnknownSessionError(session)
    return str(state)


def _moment(time: float | None) -> datetime | None:
    return None if time is None else datetime.fromtimestamp(time, UTC)
