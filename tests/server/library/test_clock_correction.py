"""A computer that starts with an old date: the sessions, and what is decided by their dates."""

import json
from typing import Any

import pytest
from sqlalchemy import update
from sqlmodel import col, select

from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.library.catalogue import Catalogue
from server.library.clock_correction import ClockCorrection
from server.platform.models import BookmarkRow, SessionRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store, StoreError, insert_row
from server.recording.recorder import Recorder
from server.recording.schemas import Session
from server.recording.session import new_row

RIGHT = 1.9e9
"""s since 1970, when the steady clock is 1000 s."""
AHEAD = RIGHT - 1000.0
OLD, YESTERDAY = 500.0, RIGHT - 86_400.0
"""A clock that was never set, and one that Raspberry Pi OS has continued from its last end."""

BOTH_DATABASES = True


class Pi:
    """A computer whose clock is wrong at first."""

    def __init__(self, store: Store, settings: Settings) -> None:
        self.store = store
        self.settings = settings
        self.clock = SimulatedClock(1000.0)
        self.notice_texts: list[str] = []
        self.changes: list[Session | None] = []
        """The recording session at each of its changes."""
        self.synchronised, self.suspended = False, False
        self.notices = Notices(self.clock, self._hear)
        self.recorder = Recorder(store, self.clock, self.notices, self._see_session)
        self.correction = ClockCorrection(
            store,
            self.notices,
            self.clock,
            Catalogue(store, self.recorder),
            lambda: self.synchronised,
            lambda: self.suspended,
        )

    def _see_session(self) -> None:
        self.changes.append(self.recorder.session)

    def _hear(self, block: Block) -> None:
        self.notice_texts += [
            document["text"] for document in json.loads(block.payload) if document["kind"] == "clock"
        ]

    async def record(self, started: float, name: str = "", **columns: Any) -> int:
        """Return a session that began 1000 s after the computer's start, by a clock that said `started`."""
        row = new_row(self.settings, self.clock, name, "", "null")
        row.started, row.started_steady = started, 1000.0
        for column, value in columns.items():
            setattr(row, column, value)
        session = (await self.recorder.start(row)).id
        await self.recorder.stop(session)
        await self.store.write(
            lambda connection: connection.exec_driver_sql(
                f"UPDATE session SET ended = {started + 10.0} WHERE id = {session}"
            )
        )
        return session

    async def look(self, ahead: float = AHEAD) -> None:
        """Ten seconds pass; the clock is ahead of the steady one by so much."""
        self.clock.forward(10.0)
        await self.correction.apply(self.clock.now() + ahead)

    def row(self, session: int) -> SessionRow:
        with self.store.read() as database:
            return database.exec(select(SessionRow).where(col(SessionRow.id) == session)).one()


@pytest.fixture
def pi(store: Store, settings: Settings) -> Pi:
    return Pi(store, settings)


async def test_pages_get_the_right_date_of_the_session_that_records(pi: Pi) -> None:
    row = new_row(pi.settings, pi.clock, "Armed 1970-01-01 00:08 UTC", "", "null", origin="arming")
    row.started = OLD
    await pi.recorder.start(row)
    report = len(pi.changes)
    await pi.look()
    assert pi.recorder.session is not None
    assert pi.recorder.session.started.timestamp() == RIGHT
    assert pi.recorder.session.name == "Armed 2030-03-17 17:46 UTC"
    assert pi.changes[report:] == [pi.recorder.session]


async def test_a_session_of_1970_has_its_right_date_once_the_clock_is_set(pi: Pi) -> None:
    session = await pi.record(OLD, "Armed 1970-01-01 00:08 UTC", origin="arming")
    mark = {"session_id": session, "time": 1005.0, "text": "here", "made": OLD + 5.0}
    await pi.store.write(lambda connection: insert_row(connection, BookmarkRow, mark))
    await pi.look(OLD - 1000.0)
    assert (pi.row(session).started, pi.notice_texts) == (OLD, [])
    await pi.look()
    row = pi.row(session)
    assert (row.started, row.ended) == (RIGHT, RIGHT + 10.0)
    assert row.name == "Armed 2030-03-17 17:46 UTC"
    with pi.store.read() as database:
        assert database.exec(select(BookmarkRow.made)).one() == RIGHT + 5.0
    assert pi.notice_texts == [
        "The computer's clock was set: 1 session has its right date now "
        "(1970-01-01 00:08 was 2030-03-17 17:46 UTC)."
    ]
    await pi.look()
    assert len(pi.notice_texts) == 1


async def test_nothing_that_happened_after_the_clock_was_set_gets_a_date_in_the_future(pi: Pi) -> None:
    session = await pi.record(OLD)
    await pi.store.execute(update(SessionRow).where(col(SessionRow.id) == session).values(ended=RIGHT + 9.0))
    mark = {"session_id": session, "time": 1009.0, "text": "here", "made": RIGHT + 9.0}
    await pi.store.write(lambda connection: insert_row(connection, BookmarkRow, mark))
    await pi.look()
    assert pi.row(session).ended == RIGHT + 10.0
    with pi.store.read() as database:
        assert database.exec(select(BookmarkRow.made)).one() == RIGHT + 10.0


async def test_a_plausible_but_old_date_is_corrected_when_a_time_server_has_set_the_clock(pi: Pi) -> None:
    session = await pi.record(YESTERDAY)
    await pi.look(YESTERDAY - 1000.0)
    # Somebody sets it by hand: who knows whether that is right.
    await pi.look()
    assert pi.row(session).started == YESTERDAY
    pi.synchronised = True
    await pi.look()
    assert pi.row(session).started == RIGHT


@pytest.mark.parametrize("case", ["always synchronised", "suspended", "another start", "simulated", "import"])
async def test_a_difference_that_has_another_cause_changes_no_date(pi: Pi, case: str) -> None:
    columns = {
        "another start": {"boot": "another"},
        "simulated": {"origin": case},
        "import": {"origin": case},
    }
    session = await pi.record(YESTERDAY, **columns.get(case, {}))
    pi.synchronised = case == "always synchronised"
    pi.suspended = case == "suspended"
    await pi.look()
    pi.synchronised = True
    await pi.look()
    assert (pi.row(session).started, pi.notice_texts) == (YESTERDAY, [])


async def test_the_correction_is_tried_again_where_the_disk_fails(
    pi: Pi, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = await pi.record(YESTERDAY)
    await pi.look(YESTERDAY - 1000.0)
    pi.synchronised = True

    async def write(*_: object) -> None:
        raise StoreError("the disk is full")

    with monkeypatch.context() as failing:
        failing.setattr(pi.store, "write", write)
        with pytest.raises(StoreError, match="full"):
            await pi.look()
    await pi.look()
    assert pi.row(session).started == RIGHT


async def test_a_deleted_session_stays_its_whole_time_in_the_bin(pi: Pi) -> None:
    before, after = await pi.record(OLD), await pi.record(OLD)
    for session, moment in ((before, OLD + 8.0), (after, RIGHT + 9.0)):
        await pi.store.execute(update(SessionRow).where(col(SessionRow.id) == session).values(deleted=moment))
    await pi.look()
    assert [pi.row(number).deleted for number in (before, after)] == [RIGHT + 8.0, RIGHT + 10.0]
