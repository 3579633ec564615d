import asyncio
import json
import sqlite3
import threading
import zlib
from contextlib import closing
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy.exc import OperationalError
from sqlmodel import select

import server.recording.recorder as recorder_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.chunks import decode_rows
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import NUMBERS, Block
from server.library.catalogue import Catalogue
from server.library.content import Recording
from server.platform.models import Gap
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store, StoreError
from server.recording.recorder import Recorder, RecordingRefusedError
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, picture_block
from tests.server.recording.recorder_rig import RecorderRig
from tests.server.waiting import SECONDS, until


@pytest.fixture
def rig(store: Store, settings: Settings) -> RecorderRig:
    return RecorderRig(store, settings)


async def test_received_samples_are_stored_unchanged_and_in_order(rig: RecorderRig) -> None:
    await rig.start()
    blocks = [depth_block(0, 5), depth_block(5, 5), depth_block(10, 5)]
    rig.recorder.add(blocks[0])
    rig.recorder.add(blocks[1])
    await rig.recorder.flush()
    rig.recorder.add(blocks[2])
    await rig.recorder.flush()
    stored = rig.chunks()
    assert [(chunk.number, chunk.first, chunk.count) for chunk in stored] == [(0, 0, 10), (1, 10, 5)]
    size = BY_NAME["depth"].row_bytes
    assert b"".join(decode_rows(chunk.data, size) for chunk in stored) == b"".join(
        block.payload for block in blocks
    )
    assert (stored[0].first_time, stored[0].last_time) == (100.0, pytest.approx(100.18))
    assert rig.gaps() == []


async def test_what_gathers_while_writing_takes_long_becomes_chunks_that_readers_accept(
    rig: RecorderRig,
) -> None:
    await rig.start()
    for number in range(5):
        rig.recorder.add(debug_block(number, "x" * 1_500_000))
    await rig.recorder.flush()
    stored = rig.chunks("debug")
    assert [(chunk.first, chunk.count) for chunk in stored] == [(0, 2), (2, 2), (4, 1)]
    assert all(len(zlib.decompress(chunk.data)) <= recorder_module.SPAN_BYTES_MAX for chunk in stored)
    assert rig.gaps() == []


async def test_nothing_is_stored_outside_a_session(rig: RecorderRig) -> None:
    rig.recorder.add(depth_block(0, 5))
    session = await rig.start()
    rig.recorder.add(depth_block(5, 5))
    await rig.recorder.stop(session)
    rig.recorder.add(depth_block(10, 5))
    assert rig.recorder._gathered.spans == []
    second = await rig.start()
    await rig.recorder.stop(second)
    assert rig.numbers() == list(range(5, 10))


async def test_pictures_are_not_recorded(rig: RecorderRig) -> None:
    session = await rig.start()
    rig.recorder.add(picture_block(0))
    assert (await rig.recorder.stop(session)).samples == 0


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(1, 4)), min_size=1, max_size=15))
def test_gaps_are_counted_and_split_chunks(
    steps: list[tuple[int, int]],
) -> None:
    recorder = Recorder(None, SimulatedClock(), Notices(SimulatedClock(), lambda _: None), lambda: None)  # type: ignore[arg-type]
    recorder._accepts = True
    first = NUMBERS - 10
    expected: list[int] = []
    missed = 0
    for index, (hole, count) in enumerate(steps):
        missed += hole if index else 0
        first += hole
        recorder.add(depth_block(first % NUMBERS, count))
        expected += [number % NUMBERS for number in range(first, first + count)]
        first += count
    runs = recorder._gathered.spans
    assert [(run.first + position) % NUMBERS for run in runs for position in range(run.count)] == expected
    gaps = {position: gap["missed"] for position, gap in recorder._gathered.gaps.items()}
    assert gaps == ({("depth", "missed"): missed} if missed else {})


async def test_a_restarted_numbering_begins_a_new_chunk(rig: RecorderRig) -> None:
    session = await rig.start()
    rig.recorder.add(depth_block(1000, 5))
    rig.recorder.add(depth_block(0, 5))
    rig.recorder.add(depth_block(7, 1))
    await rig.recorder.stop(session)
    assert [(chunk.first, chunk.count) for chunk in rig.chunks()] == [(1000, 5), (0, 5), (7, 1)]
    assert sorted(rig.gaps()) == [("depth", "missed", 2), ("depth", "restarted", 0)]


