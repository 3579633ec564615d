"""Search and description of the stored sessions; no answer grows with the amount of data."""

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, tzinfo
from itertools import groupby, islice
from typing import Annotated, Any, Literal

from pydantic import AwareDatetime, ConfigDict, Field
from sqlalchemy import ColumnElement, exists, literal, true
from sqlmodel import col, desc, func, or_, select

from robot_runtime.contract.chunks import row_fields
from robot_runtime.contract.topics import FILM
from server.library.bookmarks import select_bookmarks
from server.library.content import Recording, reading_content
from server.library.crafts import read_crafts, which_water
from server.library.schemas import (
    ARCHIVED_MAX,
    SHOWN_MAX,
    RecordedColumn,
    RecordedTopic,
    SessionDetail,
    SessionEdits,
    SessionGap,
    SessionGroup,
)
from server.platform.limits import IDENTIFIER_MAX
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag, SummaryRow
from server.platform.schema_base import Schema
from server.platform.searching import fold
from server.platform.store import Reader
from server.recording.schemas import Origin, Session, SessionNumber, State
from server.recording.session import COLUMNS, HIDDEN, find_row, from_columns, from_row

PAGE = 100
PAGE_MAX = 500
"""Sessions in one answer."""
TAGS_SHOWN = 100
COLUMNS_SHOWN = 5000
"""Columns of all topics of one session that its description names; this version records some 250."""

Grouping = Literal["none", "day", "scenario", "mission"]
GROUPS_MAX = 5000
"""Groups in one answer."""

_READ = [getattr(SessionRow, name) for name in COLUMNS]
_HAS_FILM = exists().where(col(Chunk.session_id) == col(SessionRow.id), col(Chunk.topic) == FILM.name)
_LISTED: list[Any] = [*_READ, SummaryRow.document, _HAS_FILM]
_EDITS: list[Any] = [getattr(SessionRow, name) for name in ("id", "identifier", "name", "archived", "edits")]
_SCENARIO: Any = col(SessionRow.scenario_name)
_MISSION: ColumnElement[str] = func.coalesce(func.json_extract(SummaryRow.document, "$.mission"), "")


@dataclass(frozen=True, slots=True)
class SessionPage:
    """A part of the sessions that match, newest first, and the number of all of them.

    `following` continues the list as `before`; None at its end.
    """

    sessions: list[Session]
    total: int
    following: int | None


class SessionSelection(Schema):
    """Conditions on sessions; a session has to meet all that are given."""

    model_config = ConfigDict(extra="forbid", defer_build=False)
    search: Annotated[
        str, Field(max_length=200, description="words that name, notes, tags or scenario have")
    ] = ""
    tag: list[str] = Field(default=[], max_length=TAGS_SHOWN, description="tags that they have, all of them")
    origin: Origin | None = None
    state: State | None = None
    scenario: Annotated[str, Field(max_length=200, description="name of the scenario that they ran")] = ""
    controller: Annotated[str, Field(max_length=100, description="title of one that held the depth")] = ""
    robot: Annotated[str, Field(max_length=100, description="name of the robot that recorded them")] = ""
    film: Annotated[bool, Field(description="only those with a film")] = False
    kept: Annotated[bool, Field(description="only those that the rules of retention never take")] = False
    since: Annotated[AwareDatetime | None, Field(description="started then or later")] = None
    until: Annotated[AwareDatetime | None, Field(description="started before")] = None
    deleted: Annotated[bool, Field(description="those in the bin instead")] = False


class ListQuery(SessionSelection):
    """A part of the list of sessions."""

    by: Grouping = "none"
    before: Annotated[SessionNumber | None, Field(description="only sessions of lower numbers")] = None
    skip: Annotated[
        int, Field(ge=0, le=IDENTIFIER_MAX, description="sessions that are left out before the answer")
    ] = 0
    limit: Annotated[int, Field(ge=1, le=PAGE_MAX, description="sessions in the answer")] = PAGE


class GroupsQuery(SessionSelection):
    """Groups of sessions."""

    by: Grouping
    zone: Annotated[str, Field(max_length=60, description="whose days, such as Europe/Tallinn")] = "UTC"


EVERY_SESSION = SessionSelection()


