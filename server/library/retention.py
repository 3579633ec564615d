"""The deletion of removed and expired sessions in small transactions, while recording goes on.

A session moves to the bin first. When it leaves the bin it is marked and hidden; then its chunks are deleted,
a few in each transaction, so that the recorder can commit in between. Finally the free pages are returned to
the disk, a few at a time as well (the database's auto_vacuum is incremental).
"""

import asyncio
import logging
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from math import inf
from time import time
from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, Connection, UpdateBase, case, delete, update
from sqlmodel import col, func, select

from robot_runtime.clock import Clock
from server.library.config import read_rules
from server.library.film_removal import FilmRemoval
from server.library.storage import free_for_recordings
from server.platform.models import (
    BookmarkRow,
    Chunk,
    Gap,
    SessionFiguresRow,
    SessionRow,
    SessionTag,
    SummaryRow,
)
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store, StoreError
from server.platform.wall_clock import DAY, SOFTWARE_MADE, WallClock, is_set
from server.recording.session import HIDDEN, REMOVING

log = logging.getLogger(__name__)

PERIOD = 60.0
"""s between two runs."""
CHUNKS_AT_ONCE = 32
ROWS_AT_ONCE = 1000
"""Gaps or bookmarks."""
PAGES_AT_ONCE = 64
PAUSE = 0.02
"""s between two such steps, which leave the disk to the recorder."""
BIN_SECONDS = 3600.0
"""Shortest time in the bin for sessions that a rule deletes, even while space is short."""
NAMES_SHOWN = 3


class _Candidate(NamedTuple):
    """A session that a rule may delete."""

    id: int
    name: str
    bytes: int
    started: float
    deleted: float | None
    archived: float | None


