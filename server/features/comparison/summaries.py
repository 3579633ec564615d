"""Makes the summaries that the list of sessions shows, one after the other, newest first."""

import asyncio
import logging
from datetime import UTC, datetime
from functools import partial

from sqlalchemy import Connection, insert, update
from sqlmodel import col, select

from server.analysis.session_name import name_from
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.platform.models import SessionRow, SummaryRow
from server.platform.store import Store, StoreError
from server.recording.recorder import Recorder
from server.recording.schemas import SessionSummary
from server.recording.session import EDITED, REAL_ORIGINS, has_default_name
from server.stream.hub import Hub

log = logging.getLogger(__name__)

TICK_SECONDS = 1.0
"""Between two looks at whether a recording has ended."""
PERIOD_SECONDS = 10.0
"""Between two looks for sessions without a summary, such as imported ones."""


class SummaryWorker:
    """Makes the summaries of sessions that have ended, while nothing is recorded: reading them takes time.

    The pages are told of each.
    """

    def __init__(self, comparison: ComparisonWorker, store: Store, recorder: Recorder, hub: Hub) -> None:
        self._comparison = comparison
        self._store = store
        self._recorder = recorder
        self._hub = hub
        self._failed: set[int] = set()
        """Not tried again before the next start."""

    async def run(self) -> None:
        """Make what is missing, for ever."""
        loop = asyncio.get_running_loop()
        # The start of the server goes first.
        due, recorded = loop.time() + PERIOD_SECONDS, False
        while True:
            recording = self._recorder.session is not None
            if not recording and (recorded or loop.time() >= due):
                try:
                    await self.make_missing()
                except StoreError as problem:
                    log.warning("the summaries of sessions cannot be stored: %s", problem)
                due = loop.time() + PERIOD_SECONDS
            recorded = recording
            await asyncio.sleep(TICK_SECONDS)

    async def make_missing(self) -> None:
        """Make the summaries that are missing, until a recording begins. Raise StoreError."""
        while self._recorder.session is None:
            session = await asyncio.to_thread(self._find)
            if session is None:
                return
            try:
                answer = await self._comparison.ask("summary", str(session))
            except ComparisonError as problem:
                log.warning("session %s gets no summary: %s", session, problem)
                self._failed.add(session)
                continue
            summary = SessionSummary.model_validate_json(answer)
            await self._store.write(partial(_store, session=session, summary=summary))
            self._hub.notify({"op": "summary", "session": session})

    def _find(self) -> int | None:
        made = select(SummaryRow.session_id)
        query = select(SessionRow.id).where(col(SessionRow.state).in_(("complete", "interrupted")))
        query = query.where(col(SessionRow.id).not_in(made), col(SessionRow.id).not_in(self._failed))
        with self._store.read() as database:
            return database.exec(query.order_by(col(SessionRow.id).desc()).limit(1)).first()


def _store(connection: Connection, session: int, summary: SessionSummary) -> None:
    """Store a summary, unless the session is gone, and give it a name where nobody has named it."""
    there = col(SessionRow.id) == session
    columns = select(SessionRow.name, SessionRow.origin, SessionRow.started).where(there)
    row = connection.execute(columns).one_or_none()
    if row is None:
        return
    values = {"session_id": session, "document": summary.model_dump_json()}
    made = select(SummaryRow.session_id).where(SummaryRow.session_id == session)
    if connection.execute(made).first() is None:
        connection.execute(insert(SummaryRow).values(values))
    name = name_from(summary)
    if (
        name
        and row.origin in REAL_ORIGINS
        and has_default_name(row.name, datetime.fromtimestamp(row.started, UTC))
    ):
        connection.execute(update(SessionRow).where(there).values(name=name, **EDITED))
