"""Content of a session's seek bar: events, bookmarks and gaps."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import chain, islice, pairwise

from pydantic import BaseModel, Field
from sqlmodel import col, select

from robot_runtime.contract.documents import Event, Severity
from robot_runtime.contract.topics import TOPICS
from server.features.sessions.bookmarks import describe_bookmarks
from server.features.sessions.recording import Recording
from server.features.sessions.schemas import Bookmark, State
from server.features.sessions.session import from_row
from server.platform.models import BookmarkRow, Chunk

EVENTS_MAX = 2000
SILENCE_SECONDS = 3.0
"""The robot's state is sent at least once a second; a longer time without it counts as silence."""


@dataclass(frozen=True, slots=True)
class Moment:
    """An event; `time` in s since the session's start, `kind` one word for programs."""

    time: float
    kind: str
    severity: Severity
    text: str


class StateSilence(BaseModel):
    """A time without samples of the robot's state; s since the session's start."""

    start: float
    end: float


class Timeline(BaseModel):
    """A session as a whole, for its seek bar."""

    name: str
    state: State
    started: datetime = Field(description="UTC")
    started_steady: float = Field(description="the same moment on the steady clock of its samples, s")
    duration: float = Field(description="s, up to the last samples that are stored")
    events: list[Moment] = Field(description=f"in order of time, the first {EVENTS_MAX}")
    markers: list[Bookmark] = Field(description="in order of time")
    holes: list[StateSilence]


def read_timeline(recording: Recording) -> Timeline:
    """The timeline of a session. Raises StoreError, RecordingError."""
    row = recording.row
    with recording.read() as database:
        bookmarks = database.exec(select(BookmarkRow).where(BookmarkRow.session_id == row.id)).all()
        spans = database.exec(
            select(Chunk.first_time, Chunk.last_time)
            .where(Chunk.session_id == row.id, Chunk.topic == "state")
            .order_by(col(Chunk.number))
        ).all()
    session = from_row(row)
    return Timeline(
        name=session.name,
        state=session.state,
        started=session.started,
        started_steady=row.started_steady,
        duration=session.duration,
        events=read_events(recording, EVENTS_MAX),
        markers=describe_bookmarks(bookmarks, row.started_steady),
        holes=_find_silences(spans, row.started_steady, row.duration),
    )


def read_events(recording: Recording, most: int) -> list[Moment]:
    """Events of runtime and server in the order of time, the first `most`. Raises StoreError."""
    origin = recording.row.started_steady
    topics = [one.name for one in TOPICS if one.record is Event and one.name in recording.topics]
    documents = (islice(recording.documents(topic), most) for topic in topics)
    found = [
        Moment(one["time"] - origin, one["kind"], one["severity"], one["text"])
        for one in chain.from_iterable(documents)
    ]
    return sorted(found, key=lambda one: one.time)[:most]


def _find_silences(spans: Sequence[tuple[float, float]], start: float, duration: float) -> list[StateSilence]:
    """The long times between these spans; all in s of one clock."""
    if not spans:
        return []
    edges = [(start, start), *spans, (start + duration, start + duration)]
    return [
        StateSilence(start=end - start, end=begin - start)
        for (_, end), (begin, _) in pairwise(edges)
        if begin - end > SILENCE_SECONDS
    ]