class RetentionWorker:
    """The only task that removes sessions; `wake` starts it at once, `on_purge` is called before each goes.

    For a day after a jump of the wall clock no session is deleted for its age, since that is unknown.
    """

    def __init__(
        self,
        store: Store,
        settings: Settings,
        notices: Notices,
        clock: Clock,
    ) -> None:
        self.on_purge: list[Callable[[int], None]] = []
        self._store = store
        self._films = FilmRemoval(store)
        self._settings = settings
        self._rules = read_rules(settings)
        self._notices = notices
        self._clock = clock
        self._wall_clock = WallClock(clock, settings.data.wall_clock)
        self._binned: dict[int, float] = {}
        """By the numbers of sessions in the bin: when they were seen there first (s, steady clock)."""
        self._requested = asyncio.Event()
        self._out_of_candidates = False

    def wake(self) -> None:
        """Run soon."""
        self._requested.set()

    async def run(self) -> None:
        """Apply the rules every minute."""
        while True:
            self._requested.clear()
            try:
                await self.apply(time())
            except (StoreError, OSError) as problem:
                log.warning("the rules of retention cannot be applied: %s", problem)
            # Not wait_for: in Python 3.11 it ignores a cancellation that comes with the request.
            with suppress(TimeoutError):
                async with asyncio.timeout(PERIOD):
                    await self._requested.wait()

    async def apply(self, now: float) -> None:
        """Apply the rules once, at this time (UTC, s since 1970). Raise StoreError."""
        rules = self._rules
        ages_known = self._wall_clock.knows_ages(now)
        # A full disk must not hinder what makes room.
        with suppress(OSError):
            await asyncio.to_thread(self._wall_clock.store)
        if ages_known:
            await self._empty_bin(now - rules.undo_days * DAY)
        if ages_known and rules.keep_days > 0:
            await self._expire_old(now, now - rules.keep_days * DAY)
        if rules.keep_free > 0:
            await self._make_room(now, now - BIN_SECONDS if ages_known else -inf)
        for session in await self._find_removed():
            for see_purged in self.on_purge:
                see_purged(session)
            await self._remove(session)
        await self._free_pages()
        await self._store.make_reserve()

    async def _empty_bin(self, before: float) -> None:
        expired = col(SessionRow.deleted).between(SOFTWARE_MADE, before)
        await self._free(update(SessionRow).where(expired).values(state=REMOVING))

    async def _expire_old(self, now: float, before: float) -> None:
        # A session of an impossible date has no known age.
        rows = [row for row in await self._unprotected() if is_set(row.started) and row.started < before]
        if rows:
            days = self._rules.keep_days
            await self._change(rows, deleted=now)
            self._notify(rows, f"Older than {days:g} days")

    async def _make_room(self, now: float, settled_before: float) -> None:
        needed = -await asyncio.to_thread(free_for_recordings, self._store, self._settings)
        if needed <= 0:
            self._out_of_candidates = False
            return
        binned = await self._find(col(SessionRow.deleted).is_not(None))
        steady = self._clock.now()
        self._binned = {session.id: self._binned.get(session.id, steady) for session in binned}
        settled = [
            session
            for session in binned
            if (session.deleted or now) <= settled_before or steady - self._binned[session.id] >= BIN_SECONDS
        ]
        going = _first(sorted(settled, key=lambda session: session.deleted or now), needed)
        await self._change(going, state=REMOVING)
        # Sessions that are new in the bin will be removed by the same rule, and free their space.
        needed -= sum(session.bytes for session in binned if session in going or session not in settled)
        if needed <= 0:
            return
        unprotected = await self._unprotected()
        elsewhere = _first([row for row in unprotected if row.archived is not None], needed)
        if elsewhere:
            await self._change(elsewhere, deleted=now)
            self._notify(
                elsewhere, f"Less than {self._rules.keep_free:g} GB of the disk are free, and a lab has them"
            )
            needed -= sum(session.bytes for session in elsewhere)
        if needed <= 0:
            return
        candidates = [row for row in unprotected if row.archived is None]
        needed = await self._remove_films(candidates, needed)
        if needed <= 0:
            return
        rows = _first(candidates, needed)
        if rows:
            await self._change(rows, deleted=now)
            self._notify(
                rows,
                f"Less than {self._rules.keep_free:g} GB of the disk are free",
            )
        elif not self._out_of_candidates:
            self._out_of_candidates = True
            self._notices.notify(
                "storage",
                "caution",
                "Disk space is short, and every session is protected, tagged or in the bin. Delete some, or "
                "free space on the computer that holds the data folder.",
            )

    async def _remove_films(self, candidates: list[_Candidate], needed: int) -> int:
        """Remove the oldest films; return the bytes that are needed still."""
        removed = list[_Candidate]()
        filmed = await self._films.filmed()
        for candidate in candidates:
            if needed > 0 and candidate.id in filmed:
                needed -= await self._films.measure(candidate.id)
                await self._films.remove(candidate.id)
                removed.append(candidate)
        if removed:
            text = (
                f"Less than {self._rules.keep_free:g} GB of the disk are free: the film of {_name(removed)} "
                "was removed; the samples remain. To keep a film, mark its session as kept."
            )
            self._notices.notify("storage", "caution", text)
        return needed

    def _notify(self, rows: list[_Candidate], why: str) -> None:
        text = f"{why}: {_name(rows)} went into the bin. To keep one, restore it and mark it as kept."
        self._notices.notify("storage", "caution", text)

    async def _unprotected(self) -> list[_Candidate]:
        """Return the sessions that a rule may delete, oldest first."""
        tagged = select(SessionTag.session_id)
        return await self._find(
            col(SessionRow.state) != "recording",
            col(SessionRow.deleted).is_(None),
            col(SessionRow.kept).is_(False),
            col(SessionRow.id).not_in(tagged),
        )

    async def _find(self, *conditions: ColumnElement[bool]) -> list[_Candidate]:
        row = SessionRow
        columns = [getattr(row, name) for name in _Candidate._fields]
        query: Any = select(*columns).order_by(col(row.started))
        query = query.where(col(row.state).not_in(HIDDEN), *conditions)

        def read() -> list[_Candidate]:
            with self._store.read() as database:
                return [_Candidate(*row) for row in database.exec(query)]

        return await asyncio.to_thread(read)

    async def _change(self, sessions: list[_Candidate], **values: object) -> None:
        chosen = (
            col(SessionRow.id).in_([session.id for session in sessions]),
            col(SessionRow.state) != "recording",
        )
        await self._free(update(SessionRow).where(*chosen).values(values))

    async def _free(self, change: UpdateBase) -> None:
        await self._store.write(lambda connection: connection.execute(change), frees=True)

    async def _find_removed(self) -> Sequence[int]:
        def read() -> Sequence[int]:
            with self._store.read() as database:
                identifiers = database.exec(select(SessionRow.id).where(SessionRow.state == REMOVING)).all()
                return [identifier for identifier in identifiers if identifier is not None]

        return await asyncio.to_thread(read)

    async def _remove(self, session: int) -> None:
        def remove_chunks(connection: Connection) -> int:
            some = select(Chunk.id, func.length(Chunk.data)).where(Chunk.session_id == session)
            rows = connection.execute(some.limit(CHUNKS_AT_ONCE)).all()
            connection.execute(delete(Chunk).where(col(Chunk.id).in_([number for number, _ in rows])))
            # What is left shows on the page how far it is.
            remaining = col(SessionRow.bytes) - sum(size for _, size in rows)
            row = update(SessionRow).where(col(SessionRow.id) == session)
            connection.execute(row.values(bytes=case((remaining > 0, remaining), else_=0)))
            return len(rows)

        while await self._store.write(remove_chunks) > 0:
            await asyncio.sleep(PAUSE)
        for table in (Gap, BookmarkRow):
            rows = select(table.id).where(table.session_id == session).limit(ROWS_AT_ONCE)
            while await self._store.execute(delete(table).where(col(table.id).in_(rows))) > 0:
                await asyncio.sleep(PAUSE)

        def remove_rest(connection: Connection) -> None:
            for table in (SessionTag, SummaryRow, SessionFiguresRow):
                connection.execute(delete(table).where(col(table.session_id) == session))
            connection.execute(delete(SessionRow).where(col(SessionRow.id) == session))

        await self._store.write(remove_rest, frees=True)

    async def _free_pages(self) -> None:
        before, free_pages = None, await self._store.free_some(PAGES_AT_ONCE)
        while free_pages > 0 and free_pages != before:
            await asyncio.sleep(PAUSE)
            before, free_pages = free_pages, await self._store.free_some(PAGES_AT_ONCE)


def _name(sessions: Sequence[_Candidate]) -> str:
    """Return the names of the first sessions, and how many more there are."""
    names = ", ".join(f"“{session.name}”" for session in sessions[:NAMES_SHOWN])
    more = len(sessions) - NAMES_SHOWN
    return f"{names} and {more} more" if more > 0 else names


def _first(sessions: Iterable[_Candidate], needed: int) -> list[_Candidate]:
    """Return the first sessions that together have this many bytes."""
    taken: list[_Candidate] = []
    for session in sessions:
        if needed <= 0:
            break
        taken.append(session)
        needed -= session.bytes
    return taken
