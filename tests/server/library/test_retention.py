"""Retention: sessions removed after their time in the bin, by age, and for space."""

import asyncio
import json
import shutil
from dataclasses import replace
from typing import Any, NamedTuple

import pytest
from sqlalchemy import insert
from sqlmodel import func, select

import server.library.retention as tidying_module
import server.library.storage as storage_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.library.catalogue import Catalogue
from server.library.config import SessionsConfig
from server.library.content import Recording
from server.library.listing import SessionSelection
from server.library.retention import BIN_SECONDS, RetentionWorker
from server.platform.models import Chunk, Gap, SessionRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.platform.wall_clock import DAY
from server.recording.recorder import Recorder
from server.recording.session import REMOVING, new_row
from tests.server.blocks import depth_block, film_block
from tests.server.waiting import SECONDS

NOW = 1.9e9

BOTH_DATABASES = True


class Disk(NamedTuple):
    total: int
    used: int
    free: int


class Keeper:
    """A database with retention, whose sessions can be aged."""

    def __init__(self, store: Store, settings: Settings, rules: SessionsConfig) -> None:
        self.store = store
        self.settings = settings.with_section(rules)
        self.clock = SimulatedClock(50.0)
        self.notice_texts: list[str] = []
        self.notices = Notices(self.clock, self._hear)
        self.recorder = Recorder(store, self.clock, self.notices, lambda: None)
        self.catalogue = Catalogue(store, self.recorder)
        self.retention = RetentionWorker(store, self.settings, self.notices, self.clock)

    def _hear(self, block: Block) -> None:
        self.notice_texts += [document["text"] for document in json.loads(block.payload)]

    async def record(self, name: str, age: float, chunks: int = 3, *, stop: bool = True) -> int:
        row = new_row(self.settings, self.clock, name, "", "null")
        row.started = NOW - age
        row.started_steady = self.clock.now() - age
        session = (await self.recorder.start(row)).id
        for number in range(chunks):
            self.recorder.add(depth_block(100 * number, 100))
            await self.recorder.flush()
        if stop:
            await self.recorder.stop(session)
        return session

    async def age_bin(self, seconds: float) -> None:
        statement = f"UPDATE session SET deleted = {NOW - seconds} WHERE deleted IS NOT NULL"
        await self.store.write(lambda connection: connection.exec_driver_sql(statement))

    def names(self, *, deleted: bool = False) -> list[str]:
        return [session.name for session in self.catalogue.page(SessionSelection(deleted=deleted)).sessions]

    def gaps(self) -> list[tuple[int, str, str, int]]:
        query = select(Gap.session_id, Gap.topic, Gap.kind, Gap.missed).where(Gap.kind == "removed")
        with self.store.read() as database:
            return sorted((*row,) for row in database.exec(query))

    def count(self, table: Any) -> int:
        with self.store.read() as database:
            return int(database.exec(select(func.count()).select_from(table)).one())


NO_RULES = SessionsConfig(keep_free=0.0)


@pytest.fixture
def keeper(store: Store, settings: Settings) -> Keeper:
    return Keeper(store, settings, NO_RULES)


async def test_old_sessions_in_the_bin_are_purged(keeper: Keeper) -> None:
    for name in ("stays", "goes"):
        await keeper.record(name, DAY)
    await keeper.catalogue.delete(2)
    await keeper.age_bin(7 * DAY - 1)
    await keeper.retention.apply(NOW)
    assert keeper.names(deleted=True) == ["goes"]
    await keeper.age_bin(7 * DAY)
    await keeper.retention.apply(NOW)
    assert (keeper.names(), keeper.names(deleted=True)) == (["stays"], [])
    assert (keeper.count(SessionRow), keeper.count(Chunk)) == (1, 3)


async def test_sessions_of_an_impossible_date_have_no_age(store: Store, settings: Settings) -> None:
    keeper = Keeper(store, settings, SessionsConfig(keep_free=0.0, keep_days=0.5))
    for name in ("kept", "binned", "old"):
        await keeper.record(name, DAY if name == "old" else NOW - 500.0)
    await keeper.catalogue.delete(2)
    await keeper.age_bin(NOW - 800.0)
    for _ in range(2):
        await keeper.retention.apply(NOW + keeper.clock.now() - 50.0)
        keeper.clock.forward(2 * DAY)
    assert (keeper.names(), keeper.names(deleted=True)) == (["kept"], ["old", "binned"])


