"""Bookmarks: moments of a session, each with a note if somebody wrote one, made while it records or later."""

from datetime import UTC, datetime
from time import time

from sqlalchemy import Connection, delete, update
from sqlmodel import Session, col, func, select

from robot_runtime.clock import Clock
from server.library.schemas import SHOWN_MAX, Bookmark
from server.platform.edited_meanwhile import ChangedMeanwhileError
from server.platform.errors import NotFoundError
from server.platform.limits import NOTES_MAX
from server.platform.models import BookmarkRow, SessionRow
from server.platform.store import Store, insert_row
from server.recording.recorder import Recorder
from server.recording.session import EDITED, SessionStateError, require

NAME_MAX = 500
"""Characters of a bookmark's name."""


class UnknownBookmarkError(NotFoundError):
    """The session has no such bookmark"""


class Bookmarks:
    """The bookmarks of all sessions. Times are in s since the session's start.

    Every method raises StoreError, UnknownSessionError, UnknownBookmarkError, and SessionStateError for a
    time beyond the session's end, and where the session would have more than `SHOWN_MAX` bookmarks, or
    `NOTES_MAX` characters of notes.
    """

    def __init__(self, store: Store, clock: Clock, recorder: Recorder) -> None:
        self._store = store
        self._clock = clock
        self._recorder = recorder

    async def add(self, session: int, moment: float | None, text: str) -> Bookmark:
        """Add a bookmark; the moment None is now, in a session that records."""
        now = self._now(session)

        def write(connection: Connection) -> Bookmark:
            start, duration = _span(connection, session)
            steady = _resolve(moment, start, duration, now)
            _require_room(connection, session, text)
            made = time()
            values = {"session_id": session, "time": steady, "text": text, "made": made}
            number = insert_row(connection, BookmarkRow, values)
            _count_edit(connection, session)
            return _describe(number, steady - start, text, made)

        return await self._store.write(write)

    async def add_once(self, session: int, steady: float, text: str) -> bool:
        """Add a bookmark at a time of the steady clock (s).

        Return False where it exists already, or precedes the session's start.
        """

        def write(connection: Connection) -> bool:
            start, _ = _span(connection, session)
            there = select(BookmarkRow.id).where(
                BookmarkRow.session_id == session, BookmarkRow.time == steady, BookmarkRow.text == text
            )
            if steady < start or connection.execute(there).first() is not None:
                return False
            _require_room(connection, session, text)
            values = {"session_id": session, "time": steady, "text": text, "made": time()}
            insert_row(connection, BookmarkRow, values)
            _count_edit(connection, session)
            return True

        return await self._store.write(write)

    async def change(
        self, session: int, mark: int, moment: float | None, text: str | None, base: str | None = None
    ) -> Bookmark:
        """Change time or note of a bookmark; None leaves it unchanged.

        `base` is the note that the editing began from. Raise ChangedMeanwhileError.
        """
        now = self._now(session)

        def write(connection: Connection) -> Bookmark:
            start, duration = _span(connection, session)
            row = _find_mark(connection, session, mark)
            if text is not None and base is not None and row.text not in (base, text):
                raise ChangedMeanwhileError(f"The note at {row.time - start:.1f} s", "")
            if moment is not None:
                row.time = _resolve(moment, start, duration, now)
            if text is not None:
                if len(text) > len(row.text):
                    _require_characters(connection, session, len(text) - len(row.text))
                row.text = text
            connection.execute(
                update(BookmarkRow).where(col(BookmarkRow.id) == mark).values(time=row.time, text=row.text)
            )
            _count_edit(connection, session)
            return _describe(mark, row.time - start, row.text, row.made)

        return await self._store.write(write)

    async def remove(self, session: int, mark: int) -> None:
        """Remove a bookmark."""

        def write(connection: Connection) -> None:
            require(connection, session)
            _find_mark(connection, session, mark)
            connection.execute(delete(BookmarkRow).where(col(BookmarkRow.id) == mark))
            _count_edit(connection, session)

        await self._store.write(write, frees=True)

    def _now(self, session: int) -> float | None:
        """Return the present steady time for the session that records; None for any other."""
        active = self._recorder.session
        return self._clock.now() if active is not None and active.id == session else None


def select_bookmarks(database: Session, session: int | None, start: float) -> list[Bookmark]:
    """Return the first `SHOWN_MAX` bookmarks by time; the session began at `start` (s, steady clock)."""
    row = BookmarkRow
    query = select(row.id, row.time, row.text, row.made).where(row.session_id == session)
    rows = database.exec(query.order_by(col(row.time), col(row.id)).limit(SHOWN_MAX))
    return [_describe(number or 0, time - start, text, made) for number, time, text, made in rows]


def _describe(number: int, time: float, text: str, made: float) -> Bookmark:
    return Bookmark(
        id=number, time=time, text=text, name=name_note(text), made=datetime.fromtimestamp(made, UTC)
    )


def name_note(text: str) -> str:
    """Return the name of a bookmark: its note's first line, without what makes it a heading in Markdown."""
    first, *_ = text.strip().splitlines() or [""]
    return first.lstrip("#").strip()[:NAME_MAX]


def _find_mark(connection: Connection, session: int, mark: int) -> BookmarkRow:
    query = select(BookmarkRow.time, BookmarkRow.text, BookmarkRow.made).where(
        BookmarkRow.id == mark, BookmarkRow.session_id == session
    )
    span = connection.execute(query).first()
    if span is None:
        raise UnknownBookmarkError(f"Session {session} has no bookmark {mark}.")
    return BookmarkRow(id=mark, session_id=session, time=span.time, text=span.text, made=span.made)


def _count_edit(connection: Connection, session: int) -> None:
    connection.execute(update(SessionRow).where(col(SessionRow.id) == session).values(EDITED))


def _require_room(connection: Connection, session: int, text: str) -> None:
    count = select(func.count()).select_from(BookmarkRow).where(BookmarkRow.session_id == session)
    if connection.execute(count).scalar_one() >= SHOWN_MAX:
        raise SessionStateError(f"This session has {SHOWN_MAX} bookmarks, the most it may. Remove one first.")
    _require_characters(connection, session, len(text))


def _require_characters(connection: Connection, session: int, more: int) -> None:
    lengths = select(func.coalesce(func.sum(func.length(BookmarkRow.text)), 0)).where(
        BookmarkRow.session_id == session
    )
    if connection.execute(lengths).scalar_one() + more > NOTES_MAX:
        raise SessionStateError(
            f"The notes at this session's bookmarks would have more than {NOTES_MAX} characters, the most "
            "they may. Shorten or remove one first."
        )


def _span(connection: Connection, session: int) -> tuple[float, float]:
    """Return the start (s, steady clock) and the duration (s) of a session. Raise UnknownSessionError."""
    require(connection, session)
    query = select(SessionRow.started_steady, SessionRow.duration).where(SessionRow.id == session)
    start, duration = connection.execute(query).one()
    return start, duration


def _resolve(moment: float | None, start: float, duration: float, now: float | None) -> float:
    if moment is None:
        if now is None:
            raise SessionStateError("This session no longer records. Give the time of the bookmark.")
        return now
    end = duration if now is None else now - start
    if moment > end:
        raise SessionStateError(f"{moment:.1f} s is beyond the end of the session, which lasts {end:.1f} s.")
    return start + moment
