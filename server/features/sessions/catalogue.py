"""The stored sessions: search, description, annotation, deletion and restoration."""

import json
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from time import time
from typing import Any

from sqlalchemy import Connection, delete, insert, update
from sqlalchemy.orm import defer
from sqlmodel import col, desc, func, select

from server.features.sessions.bookmarks import describe_bookmarks
from server.features.sessions.chunks import row_layout
from server.features.sessions.crafts import read_crafts, which_water
from server.features.sessions.recorder import Recorder
from server.features.sessions.recording import Recording, reading_content
from server.features.sessions.schemas import RecordedColumn, RecordedTopic, Session, SessionDetail, SessionGap
from server.features.sessions.session import (
    HIDDEN,
    REMOVING,
    SessionStateError,
    find_row,
    from_row,
    require,
)
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag
from server.platform.store import Reader, Store


class Listing:
    """Read access to every session of a database.

    Every method raises StoreError, and UnknownSessionError for a missing session.
    """

    def __init__(self, store: Reader) -> None:
        self._reader = store

    def list(
        self,
        search: str = "",
        tags: Collection[str] = (),
        origin: str | None = None,
        *,
        deleted: bool = False,
    ) -> list[Session]:
        """Sessions with every word of `search` in name, note, tags or scenario, and every tag; newest first.

        With `deleted` those in the bin instead.
        """
        texts = (SessionRow.configuration, SessionRow.robot_state, SessionRow.topics, SessionRow.scenario)
        query = (
            select(SessionRow)
            .options(*(defer(text) for text in texts))  # type: ignore[arg-type]
            .where(col(SessionRow.state).not_in(HIDDEN), col(SessionRow.deleted).is_not(None) == deleted)
            .order_by(desc(col(SessionRow.id)))
        )
        if origin is not None:
            query = query.where(SessionRow.origin == origin)
        with self._reader.read() as database:
            tagged: defaultdict[int, list[str]] = defaultdict(list)
            for tag in database.exec(select(SessionTag)):
                tagged[tag.session_id].append(tag.tag)
            counts = select(BookmarkRow.session_id, func.count()).group_by(col(BookmarkRow.session_id))
            marked = dict(database.exec(counts).all())
            rows = database.exec(query).all()
            sessions = [from_row(row, tagged[row.id or 0], marked.get(row.id or 0, 0)) for row in rows]
        # SQLite's LIKE ignores case only for ASCII letters.
        words = search.casefold().split()
        chosen = {tag.casefold() for tag in tags}
        return [one for one in sessions if _holds(one, words) and chosen <= {t.casefold() for t in one.tags}]

    def find(self, session: int) -> Session:
        """One session, also from the bin."""
        row = find_row(self._reader, session)
        with self._reader.read() as database:
            tags = database.exec(select(SessionTag.tag).where(SessionTag.session_id == session)).all()
            bookmarks = select(func.count()).select_from(BookmarkRow).where(BookmarkRow.session_id == session)
            return from_row(row, tags, database.exec(bookmarks).one())

    def detail(self, session: int) -> SessionDetail:
        """One session with everything that is known of it except its samples."""
        found = self.find(session)
        with self._reader.read() as database:
            row = database.get_one(SessionRow, session)
            gaps = database.exec(select(Gap).where(Gap.session_id == session).order_by(col(Gap.time))).all()
            marks = database.exec(select(BookmarkRow).where(BookmarkRow.session_id == session)).all()
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
                **found.model_dump(),
                identifier=row.identifier,
                scenario=row.scenario,
                configuration=row.configuration,
                water=which_water({name for name, *_ in spans}),
                crafts=read_crafts(Recording(self._reader, row)),
                robot_state=json.loads(row.robot_state or "null"),
                marks=describe_bookmarks(marks, start),
                gaps=[
                    SessionGap(**gap.model_dump(include={"topic", "kind", "missed"}), time=gap.time - start)
                    for gap in gaps
                ],
                topics=_topics(json.loads(row.topics), {name: rest for name, *rest in spans}, start),
            )


