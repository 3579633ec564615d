"""Search and description of the stored sessions; no answer grows with the amount of data."""

import json
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

from sqlalchemy import ColumnElement
from sqlmodel import col, desc, func, or_, select

from robot_runtime.contract.chunks import row_fields
from server.library.bookmarks import select_bookmarks
from server.library.content import Recording, reading_content
from server.library.crafts import read_crafts, which_water
from server.library.schemas import SHOWN_MAX, RecordedColumn, RecordedTopic, SessionDetail, SessionGap
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag
from server.platform.searching import fold
from server.platform.store import Reader
from server.recording.schemas import Origin, Session, State
from server.recording.session import COLUMNS, HIDDEN, find_row, from_columns, from_row

PAGE = 100
PAGE_MAX = 500
"""Sessions in one answer."""
TAGS_SHOWN = 100
COLUMNS_SHOWN = 5000
"""Columns of all topics of one session that its description names; this version records some 250."""

_READ = [getattr(SessionRow, name) for name in COLUMNS]


@dataclass(frozen=True, slots=True)
class SessionPage:
    """A part of the sessions that match, newest first, and the number of all of them.

    `following` continues the list as `before`; None at its end.
    """

    sessions: list[Session]
    total: int
    following: int | None


class Listing:
    """Read access to every session of a database.

    Every method raises StoreError, and UnknownSessionError for a missing session.
    """

    def __init__(self, store: Reader) -> None:
        self._reader = store

    def page(
        self,
        search: str = "",
        tags: Collection[str] = (),
        origin: Origin | None = None,
        *,
        state: State | None = None,
        scenario: str = "",
        deleted: bool = False,
        before: int | None = None,
        limit: int = PAGE,
    ) -> SessionPage:
        """Return sessions with all words of `search` in name, notes, tags or scenario, and all tags; newest
        first.

        With `scenario` only its runs; with `deleted` those in the bin instead; with `before` only those of
        lower numbers.
        """
        chosen = [*_conditions(search, tags, origin, state, deleted=deleted)]
        if scenario:
            chosen.append(col(SessionRow.scenario_name) == scenario)
        rest = [] if before is None else [col(SessionRow.id) < before]
        query = select(*_READ).where(*chosen, *rest).order_by(col(SessionRow.id).desc()).limit(limit + 1)
        with self._reader.read() as database:
            total = database.exec(select(func.count()).select_from(SessionRow).where(*chosen)).one()
            entries = [dict(zip(COLUMNS, row, strict=True)) for row in database.connection().execute(query)]
            rows = entries[:limit]
            ids = [row["id"] for row in rows]
            tagged: defaultdict[int, list[str]] = defaultdict(list)
            there = select(SessionTag.session_id, SessionTag.tag).where(col(SessionTag.session_id).in_(ids))
            for session, tag in database.exec(there):
                tagged[session].append(tag)
            counts = select(BookmarkRow.session_id, func.count()).where(col(BookmarkRow.session_id).in_(ids))
            marked = dict(database.exec(counts.group_by(col(BookmarkRow.session_id))).all())
        return SessionPage(
            [from_columns(row, tagged[row["id"]], marked.get(row["id"], 0)) for row in rows],
            total,
            ids[-1] if len(entries) > limit else None,
        )

    def pages(
        self, search: str = "", tags: Collection[str] = (), *, deleted: bool = False
    ) -> Iterator[list[Session]]:
        """Yield all pages of `page`, one after the other."""
        before = None
        while True:
            page = self.page(search, tags, deleted=deleted, before=before, limit=PAGE_MAX)
            yield page.sessions
            if (before := page.following) is None:
                return

    def tags(self) -> list[str]:
        """Return the tags of sessions outside the bin, those of most sessions first; at most `TAGS_SHOWN`."""
        used = select(SessionTag.tag).join(SessionRow, col(SessionRow.id) == col(SessionTag.session_id))
        used = used.where(*_conditions("", (), None, None, deleted=False))
        ordered = used.group_by(SessionTag.tag).order_by(desc(func.count()), col(SessionTag.tag))
        with self._reader.read() as database:
            return list(database.exec(ordered.limit(TAGS_SHOWN)))

    def find(self, session: int) -> Session:
        """Return one session, also from the bin."""
        row = find_row(self._reader, session)
        with self._reader.read() as database:
            tags = database.exec(select(SessionTag.tag).where(SessionTag.session_id == session)).all()
            bookmarks = select(func.count()).select_from(BookmarkRow).where(BookmarkRow.session_id == session)
            return from_row(row, tags, database.exec(bookmarks).one())

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
                identifier=row.identifier,
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


def _conditions(
    search: str, tags: Collection[str], origin: Origin | None, state: State | None, *, deleted: bool
) -> Iterator[ColumnElement[bool]]:
    row = SessionRow
    yield col(row.state).not_in(HIDDEN)
    yield col(row.deleted).is_not(None) if deleted else col(row.deleted).is_(None)
    if origin is not None:
        yield col(row.origin) == origin
    if state is not None:
        yield col(row.state) == state
    tagged = select(SessionTag.session_id)
    for tag in tags:
        yield col(row.id).in_(tagged.where(func.casefold(SessionTag.tag) == tag.casefold()))
    texts = func.fold(col(row.name) + "\n" + col(row.note) + "\n" + col(row.scenario_name))
    for word in fold(search).split():
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