async def test_for_a_day_after_a_clock_jump_nothing_is_purged_by_age(keeper: Keeper) -> None:
    for name in ("stays", "goes"):
        await keeper.record(name, DAY)
    await keeper.catalogue.delete(2)
    await keeper.age_bin(60.0)
    years = 10 * 365 * DAY
    begun = NOW - keeper.clock.now()
    # The wall clock advances with the steady clock, but for one jump.
    for passed, jumped in ((0.0, 0.0), (60.0, years), (DAY - 60.0, years)):
        keeper.clock.forward(passed)
        await keeper.retention.apply(begun + keeper.clock.now() + jumped)
        assert (keeper.names(), keeper.names(deleted=True)) == (["stays"], ["goes"])
    # A server that is started after the jump sees it by the last known time.
    another = RetentionWorker(keeper.store, keeper.settings, keeper.notices, keeper.clock)
    await another.apply(begun + keeper.clock.now() + years)
    assert keeper.names(deleted=True) == ["goes"]
    keeper.clock.forward(60.0)
    await keeper.retention.apply(begun + keeper.clock.now() + years)
    assert (keeper.names(), keeper.names(deleted=True)) == (["stays"], [])


async def test_recording_goes_on_while_a_session_is_removed_in_small_steps(
    monkeypatch: pytest.MonkeyPatch, keeper: Keeper
) -> None:
    monkeypatch.setattr(tidying_module, "CHUNKS_AT_ONCE", 1)
    monkeypatch.setattr(tidying_module, "PAUSE", 0.0)

    await keeper.record("goes", DAY, chunks=40)
    await keeper.catalogue.delete(1)
    await keeper.catalogue.purge(1)
    assert keeper.names(deleted=True) == []
    await keeper.record("records", 0, chunks=0, stop=False)
    removal = asyncio.create_task(keeper.retention.apply(NOW))
    remaining = []
    for number in range(10):
        keeper.recorder.add(depth_block(100 * number, 100))
        await keeper.recorder.flush()
        remaining.append(keeper.count(Chunk))
    await removal
    assert keeper.recorder.session is not None
    assert keeper.recorder.session.samples == 1000
    # Commits passed between the steps, not after them all.
    assert remaining[0] > 30
    assert keeper.count(Chunk) == 10


async def test_an_interrupted_purge_is_resumed(keeper: Keeper) -> None:
    await keeper.record("half gone", DAY)
    await keeper.store.write(
        lambda connection: connection.exec_driver_sql(f"UPDATE session SET state = '{REMOVING}', deleted = 1")
    )
    await keeper.store.write(lambda connection: connection.exec_driver_sql("DELETE FROM chunk WHERE id = 1"))
    await keeper.retention.apply(NOW)
    assert (keeper.count(SessionRow), keeper.count(Chunk)) == (0, 0)


@pytest.mark.parametrize("store", ["sqlite"], indirect=True)
async def test_a_purge_returns_space_to_the_disk(monkeypatch: pytest.MonkeyPatch, keeper: Keeper) -> None:
    monkeypatch.setattr(tidying_module, "PAGES_AT_ONCE", 4)
    monkeypatch.setattr(tidying_module, "PAUSE", 0.0)

    def pages(name: str) -> int:
        with keeper.store.read() as database:
            return int(database.connection().exec_driver_sql(f"PRAGMA {name}").scalar_one())

    await keeper.record("goes", DAY, chunks=60)
    full, held = pages("page_count"), keeper.catalogue.find(1).bytes // pages("page_size")
    await keeper.catalogue.delete(1)
    await keeper.catalogue.purge(1)
    await keeper.retention.apply(NOW)
    assert pages("freelist_count") == 0
    assert pages("page_count") <= full - held


