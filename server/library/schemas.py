"""Schemas of stored sessions, their texts and bookmarks in the interface."""

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import Field, StringConstraints

from server.http.request_body import RequestBody
from server.library.crafts import RecordedCraft, Water
from server.platform.schema_base import Schema
from server.recording.schemas import GapKind, Session

SHOWN_MAX = 2000
"""Bookmarks, and gaps, that an answer about one session holds."""

NOTE_MAX = 10_000
"""Characters of a note."""

ARCHIVED_MAX = 1000
"""Sessions that a lab looks at, or reports, at once."""

Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=100)]
Note = Annotated[str, StringConstraints(strip_whitespace=True, max_length=NOTE_MAX)]
Tag = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=40, pattern=r"^[^,]+$")
]


class Bookmark(Schema):
    """A moment of a session, with a note if somebody wrote one."""

    id: int
    time: float = Field(description="s since the session's start")
    text: str = Field(description="the note, in Markdown; empty without one")
    name: str = Field(description="the note's first line, for lists and flags")
    made: datetime = Field(description="UTC")


class SessionGap(Schema):
    """Samples that are missing in the session: `missed` of them, noticed at `time`."""

    topic: str
    kind: GapKind
    time: float = Field(description="s since the session's start")
    missed: int


class RecordedColumn(Schema):
    """One column of a topic, as it is exported."""

    name: str
    unit: str
    meaning: str


class RecordedTopic(Schema):
    """A recorded topic; times are of the first and the last sample, s since the session's start."""

    name: str
    meaning: str
    kind: Literal["rows", "documents", "picture", "film"]
    count: int
    first: float
    last: float
    columns: list[RecordedColumn]


class SessionGroup(Schema):
    """Sessions that follow each other in the list."""

    name: str = Field(description="a day such as 2026-05-31, a scenario or a mission; empty: without one")
    count: int


class SessionEdits(Schema):
    """A session that has ended, as a lab compares it with its archive."""

    id: int
    identifier: str
    name: str
    archived: bool = Field(description="true once a lab has said that it has it")
    edits: int = Field(description="number of the changes of its texts, dates and bookmarks")


class ArchivedSessions(RequestBody):
    """Sessions that a lab has, by their identifiers."""

    identifiers: Annotated[
        list[Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]], Field(min_length=1, max_length=ARCHIVED_MAX)
    ]


class SessionDetail(Session):
    """A session with all data except the samples."""

    scenario: str = Field(description="TOML; empty without one")
    configuration: str = Field(description="robot.toml as it was at the start")
    water: Water = Field(description="simulated, or real: no simulator has sent anything")
    crafts: list[RecordedCraft] = Field(
        description="the simulated ones, in order of time; none of real water, and of older versions"
    )
    robot_state: dict[str, Any] | None = Field(description="the `state` document at the start")
    marks: list[Bookmark] = Field(
        description=f"in the order of their times, the first {SHOWN_MAX}; `markers` counts all"
    )
    gap_count: int = Field(description="number of all gaps")
    gaps: list[SessionGap] = Field(description=f"in the order of their times, the first {SHOWN_MAX}")
    topics: list[RecordedTopic]


class SessionBase(RequestBody):
    """A session's texts at the beginning of an editing; null: not compared."""

    name: Annotated[str, Field(max_length=10_000)] | None = None
    note: Annotated[str, Field(max_length=100_000)] | None = None
    tags: Annotated[list[str], Field(max_length=1000)] | None = None


class SessionChanges(RequestBody):
    """Changes of a session's texts; null leaves a field unchanged."""

    name: Annotated[Name, Field(min_length=1)] | None = None
    note: Note | None = None
    tags: Annotated[list[Tag], Field(max_length=20)] | None = None
    kept: bool | None = None
    base: SessionBase | None = Field(
        default=None,
        description="what the changed texts were when the editing began: refused if somebody has changed one "
        "of them since. null replaces any",
    )


class NewSession(RequestBody):
    """A new session; its default name is its date and time."""

    name: Name = ""
    note: Note = ""


Moment = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class NewBookmark(RequestBody):
    """A new bookmark; its time in s since the session's start, or null for now. `text` is Markdown."""

    time: Moment | None = None
    text: Note = ""


class BookmarkChanges(RequestBody):
    """Changes of a bookmark; null leaves a field unchanged."""

    time: Moment | None = None
    text: Note | None = None
    base: Annotated[str, Field(max_length=100_000)] | None = Field(
        default=None,
        description="the note when the editing began: refused if somebody else has changed it since. "
        "null replaces any",
    )
