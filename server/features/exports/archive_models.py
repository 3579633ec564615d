"""The content of an archive's `session.json`, with the limits of every entry."""

import struct
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator

from robot_runtime.contract.topics import TIME
from server.platform.schema_base import Schema
from server.recording.schemas import GapKind, Origin

CODES = "bBhHiIqQfd?"
TOPICS_MAX = 200
COLUMNS_MAX = 5000
"""Columns of all topics together; this version records some 250."""
TAGS_MAX = 100
BOOKMARKS_MAX = 10_000
GAPS_STORED = 10_000

Text = Annotated[str, Field(max_length=1_000_000)]
Words = Annotated[str, Field(max_length=10_000)]
Time = Annotated[float, Field(ge=-1e15, le=1e15, allow_inf_nan=False)]
Date = Annotated[float, Field(ge=0, le=253e9, allow_inf_nan=False)]
"""s since 1970, up to the year 9987."""
MISSED_MAX = (1 << 62) - 1
Count = Annotated[int, Field(ge=0, le=MISSED_MAX)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,49}$")]


class _Strict(Schema):
    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)


class TopicField(_Strict):
    """A field of a topic, as `chunks.describe_topics` writes it; of documents only the name."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,99}$")]
    code: Annotated[str, Field(min_length=1, max_length=1)] | None = None
    count: Annotated[int, Field(ge=1, le=1000)] = 1
    scale: float = 1
    unit: Annotated[str, Field(max_length=50)] = ""
    meaning: Words = ""


class ArchivedTopic(_Strict):
    """A topic, as `chunks.describe_topics` writes it."""

    meaning: Words
    kind: Literal["rows", "documents", "picture", "film"]
    row_bytes: int = 0
    fields: Annotated[list[TopicField], Field(max_length=1000)]

    @property
    def columns(self) -> int:
        """Columns of its rows, as they are exported."""
        return sum(field.count for field in self.fields)

    @model_validator(mode="after")
    def _agrees(self) -> "ArchivedTopic":
        if self.kind == "rows":
            if any(field.code is None or field.code not in CODES for field in self.fields):
                raise ValueError("its fields have unknown types")
            codes = "<" + "".join(f"{field.count}{field.code}" for field in self.fields)
            if self.row_bytes != TIME.size + struct.calcsize(codes):
                raise ValueError("the length of its rows does not match its fields")
        return self


class ArchivedSession(_Strict):
    """The session's columns (see `SessionRow`)."""

    identifier: Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
    name: Annotated[str, Field(min_length=1, max_length=1000)]
    note: Words
    state: Literal["complete", "interrupted"]
    robot: Words
    version: Words
    definitions: Words
    started: Date
    started_steady: Time
    ended: Date | None
    duration: Annotated[float, Field(ge=0, le=1e12)]
    configuration: Text
    robot_state: dict[str, Any] | None
    topics: Annotated[dict[Name, ArchivedTopic], Field(max_length=TOPICS_MAX)]
    boot: Words = ""
    scenario: Text = ""
    scenario_name: Words = ""
    seed: Annotated[int, Field(ge=-(1 << 62), lt=1 << 62)] | None = None
    origin: Origin = "import"
    firmware: Words = ""
    software: Words = ""


class ArchivedBookmark(_Strict):
    """The columns of a bookmark (see `BookmarkRow`)."""

    time: Time
    text: Words
    made: Date


class ArchivedGap(_Strict):
    """The columns of a gap (see `Gap`)."""

    topic: Name
    kind: GapKind
    time: Time
    missed: Count


class ArchivedDocument(_Strict):
    """The content of `session.json`."""

    session: ArchivedSession
    tags: Annotated[list[Annotated[str, Field(min_length=1, max_length=100)]], Field(max_length=TAGS_MAX)]
    markers: Annotated[list[ArchivedBookmark], Field(max_length=BOOKMARKS_MAX)]
    gaps: Annotated[list[ArchivedGap], Field(max_length=1_000_000)]
    """More than `GAPS_STORED` are merged with their neighbours."""