async def test_old_sessions_are_binned_except_protected_tagged_or_recording_ones(
    store: Store, settings: Settings
) -> None:
    keeper = Keeper(store, settings, SessionsConfig(keep_days=30.0, keep_free=0.0))
    for name in ("old", "kept", "tagged"):
        await keeper.record(name, 31 * DAY)
    await keeper.record("young", 29 * DAY)
    await keeper.catalogue.change(2, kept=True)
    await keeper.catalogue.change(3, tags=["thesis"])
    await keeper.record("records", 40 * DAY, stop=False)
    await keeper.retention.apply(NOW)
    assert keeper.names() == ["records", "young", "tagged", "kept"]
    assert keeper.names(deleted=True) == ["old"]
    assert [text for text in keeper.notice_texts if text.startswith("Older")] == [
        "Older than 30 days: “old” went into the bin. To keep one, restore it and mark it as kept."
    ]


async def test_on_a_nearly_full_disk_the_oldest_are_binned_and_purged_after_an_hour(
    monkeypatch: pytest.MonkeyPatch, store: Store, settings: Settings
) -> None:
    free = 10**9
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Disk(10**10, 0, free))

    keeper = Keeper(store, settings, SessionsConfig(keep_free=1.0))

    for index, name in enumerate(("oldest", "older", "newest")):
        await keeper.record(name, (9 - index) * DAY, chunks=60)
    await keeper.retention.apply(NOW)
    assert keeper.names(deleted=True) == []
    size = keeper.catalogue.find(1).bytes
    free = 10**9 - size - 16_384
    await keeper.retention.apply(NOW)
    assert (keeper.names(), keeper.names(deleted=True)) == (["newest"], ["older", "oldest"])
    # Nothing else is removed while these wait in the bin.
    keeper.clock.forward(BIN_SECONDS)
    await keeper.retention.apply(NOW + BIN_SECONDS - 1)
    assert len(keeper.names(deleted=True)) == 2
    await keeper.catalogue.restore(2)
    await keeper.catalogue.change(2, kept=True)
    free = 10**9 - size
    await keeper.retention.apply(NOW + BIN_SECONDS)
    assert (keeper.names(), keeper.names(deleted=True)) == (["newest", "older"], [])
    free = 0
    await keeper.catalogue.change(3, tags=["mine"])
    keeper.clock.forward(BIN_SECONDS)
    for _ in range(2):
        await keeper.retention.apply(NOW + 2 * BIN_SECONDS)
    assert len(keeper.names()) == 2
    assert len([text for text in keeper.notice_texts if "Disk space is short" in text]) == 1


async def test_where_space_is_short_the_oldest_films_go_before_any_session(
    monkeypatch: pytest.MonkeyPatch, store: Store, settings: Settings
) -> None:
    free = 10**9
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Disk(10**10, 0, free))
    keeper = Keeper(store, settings, SessionsConfig(keep_free=1.0))
    for index, name in enumerate(("kept", "oldest", "older", "newest")):
        session = await keeper.record(name, (9 - index) * DAY, stop=False)
        for number in range(50):
            keeper.recorder.add(film_block(number, 50.0 + number, bytes(20_000)))
        await keeper.recorder.stop(session)
    await keeper.catalogue.change(1, kept=True)
    films = storage_module.measure(store, settings).film_bytes
    assert films == pytest.approx(4_000_000, rel=0.01)
    before = [keeper.catalogue.find(number) for number in (1, 2, 3, 4)]
    free = 10**9 - 1_500_000
    await keeper.retention.apply(NOW)
    assert keeper.names() == ["newest", "older", "oldest", "kept"]
    gaps = keeper.gaps()
    assert gaps == [(2, "film", "removed", 50), (3, "film", "removed", 50)]
    assert storage_module.measure(store, settings).film_bytes == films / 2
    for number, row in zip((1, 2, 3, 4), before, strict=True):
        counts = Recording.open(store, number).counts()
        assert counts == {"depth": 300} | ({} if number in (2, 3) else {"film": 50})
        now = keeper.catalogue.find(number)
        assert now.samples == sum(counts.values())
        assert row.bytes - now.bytes == pytest.approx(1_000_000 if number in (2, 3) else 0, abs=2000)
    assert [text for text in keeper.notice_texts if "film" in text] == [
        "Less than 1 GB of the disk are free: the film of “oldest”, “older” was removed; the samples remain. "
        "To keep a film, mark its session as kept."
    ]


@pytest.mark.parametrize("store", ["sqlite"], indirect=True)
def test_free_space_is_read_from_the_real_disk(store: Store, settings: Settings) -> None:
    shown = storage_module.measure(store, settings)
    assert shown.total == shutil.disk_usage(settings.data.path).total
    assert shown.database == settings.data.database.stat().st_size + sum(
        path.stat().st_size for path in settings.data.path.glob("mucat.db-*")
    )