async def test_a_gap_has_the_time_of_its_discovery_even_when_stored_later(
    rig: RecorderRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = await rig.start()
    rig.clock.forward(1)
    rig.recorder.add(depth_block(0, 1))
    rig.recorder.add(depth_block(3, 1))
    rig.clock.forward(1)
    with monkeypatch.context() as broken:
        rig.fail(broken)
        with pytest.raises(StoreError):
            await rig.recorder.flush()
    rig.recorder.add(depth_block(5, 1))
    await rig.recorder.stop(session)
    assert rig.gaps() == [("depth", "missed", 3)]
    with rig.store.read() as database:
        assert database.exec(select(Gap.time)).all() == [51.0]


async def test_numbers_wrap_without_a_gap(rig: RecorderRig) -> None:
    session = await rig.start()
    rig.recorder.add(depth_block(NUMBERS - 2, 2))
    rig.recorder.add(depth_block(0, 2))
    await rig.recorder.stop(session)
    assert rig.numbers() == [NUMBERS - 2, NUMBERS - 1, 0, 1]
    assert rig.gaps() == []


async def test_a_session_counts_its_stored_samples(rig: RecorderRig) -> None:
    session = await rig.start("first")
    rig.recorder.add(depth_block(0, 5))
    rig.recorder.add(debug_block(0, "a", "b"))
    rig.clock.forward(2.5)
    await rig.recorder.flush()
    (shown,) = Catalogue(rig.store).page().sessions
    assert (shown.samples, shown.duration, shown.state, shown.ended) == (7, 2.5, "recording", None)
    assert shown.bytes == sum(len(chunk.data) for chunk in rig.chunks() + rig.chunks("debug"))
    assert shown == rig.recorder.session
    rig.clock.forward(1)
    done = await rig.recorder.stop(session)
    assert (done.state, done.duration) == ("complete", 3.5)
    assert done.ended is not None
    assert done == Catalogue(rig.store).page().sessions[0]
    row = find_row(rig.store, session)
    assert row.configuration == rig.settings.config.read_text()
    assert rig.notice_texts == ["Recording of “first” has begun.", "Recording of “first” has ended."]


async def test_one_session_at_a_time(rig: RecorderRig) -> None:
    session = await rig.start()
    with pytest.raises(RecordingRefusedError, match="stop it first"):
        await rig.start()
    with pytest.raises(RecordingRefusedError):
        await rig.recorder.stop(session + 1)
    await rig.recorder.stop(session)
    with pytest.raises(RecordingRefusedError):
        await rig.recorder.stop(session)
    assert await rig.start() == session + 1


async def test_samples_wait_while_the_database_fails_and_are_stored_later(
    rig: RecorderRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = await rig.start()
    with monkeypatch.context() as broken:
        rig.fail(broken)
        for number in range(3):
            rig.recorder.add(depth_block(5 * number, 5))
            with pytest.raises(StoreError, match="disk is full"):
                await rig.recorder.flush()
        assert rig.numbers() == []
        with pytest.raises(StoreError):
            await rig.recorder.stop(session)
    assert rig.recorder.session is not None
    rig.recorder.add(depth_block(15, 5))
    done = await rig.recorder.stop(session)
    assert rig.numbers() == list(range(20))
    assert (rig.gaps(), done.samples) == ([], 20)


async def test_waiting_samples_beyond_the_memory_limit_are_counted_as_lost(
    rig: RecorderRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_module, "BACKLOG_BYTES", 1000)

    session = await rig.start()
    with monkeypatch.context() as broken:
        rig.fail(broken)
        for number in range(50):
            rig.recorder.add(depth_block(5 * number, 5))
            with pytest.raises(StoreError):
                await rig.recorder.flush()
    await rig.recorder.stop(session)
    stored = rig.numbers()
    assert stored == list(range(stored[0], 250))
    assert 0 < len(stored) < 250
    assert rig.gaps() == [("depth", "not stored", 250 - len(stored))]


async def test_the_memory_limit_holds_also_while_another_program_has_the_database(
    rig: RecorderRig, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_module, "BACKLOG_BYTES", 1000)

    session = await rig.start()
    with closing(sqlite3.connect(settings.data.database, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        rig.recorder.add(depth_block(0, 500))
        rig.recorder.add(debug_block(0, "stays"))
        with pytest.raises(StoreError):
            await rig.recorder.flush()
    await rig.recorder.stop(session)
    assert (rig.numbers("depth"), rig.numbers("debug")) == ([], [0])
    assert rig.gaps() == [("depth", "not stored", 500)]


async def test_failure_and_recovery_are_reported_once_each(
    rig: RecorderRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_module, "PERIOD", 0.005)

    session = await rig.start()
    work = asyncio.create_task(rig.recorder.run())
    with monkeypatch.context() as broken:
        rig.fail(broken)
        await until(lambda: rig.store.failing, "the failure")
        rig.recorder.add(depth_block(0, 5))
        await until(lambda: len(rig.notice_texts) == 2, "the alarm")
        await asyncio.sleep(0.05)
    await until(lambda: len(rig.notice_texts) == 3, "the all-clear")
    await until(lambda: rig.numbers() == list(range(5)), "the rows")
    work.cancel()
    await rig.recorder.stop(session)
    assert [text.split(":")[0] for text in rig.notice_texts[1:3]] == [
        "Nothing can be stored",
        "Storing works again.",
    ]


async def test_writing_is_retried_without_a_session(
    rig: RecorderRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_module, "PERIOD", 0.002)

    def refuse(*_: object) -> None:
        raise OperationalError("INSERT", {}, sqlite3.OperationalError("disk I/O error"))

    with monkeypatch.context() as broken:
        broken.setattr(recorder_module, "insert_row", refuse)
        with pytest.raises(StoreError, match="SD card"):
            await rig.start()
    assert rig.recorder.session is None
    work = asyncio.create_task(rig.recorder.run())
    await until(lambda: rig.store.failing is None, "the recovery")
    await until(lambda: rig.notice_texts == ["Storing works again."], "the all-clear")
    work.cancel()


async def test_invalid_samples_are_counted_and_the_others_stored(rig: RecorderRig) -> None:
    session = await rig.start()
    bad = debug_block(0, "x")
    rig.recorder.add(Block(bad.topic, 2, 0, b"\0" * 12 + b"no JSON"))
    rig.recorder.add(depth_block(0, 5))
    done = await rig.recorder.stop(session)
    assert (rig.numbers(), done.samples) == (list(range(5)), 5)
    assert rig.gaps() == [("debug", "damaged", 2)]


async def test_a_cancelled_flush_stores_everything_once(
    rig: RecorderRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    writing, gate = threading.Event(), threading.Event()
    insert = recorder_module._insert

    def insert_slowly(*arguments: Any) -> None:
        writing.set()
        assert gate.wait(SECONDS)
        insert(*arguments)

    monkeypatch.setattr(recorder_module, "_insert", insert_slowly)

    session = await rig.start()
    rig.recorder.add(depth_block(0, 5))
    flush = asyncio.create_task(rig.recorder.flush())
    await until(writing.is_set, "the writer")
    flush.cancel()
    rig.recorder.add(depth_block(5, 5))
    gate.set()
    await rig.recorder.stop(session)
    assert rig.numbers() == list(range(10))


async def test_a_session_interrupted_by_a_crash_is_marked_and_keeps_its_chunks(rig: RecorderRig) -> None:
    await rig.start()
    rig.recorder.add(depth_block(0, 5))
    rig.clock.forward(4)
    await rig.recorder.flush()
    after = RecorderRig(rig.store, rig.settings)
    remaining = await after.recorder.recover()
    assert remaining is not None
    await after.recorder.resume(remaining, {})
    (session,) = Catalogue(rig.store).page().sessions
    assert (session.state, session.samples, session.duration) == ("interrupted", 5, 4)
    assert session.ended is not None
    assert (session.ended - session.started).total_seconds() == pytest.approx(4, abs=1e-5)
    assert after.numbers() == list(range(5))
    await after.start("next")
    assert [session.state for session in Catalogue(rig.store).page().sessions] == ["recording", "interrupted"]


async def test_a_session_begins_with_the_parameters_in_force(rig: RecorderRig, store: Store) -> None:
    def parameters_block(number: int, kp: float) -> Block:
        listed = [{"name": "depth.pid.kp", "value": kp}]
        payload = json.dumps([{"time": 40.0 + number, "parameters": listed}]).encode()
        return Block.of(BY_NAME["parameters"], 1, number, payload)

    for number, kp in enumerate((3.0, 4.0)):
        rig.recorder.add(parameters_block(number, kp))
    await rig.start()
    rig.recorder.add(parameters_block(2, 5.0))
    await rig.recorder.flush()
    row = find_row(store, 1)
    documents = list(Recording(store, row).documents("parameters"))
    assert [(document["time"], document["parameters"][0]["value"]) for document in documents] == [
        (50.0, 4.0),
        (42.0, 5.0),
    ]
    assert rig.numbers("parameters") == [1, 2]
    assert rig.gaps() == []
