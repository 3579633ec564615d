"""The session of a scenario run, and its bookmarks."""

import asyncio
from time import time

from sqlalchemy import insert
from sqlmodel import col, desc, select

from robot_runtime.clock import Clock
from server.features.scenarios.run import RunRecord
from server.platform.models import BookmarkRow, SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import new_row


def describe_session(settings: Settings, clock: Clock, run: RunRecord, robot_state: str) -> SessionRow:
    """Return the session of a run that begins now."""
    scenario = run.scenario
    row = new_row(settings, clock, scenario.title, scenario.description, robot_state)
    row.origin = "scenario" if run.place == "live" else "simulated"
    row.scenario = run.text
    row.scenario_name = scenario.name
    row.seed = scenario.seed
    return row


async def begin(recorder: Recorder, store: Store, run: RunRecord, row: SessionRow) -> int:
    """Start recording the run, and return the session's number. Raise RecordingRefusedError, StoreError."""
    run.before = await asyncio.to_thread(_find_before, store, row.scenario_name)
    session = await recorder.start(row)
    run.session, run.phase = session.id, "running"
    return session.id


def _find_before(store: Store, name: str) -> int | None:
    older = select(SessionRow.id).where(
        col(SessionRow.scenario_name) == name, col(SessionRow.deleted).is_(None)
    )
    with store.read() as database:
        return database.exec(older.order_by(desc(col(SessionRow.id)))).first()


async def mark(store: Store, session: int, moment: float, text: str) -> None:
    """Add a bookmark at a moment (s, the session's clock). Raise StoreError."""
    values = {"session_id": session, "time": moment, "text": text, "made": time()}
    await store.execute(insert(BookmarkRow).values(values))
