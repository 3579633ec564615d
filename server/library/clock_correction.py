"""The correction of sessions' dates once the computer has the right time.

A Raspberry Pi has no clock of its own while it is off: it starts with an old date, and a time server, or a
person, sets it later. Samples have times of the steady clock, so that only the date of a session's start is
wrong, and by how much is known as long as the computer runs.
"""

import asyncio
import logging
import time
from collections.abc import Callable
from datetime import UTC, datetime

from sqlalchemy import Connection, case, update
from sqlmodel import col, select

from robot_runtime.clock import Clock, boot
from server.library.catalogue import Catalogue
from server.platform.models import BookmarkRow, SessionRow
from server.platform.notices import Notices
from server.platform.store import Store, StoreError
from server.platform.wall_clock import JUMP_SECONDS, is_set, is_synchronised, was_suspended
from server.recording.session import EDITED, REAL_ORIGINS

log = logging.getLogger(__name__)

PERIOD = 10.0
"""s between two looks at the clock."""
MINUTE = "%Y-%m-%d %H:%M"
"""The date in the name that a session gets where nobody names it."""


class ClockCorrection:
    """Correction of the sessions of this start of the computer whose date was unknown at their beginning.

    Those are the sessions of an impossible date; and all of them, where a time server has set the clock while
    this server runs, and the computer was never suspended.
    """

    def __init__(
        self,
        store: Store,
        notices: Notices,
        clock: Clock,
        catalogue: Catalogue,
        synchronised: Callable[[], bool] = is_synchronised,
        suspended: Callable[[], bool] = was_suspended,
    ) -> None:
        self._store = store
        self._notices = notices
        self._clock = clock
        self._catalogue = catalogue
        self._synchronised = synchronised
        self._suspended = suspended
        self._was_unknown = False

    async def run(self) -> None:
        """Check the clock for ever."""
        while True:
            try:
                await self.apply(time.time())
            except StoreError as problem:
                log.warning("the dates of sessions cannot be corrected: %s", problem)
            await asyncio.sleep(PERIOD)

    async def apply(self, now: float) -> None:
        """Check once, at this time (UTC, s since 1970). Raise StoreError."""
        known = self._synchronised()
        ahead = now - self._clock.now()
        all_of_them = known and self._was_unknown and not self._suspended()
        if is_set(now):
            rows = await asyncio.to_thread(self._find_wrong, ahead, all_of_them=all_of_them)
            if rows:
                await self._store.write(lambda connection: _correct(connection, rows, ahead, now))
                for row in rows:
                    if row.state == "recording" and row.id is not None:
                        self._catalogue.notify(row.id)
                self._notices.notify("clock", "info", _describe(rows, ahead))
        # Only what is corrected is forgotten: a database that fails is tried again.
        self._was_unknown = not known

    def _find_wrong(self, ahead: float, *, all_of_them: bool) -> list[SessionRow]:
        query = select(SessionRow).where(SessionRow.boot == boot(), col(SessionRow.origin).in_(REAL_ORIGINS))
        with self._store.read() as database:
            rows = database.exec(query).all()
        return [
            row
            for row in rows
            if abs(ahead - (row.started - row.started_steady)) > JUMP_SECONDS
            and (all_of_them or not is_set(row.started))
        ]


def _correct(connection: Connection, rows: list[SessionRow], ahead: float, now: float) -> None:
    for row in rows:
        right = row.started_steady + ahead
        late = right - row.started
        written, shown = (
            f"{datetime.fromtimestamp(moment, UTC):{MINUTE}}" for moment in (row.started, right)
        )
        connection.execute(
            update(SessionRow)
            .where(col(SessionRow.id) == row.id)
            .values(
                started=right,
                # What happened by the right clock already has no date in the future.
                ended=None if row.ended is None else min(row.ended + late, now),
                deleted=None if row.deleted is None else min(row.deleted + late, now),
                name=row.name.replace(written, shown),
                **EDITED,
            )
        )
        connection.execute(
            update(BookmarkRow)
            .where(col(BookmarkRow.session_id) == row.id)
            .values(made=case((col(BookmarkRow.made) + late < now, col(BookmarkRow.made) + late), else_=now))
        )


def _describe(rows: list[SessionRow], ahead: float) -> str:
    first = min(rows, key=lambda row: row.started_steady)
    before, after = (
        f"{datetime.fromtimestamp(moment, UTC):{MINUTE}}"
        for moment in (first.started, first.started_steady + ahead)
    )
    sessions = "1 session has its" if len(rows) == 1 else f"{len(rows)} sessions have their"
    return f"The computer's clock was set: {sessions} right date now ({before} was {after} UTC)."
