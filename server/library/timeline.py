"""Content of a session's seek bar: events, bookmarks and gaps."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from itertools import chain, islice, pairwise

from pydantic import Field
from sqlmodel import col, exists, select

from robot_runtime.contract.documents import Event, Severity
from robot_runtime.contract.topics import FILM, STATE, TOPICS
from server.library.bookmarks import select_bookmarks
from server.library.content import Recording
from server.library.schemas import SHOWN_MAX, Bookmark
from server.platform.models import Chunk
from server.platform.schema_base import Schema
from server.recording.schemas import State
from server.recording.session import from_row

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


class StateSilence(Schema):
    """A time without samples of the robot's state; s since the session's start."""

    start: float
    end: float


class Timeline(Schema):
    """A session as a whole, for its seek bar."""

    name: str
    state: State
    started: datetime = Field(description="UTC")
    started_steady: float = Field(description="the same moment on the steady clock of its samples, s")
    duration: float = Field(description="s, up to the last samples that are stored")
    filmed: bool = Field(description="whether there are pictures of a film")
    events: list[Moment] = Field(description=f"in order of time, the first {EVENTS_MAX}")
    markers: list[Bookmark] = Field(description=f"in order of time, the first {SHOWN_MAX}")
    holes: list[StateSilence] = Field(description=f"in order of time, the first {SHOWN_MAX}")


def read_timeline(recording: Recording) -> Timeline:
    """Return the timeline of a session. Raise StoreError, RecordingError."""
    row = recording.row
    with recording.read() as database:
        markers = select_bookmarks(database, row.id, row.started_steady)
        spans = database.connection().execute(
            select(Chunk.first_time, Chunk.last_time)
            .where(Chunk.session_id == row.id, Chunk.topic == STATE.name)
            .order_by(col(Chunk.first_time), col(Chunk.last_time))
        )
        # Read one by one: a session of a day has tens of thousands.
        silences = _find_silences(((first, last) for first, last in spans), row.started_steady, row.duration)
        holes = list(islice(silences, SHOWN_MAX))
        pictures = exists().where(col(Chunk.session_id) == row.id, col(Chunk.topic) == FILM.name)
        filmed = database.connection().execute(select(pictures)).scalar_one()
    session = from_row(row)
    return Timeline(
        name=session.name,
        state=session.state,
        started=session.started,
        started_steady=row.started_steady,
        duration=session.duration,
        filmed=filmed,
        events=read_events(recording, EVENTS_MAX),
        markers=markers,
        holes=holes,
    )


def read_events(recording: Recording, most: int) -> list[Moment]:
    """Return events of runtime and server in the order of time, the first `most`. Raise StoreError."""
    origin = recording.row.started_steady
    topics = [topic.name for topic in TOPICS if topic.record is Event and topic.name in recording.topics]
    documents = (islice(recording.documents(topic), most) for topic in topics)
    moments = [
        Moment(document["time"] - origin, document["kind"], document["severity"], document["text"])
        for document in chain.from_iterable(documents)
    ]
    return sorted(moments, key=lambda moment: moment.time)[:most]


def _find_silences(
    spans: Iterator[tuple[float, float]], start: float, duration: float
) -> Iterator[StateSilence]:
    """Yield the long times between these spans, in order of time, in s of one clock; none without a span."""
    for first in islice(spans, 1):
        edges = chain([(start, start), first], spans, [(start + duration, start + duration)])
        for (_, end), (begin, _) in pairwise(edges):
            if begin - end > SILENCE_SECONDS:
                yield StateSilence(start=end - start, end=begin - start)