class Catalogue(Listing):
    """Write access to the sessions; `recorder` learns of changes to the one that records."""

    def __init__(self, store: Store, recorder: Recorder | None = None) -> None:
        super().__init__(store)
        self._store = store
        self._recorder = recorder

    async def change(
        self,
        session: int,
        *,
        name: str | None = None,
        note: str | None = None,
        tags: Sequence[str] | None = None,
        kept: bool | None = None,
    ) -> Session:
        """Change name, note, tags or protection of a session; None leaves a field unchanged."""
        changes = {"name": name, "note": note, "kept": kept}
        values = {field: value for field, value in changes.items() if value is not None}

        def write(connection: Connection) -> None:
            require(connection, session)
            if values:
                connection.execute(update(SessionRow).where(col(SessionRow.id) == session).values(values))
            if tags is not None:
                connection.execute(delete(SessionTag).where(col(SessionTag.session_id) == session))
                rows = [{"session_id": session, "tag": tag} for tag in dict.fromkeys(tags)]
                if rows:
                    connection.execute(insert(SessionTag), rows)

        await self._store.write(write)
        return self.notify(session)

    async def delete(self, session: int) -> Session:
        """Move a session to the bin. Raises SessionStateError for one that records."""

        def write(connection: Connection) -> None:
            if require(connection, session) == "recording":
                raise SessionStateError("This session is recording. Stop it first, then delete it.")
            unset = col(SessionRow.deleted).is_(None)
            query = update(SessionRow).where(col(SessionRow.id) == session, unset)
            connection.execute(query.values(deleted=time()))

        await self._store.write(write, frees=True)
        return self.find(session)

    async def restore(self, session: int) -> Session:
        """Take a session out of the bin."""
        there = col(SessionRow.id) == session, col(SessionRow.state).not_in(HIDDEN)
        await self._store.execute(update(SessionRow).where(*there).values(deleted=None))
        return self.find(session)

    async def purge(self, session: int) -> None:
        """Mark a session of the bin for removal; it disappears at once.

        Raises SessionStateError outside the bin.
        """

        def write(connection: Connection) -> None:
            require(connection, session)
            query = select(SessionRow.deleted).where(SessionRow.id == session)
            if connection.execute(query).scalar() is None:
                raise SessionStateError("This session is not in the bin. Delete it first.")
            connection.execute(update(SessionRow).where(col(SessionRow.id) == session).values(state=REMOVING))

        await self._store.write(write, frees=True)

    def notify(self, session: int) -> Session:
        """Report a session's new state to the pages, if it is being recorded."""
        found = self.find(session)
        if self._recorder is not None:
            self._recorder.amend(found)
        return found


def _holds(session: Session, words: Sequence[str]) -> bool:
    text = "\n".join((session.name, session.note, session.scenario_name, *session.tags)).casefold()
    return all(word in text for word in words)


def _topics(
    described: Mapping[str, dict[str, Any]], spans: Mapping[str, Sequence[Any]], start: float
) -> list[RecordedTopic]:
    return [
        RecordedTopic(
            name=name,
            meaning=topic["meaning"],
            kind=topic["kind"],
            count=spans[name][0],
            first=spans[name][1] - start,
            last=spans[name][2] - start,
            columns=_columns(topic),
        )
        for name, topic in described.items()
        if name in spans
    ]


def _columns(topic: dict[str, Any]) -> list[RecordedColumn]:
    if topic["kind"] != "rows":
        return [RecordedColumn(name=field["name"], unit="", meaning="") for field in topic["fields"]]
    fields = [field for field in topic["fields"] for _ in range(field["count"])]
    return [
        RecordedColumn(name=name, unit=field["unit"], meaning=field["meaning"])
        for name, field in zip(row_layout(topic).names, fields, strict=True)
    ]
