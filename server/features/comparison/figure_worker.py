"""Computes the figures of the sessions of a lab's archive, each once, newest first."""

import asyncio
import logging
from functools import partial
from time import monotonic

from pydantic import TypeAdapter
from sqlalchemy import Connection, delete, insert
from sqlmodel import col, select

from server.analysis.definitions import STORY_FIGURES
from server.analysis.figure_schemas import FigureSet
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.platform.models import SessionFiguresRow, SessionRow
from server.platform.store import Store, StoreError

log = logging.getLogger(__name__)

PERIOD_SECONDS = 10.0
"""Between two looks for sessions without figures."""
AGAIN_SECONDS = 600.0
"""After which a session is tried again whose figures could not be computed, as while the archive is away."""


class FigureWorker:
    """Computes what is missing, in the comparing process, where people's questions go in between."""

    def __init__(self, comparison: ComparisonWorker, store: Store) -> None:
        self._comparison = comparison
        self._store = store
        self._failed: dict[int, float] = {}
        """Times of failures (s, steady clock), by the sessions' numbers."""

    async def run(self) -> None:
        """Compute what is missing, for ever."""
        while True:
            try:
                await self.compute_missing()
            except StoreError as problem:
                log.warning("the figures of sessions cannot be stored: %s", problem)
            await asyncio.sleep(PERIOD_SECONDS)

    async def compute_missing(self) -> None:
        """Compute the figures that are missing. Raise StoreError."""
        while (session := await asyncio.to_thread(self._find)) is not None:
            try:
                answer = await self._comparison.ask("figures", str(session))
            except ComparisonError as problem:
                log.warning("session %s gets no figures: %s", session, problem)
                self._failed[session] = monotonic()
                continue
            sets = TypeAdapter(list[FigureSet]).validate_json(answer)
            await self._store.write(partial(_store, session=session, sets=sets))

    def _find(self) -> int | None:
        lately = monotonic() - AGAIN_SECONDS
        self._failed = {session: failed for session, failed in self._failed.items() if failed > lately}
        made = select(SessionFiguresRow.session_id)
        query = select(SessionRow.id).where(col(SessionRow.state).in_(("complete", "interrupted")))
        query = query.where(col(SessionRow.id).not_in(made), col(SessionRow.id).not_in([*self._failed]))
        with self._store.read() as database:
            return database.exec(query.order_by(col(SessionRow.id).desc()).limit(1)).first()


def _store(connection: Connection, session: int, sets: list[FigureSet]) -> None:
    """Store the figures of a session, unless it is gone."""
    if connection.execute(select(SessionRow.id).where(SessionRow.id == session)).first() is None:
        return
    connection.execute(delete(SessionFiguresRow).where(col(SessionFiguresRow.session_id) == session))
    rows = [
        {
            "session_id": session,
            **figures.model_dump(exclude={"values"}),
            **{meaning.name: figures.values.get(meaning.name) for meaning in STORY_FIGURES},
        }
        for figures in sets
    ]
    connection.execute(insert(SessionFiguresRow), rows)