class Listing:
    """Read access to every session of a database.

    Every method raises StoreError, and UnknownSessionError for a missing session.
    """

    def __init__(self, store: Reader) -> None:
        self._reader = store

    def page(
        self,
        selection: SessionSelection = EVERY_SESSION,
        *,
        by: Grouping = "none",
        before: int | None = None,
        skip: int = 0,
        limit: int = PAGE,
    ) -> SessionPage:
        """Return the selected sessions in the order of `groups`, within a group newest first.

        With `before` only those of lower numbers; without the first `skip` of them.
        """
        chosen = [*conditions(selection)]
        rest = [] if before is None else [col(SessionRow.id) < before]
        query = _joined(select(*_LISTED)).where(*chosen, *rest)
        query = query.order_by(*_order(by)).limit(limit + 1).offset(skip)
        with self._reader.read() as database:
            total = database.exec(select(func.count()).select_from(SessionRow).where(*chosen)).one()
            entries = list(database.connection().execute(query))
            rows = entries[:limit]
            ids = [row.id for row in rows]
            tagged: defaultdict[int, list[str]] = defaultdict(list)
            there = select(SessionTag.session_id, SessionTag.tag).where(col(SessionTag.session_id).in_(ids))
            for session, tag in database.exec(there):
                tagged[session].append(tag)
            counts = select(BookmarkRow.session_id, func.count()).where(col(BookmarkRow.session_id).in_(ids))
            marked = dict(database.exec(counts.group_by(col(BookmarkRow.session_id))).all())
        return SessionPage(
            [
                from_columns(
                    dict(zip(COLUMNS, values, strict=True)),
                    tagged[values[0]],
                    marked.get(values[0], 0),
                    film=film,
                    summary=summary,
                )
                for *values, summary, film in rows
            ],
            total,
            ids[-1] if len(entries) > limit else None,
        )

    def pages(self, selection: SessionSelection = EVERY_SESSION) -> Iterator[list[Session]]:
        """Yield all pages of `page`, one after the other."""
        before = None
        while True:
            page = self.page(selection, before=before, limit=PAGE_MAX)
            yield page.sessions
            if (before := page.following) is None:
                return

    def edits(self, before: int | None) -> list[SessionEdits]:
        """Return the ended sessions outside the bin, newest first, with `before` only those of lower numbers;
        at most `ARCHIVED_MAX`.
        """
        row = SessionRow
        rest = [] if before is None else [col(row.id) < before]
        query = select(*_EDITS).where(*conditions(EVERY_SESSION), col(row.state) != "recording", *rest)
        with self._reader.read() as database:
            rows = database.connection().execute(query.order_by(col(row.id).desc()).limit(ARCHIVED_MAX))
            return [
                SessionEdits(
                    id=id_, identifier=identifier, name=name, archived=archived is not None, edits=edits
                )
                for id_, identifier, name, archived, edits in rows
            ]

    def groups(self, selection: SessionSelection, by: Grouping, zone: tzinfo = UTC) -> list[SessionGroup]:
        """Return the groups of the selected sessions, in the order in which `page` has them.

        Days are those of `zone`. At most `GROUPS_MAX`: the last one then has all that follow.
        """
        label = {
            "none": literal(""),
            "day": col(SessionRow.started),
            "scenario": _SCENARIO,
            "mission": _MISSION,
        }
        query = _joined(select(label[by])).where(*conditions(selection)).order_by(*_order(by))
        with self._reader.read() as database:
            labels = [row[0] for row in database.connection().execute(query)]
        if by == "day":
            labels = [f"{datetime.fromtimestamp(started, zone):%Y-%m-%d}" for started in labels]
        groups = [SessionGroup(name=name, count=len(list(some))) for name, some in groupby(labels)]
        rest = groups[GROUPS_MAX:]
        if rest:
            groups[GROUPS_MAX - 1].count += sum(group.count for group in rest)
        return groups[:GROUPS_MAX]

    def controllers(self) -> list[str]:
        """Return the controllers that sessions outside the bin used, in alphabetical order; at most
        `TAGS_SHOWN`.
        """
        used = func.json_each(SummaryRow.document, "$.controllers").table_valued("value")
        query = select(used.c.value).select_from(SummaryRow).join(used, true()).distinct()
        query = query.join(SessionRow, col(SessionRow.id) == col(SummaryRow.session_id))
        query = query.where(*conditions(EVERY_SESSION)).order_by(used.c.value).limit(TAGS_SHOWN)
        with self._reader.read() as database:
            return list(database.connection().execute(query).scalars())

    def robots(self) -> list[str]:
        """Return the robots of the sessions outside the bin, in alphabetical order; at most `TAGS_SHOWN`."""
        query = select(SessionRow.robot).where(*conditions(EVERY_SESSION)).distinct()
        with self._reader.read() as database:
            return list(database.exec(query.order_by(SessionRow.robot).limit(TAGS_SHOWN)))

    def tags(self) -> list[str]:
        """Return the tags of sessions outside the bin, those of most sessions first; at most `TAGS_SHOWN`."""
        used = select(SessionTag.tag).join(SessionRow, col(SessionRow.id) == col(SessionTag.session_id))
        used = used.where(*conditions(EVERY_SESSION))
        ordered = used.group_by(SessionTag.tag).order_by(desc(func.count()), col(SessionTag.tag))
        with self._reader.read() as database:
            return list(database.exec(ordered.limit(TAGS_SHOWN)))

    def find(self, session: int) -> Session:
        """Return one session, also from the bin."""
        row = find_row(self._reader, session)
        with self._reader.read() as database:
            tags = database.exec(select(SessionTag.tag).where(SessionTag.session_id == session)).all()
            bookmarks = select(func.count()).select_from(BookmarkRow).where(BookmarkRow.session_id == session)
            more = _joined(select(SummaryRow.document, _HAS_FILM)).where(SessionRow.id == session)
            summary, film = database.connection().execute(more).one()
            return from_row(row, tags, database.exec(bookmarks).one(), film=film, summary=summary)

    def detail(self, session: int) -> SessionDetail:
        """Return one session with all data except its samples."""
        summary = self.find(session)
        with self._reader.read() as database:
            row = database.get_one(SessionRow, session)
            all_gaps = select(func.count()).select_from(Gap).where(Gap.session_id == session)
            gap_count = database.exec(all_gaps).one()
            first_gaps = select(Gap.topic, Gap.kind, Gap.time, Gap.missed).where(Gap.session_id == session)
            gaps = database.exec(first_gaps.order_by(col(Gap.time)).limit(SHOWN_MAX)).all()
            marks = select_bookmarks(database, session, row.started_steady)
            spans = database.exec(
                select(
                    Chunk.topic, func.sum(Chunk.count), func.min(Chunk.first_time), func.max(Chunk.last_time)
                )
                .where(Chunk.session_id == session)
                .group_by(Chunk.topic)
            ).all()
        start = row.started_steady
        with reading_content(row):
            return SessionDetail(
                **summary.model_dump(),
                scenario=row.scenario,
                configuration=row.configuration,
                water=which_water({name for name, *_ in spans}),
                crafts=read_crafts(Recording(self._reader, row)),
                robot_state=json.loads(row.robot_state or "null"),
                marks=marks,
                gap_count=gap_count,
                gaps=[
                    SessionGap.model_validate(
                        {"topic": topic, "kind": kind, "time": time - start, "missed": missed}
                    )
                    for topic, kind, time, missed in gaps
                ],
                topics=_topics(json.loads(row.topics), {name: rest for name, *rest in spans}, start),
            )