async def test_the_worker_goes_on_where_the_disk_cannot_be_examined(
    store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock, looks = SimulatedClock(), asyncio.Semaphore(0)
    loop = asyncio.get_running_loop()

    def refuse(_: object) -> None:
        loop.call_soon_threadsafe(looks.release)
        raise OSError("Input/output error")

    monkeypatch.setattr(shutil, "disk_usage", refuse)
    rules = settings.with_section(SessionsConfig(keep_free=1.0))
    worker = RetentionWorker(store, rules, Notices(clock, print), clock)
    running = asyncio.create_task(worker.run())
    async with asyncio.timeout(SECONDS):
        await looks.acquire()
        worker.wake()
        await looks.acquire()
    running.cancel()
    await asyncio.wait([running])


async def take_turns(count: int) -> None:
    """Wait for so many turns of the event loop."""
    for _ in range(count):
        await asyncio.sleep(0)


@pytest.mark.parametrize("turns", range(6))
async def test_the_worker_ends_also_where_it_is_asked_to_run_at_that_moment(
    store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch, turns: int
) -> None:
    clock = SimulatedClock()
    worker = RetentionWorker(store, settings, Notices(clock, print), clock)
    applied = asyncio.Event()

    async def apply(_: float) -> None:
        applied.set()

    monkeypatch.setattr(worker, "apply", apply)
    running = asyncio.create_task(worker.run())
    await applied.wait()
    await take_turns(10)
    worker.wake()
    await take_turns(turns)
    running.cancel()
    done, _ = await asyncio.wait([running], timeout=SECONDS)
    running.cancel()
    assert done


async def test_the_bytes_that_are_still_to_be_removed_become_fewer(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, keeper: Keeper
) -> None:
    monkeypatch.setattr(tidying_module, "CHUNKS_AT_ONCE", 1)
    monkeypatch.setattr(tidying_module, "ROWS_AT_ONCE", 2)

    store = keeper.store
    session = await keeper.record("goes", DAY)
    gap = {"session_id": session, "topic": "depth", "kind": "missed", "time": 1.0, "missed": 1}
    await store.write(lambda connection: connection.execute(insert(Gap), [gap] * 5))
    await keeper.catalogue.delete(session)
    await keeper.catalogue.purge(session)
    remaining: list[tuple[int, int]] = []
    write = store.write

    async def watch(*change: Any, **options: Any) -> Any:
        storage = storage_module.measure(store, settings)
        remaining.append((storage.removing, storage.removing_bytes))
        return await write(*change, **options)

    monkeypatch.setattr(store, "write", watch)
    await keeper.retention.apply(NOW)
    sizes = [size for count, size in remaining if count == 1]
    assert sizes == sorted(sizes, reverse=True)
    assert len(set(sizes)) == 4
    assert (sizes[-1], remaining[-1], keeper.count(Gap)) == (0, (0, 0), 0)


async def test_where_space_is_short_what_a_lab_has_goes_first(
    monkeypatch: pytest.MonkeyPatch, store: Store, settings: Settings
) -> None:
    free = 10**9
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Disk(10**10, 0, free))
    keeper = Keeper(store, settings, SessionsConfig(keep_free=1.0))
    for index, name in enumerate(("oldest", "older", "newest")):
        await keeper.record(name, (9 - index) * DAY, chunks=60)
    await keeper.catalogue.note_archived([keeper.catalogue.find(3).identifier, "0" * 32])
    free = 10**9 - 16_384
    await keeper.retention.apply(NOW)
    assert (keeper.names(), keeper.names(deleted=True)) == (["older", "oldest"], ["newest"])
    assert "a lab has them" in keeper.notice_texts[-1]


async def test_a_lab_removes_nothing_by_itself(
    monkeypatch: pytest.MonkeyPatch, store: Store, settings: Settings
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Disk(10**10, 0, 0))
    rules = SessionsConfig(keep_free=1.0, keep_days=1.0)
    keeper = Keeper(store, replace(settings, lab=True), rules)
    await keeper.record("old", 9 * DAY)
    await keeper.retention.apply(NOW)
    assert keeper.names() == ["old"]