def _joined(query: Any) -> Any:
    """Return the query of sessions with their summaries, where there are some."""
    return query.select_from(SessionRow).outerjoin(
        SummaryRow, col(SummaryRow.session_id) == col(SessionRow.id)
    )


def _order(by: Grouping) -> list[ColumnElement[Any]]:
    """Return the order of the list; sessions without such a thing come last."""
    newest = col(SessionRow.id).desc()
    if by in ("none", "day"):
        return [newest]
    label = _SCENARIO if by == "scenario" else _MISSION
    return [label == "", label, newest]


def conditions(selection: SessionSelection) -> Iterator[ColumnElement[bool]]:
    """Yield the conditions on rows of sessions; a session has to meet all."""
    row = SessionRow
    yield col(row.state).not_in(HIDDEN)
    yield col(row.deleted).is_not(None) if selection.deleted else col(row.deleted).is_(None)
    if selection.origin is not None:
        yield col(row.origin) == selection.origin
    if selection.state is not None:
        yield col(row.state) == selection.state
    if selection.scenario:
        yield col(row.scenario_name) == selection.scenario
    if selection.robot:
        yield col(row.robot) == selection.robot
    if selection.kept:
        yield col(row.kept).is_(True)
    if selection.since is not None:
        yield col(row.started) >= selection.since.timestamp()
    if selection.until is not None:
        yield col(row.started) < selection.until.timestamp()
    if selection.film:
        yield _HAS_FILM
    if selection.controller:
        used = func.json_each(SummaryRow.document, "$.controllers").table_valued("value")
        those = select(SummaryRow.session_id).join(used, true())
        yield col(row.id).in_(those.where(used.c.value == selection.controller))
    tagged = select(SessionTag.session_id)
    for tag in selection.tag:
        yield col(row.id).in_(tagged.where(func.casefold(SessionTag.tag) == tag.casefold()))
    texts = func.fold(col(row.name) + "\n" + col(row.note) + "\n" + col(row.scenario_name))
    for word in fold(selection.search).split():
        in_tags = tagged.where(func.instr(func.fold(SessionTag.tag), word) > 0)
        in_notes = select(BookmarkRow.session_id).where(func.instr(func.fold(BookmarkRow.text), word) > 0)
        yield or_(func.instr(texts, word) > 0, col(row.id).in_(in_tags), col(row.id).in_(in_notes))


def _topics(
    described: Mapping[str, dict[str, Any]], spans: Mapping[str, Sequence[Any]], start: float
) -> list[RecordedTopic]:
    topics: list[RecordedTopic] = []
    room = COLUMNS_SHOWN
    for name, topic in described.items():
        if name not in spans:
            continue
        count, first, last = spans[name]
        columns = list(islice(_columns(topic), room))
        room -= len(columns)
        topics.append(
            RecordedTopic(
                name=name,
                meaning=topic["meaning"],
                kind=topic["kind"],
                count=count,
                first=first - start,
                last=last - start,
                columns=columns,
            )
        )
    return topics


def _columns(topic: dict[str, Any]) -> list[RecordedColumn]:
    if topic["kind"] != "rows":
        return [RecordedColumn(name=field["name"], unit="", meaning="") for field in topic["fields"]]
    return [
        RecordedColumn(name=name, unit=field.unit, meaning=field.meaning)
        for field in row_fields(topic)
        for name in field.columns
    ]
