"""A range of a session as blocks: limits, order, and sessions of other definitions."""

import asyncio
import json
import zlib
from dataclasses import asdict
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from sqlalchemy import Connection, insert, text, update
from sqlmodel import col

from robot_runtime.contract import documents
from robot_runtime.contract.chunks import CHUNK_BYTES_MAX, encode_rows
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import BY_NAME, TIME
from robot_runtime.transport.blocks import Block, pack_documents, read_blocks, read_rows, row
from server.library.content import Recording, RecordingError
from server.library.replay import LISTED_CHUNKS, RANGE_MAX, read_blocks_between
from server.library.timeline import StateSilence, read_timeline
from server.platform.errors import InvalidError
from server.platform.models import BookmarkRow, Chunk, SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, state_block
from tests.server.features.exports.recordings import STARTED_STEADY, record, record_batches
from tests.server.new_database import new_store
from tests.server.serving import serve


def read(store: Store, session: int) -> Recording:
    row = find_row(store, session)
    return Recording(store, row)


def change(store: Store, statement: str) -> None:
    def run(connection: Connection) -> None:
        connection.execute(text(statement))

    asyncio.run(store.write(run))


def redefine(store: Store, session: int, topic: str, fields: list[dict[str, Any]]) -> None:
    """Change the fields of a topic in the stored description of the session."""
    described = dict(read(store, session).topics)
    described[topic] = {**described[topic], "fields": fields}

    def run(connection: Connection) -> None:
        connection.execute(text("UPDATE session SET topics = :topics"), {"topics": json.dumps(described)})

    asyncio.run(store.write(run))


def depths(data: bytes) -> list[tuple[float, Depth]]:
    results = []
    for block in read_blocks(data):
        if block.topic.name == "depth":
            results += read_rows(block)
    assert all(isinstance(record, Depth) for _, record in results)
    return results  # type: ignore[return-value]


def documents_of(data: bytes, topic: str) -> list[dict[str, Any]]:
    blocks = (block for block in read_blocks(data) if block.topic.name == topic)
    return [document for block in blocks for document in json.loads(block.payload)]


def lines(first: int, count: int, period: float = 0.1) -> Block:
    made = [
        documents.DebugLine(time=100 + period * n, level=1, text=f"line {n}")
        for n in range(first, first + count)
    ]
    return Block.of(BY_NAME["debug"], count, first, pack_documents(made))


@pytest.fixture
def dive(store: Store, settings: Settings) -> Recording:
    """Ten seconds from 100 s on: depths 20 ms apart, lines 100 ms apart, a state each second."""
    batches = [
        [
            depth_block(50 * n, 50),
            lines(10 * n, 10),
            state_block(n, time=100.0 + n, set_point_default=float(n)),
        ]
        for n in range(10)
    ]
    return read(store, record(store, settings, *batches))


def test_a_range_is_cut_at_its_limits(dive: Recording) -> None:
    stretch = read_blocks_between(dive, 102.5, 104.1)
    numbers = [int(record.time) for _, record in depths(stretch.data)]
    assert numbers == list(range(125, 205))
    assert [line["text"] for line in documents_of(stretch.data, "debug")] == [
        f"line {n}" for n in range(25, 41)
    ]
    assert [document["set_point_default"] for document in documents_of(stretch.data, "state")] == [3, 4]
    assert stretch.left_out == 0


def test_blocks_have_numbers_and_come_in_order_of_time(dive: Recording) -> None:
    blocks = read_blocks(read_blocks_between(dive, 102.5, 104.1).data)
    assert [(block.first, block.count) for block in blocks if block.topic.name == "depth"] == [
        (125, 25),
        (150, 50),
        (200, 5),
    ]
    starts = [
        read_rows(block)[0][0] if block.topic.name == "depth" else json.loads(block.payload)[0]["time"]
        for block in blocks
    ]
    assert starts == sorted(starts)


def test_adjacent_ranges_give_every_sample_once(dive: Recording) -> None:
    edges = [100.0, 100.02, 101.999, 102.0, 105.5, 110.0]
    joined = b"".join(read_blocks_between(dive, start, end).data for start, end in pairwise(edges))
    assert [int(record.time) for _, record in depths(joined)] == list(range(500))
    assert len(documents_of(joined, "debug")) == 100
    assert len(documents_of(joined, "state")) == 10


def test_a_seek_returns_the_documents_in_force(store: Store, settings: Settings) -> None:
    batches = [[state_block(0, time=100.0, set_point_default=0.7), lines(0, 1)]]
    batches += [[depth_block(50 * n, 50)] for n in range(20)]
    recording = read(store, record(store, settings, *batches))
    stretch = read_blocks_between(recording, 115.0, 116.0, history=2.0)
    assert [document["set_point_default"] for document in documents_of(stretch.data, "state")] == [0.7]
    assert [document["text"] for document in documents_of(stretch.data, "debug")] == ["line 0"]
    assert [int(record.time) for _, record in depths(stretch.data)] == list(range(650, 800))
    assert BY_NAME["depth"].charted > 0
    # Without a history, only what lies in the range.
    assert {block.topic.name for block in read_blocks(read_blocks_between(recording, 115.0, 116.0).data)} == {
        "depth"
    }


@pytest.mark.parametrize("name", ["beacon", "status", "navigation", "link", "turning"])
def test_a_seek_returns_a_minute_of_what_small_charts_show(
    store: Store, settings: Settings, name: str
) -> None:
    topic = BY_NAME[name]
    record_bytes = bytes(topic.row_bytes - TIME.size)
    rows = b"".join(row(100.0 + second, record_bytes) for second in range(100))
    recording = read(store, record(store, settings, [Block.of(topic, 100, 0, rows)]))
    blocks = read_blocks(read_blocks_between(recording, 180.0, 181.0, history=300.0).data)
    assert [time for block in blocks for time, _ in read_rows(block)] == [120.0 + n for n in range(61)]


def test_a_seek_into_a_gap_returns_the_newest_sample_before_it(store: Store, settings: Settings) -> None:
    batches = [[depth_block(0, 50)], [depth_block(50, 50), state_block(0)], [depth_block(1500, 50)]]
    recording = read(store, record(store, settings, *batches))
    blocks_between = depths(read_blocks_between(recording, 110.0, 112.0, history=1.0).data)
    assert [int(record.time) for _, record in blocks_between] == [99]
    # At the exact time of a sample the one before is in force; the sample itself follows.
    at = depths(read_blocks_between(recording, 100 + 50 * 0.02, 101.01, history=0.0).data)
    assert [int(record.time) for _, record in at] == [49, 50]


def test_until_the_first_state_the_one_of_the_start_is_in_force(store: Store, dive: Recording) -> None:
    (state,) = json.loads(state_block(0, time=99.0, set_point_default=0.3).payload)

    def notify(connection: Connection) -> None:
        connection.execute(text("UPDATE session SET robot_state = :state"), {"state": json.dumps(state)})

    asyncio.run(store.write(notify))
    assert dive.row.id is not None
    recording = read(store, dive.row.id)
    seen = [
        [
            document["set_point_default"]
            for document in documents_of(read_blocks_between(recording, start, start, 0).data, "state")
        ]
        for start in (99.9, 100.5)
    ]
    assert seen == [[0.3], [0.0]]


def test_before_the_beginning_there_is_nothing(dive: Recording) -> None:
    assert read_blocks_between(dive, 90.0, 99.0, history=300.0).data == b""


def test_a_seek_returns_the_last_lines(store: Store, settings: Settings) -> None:
    count = LISTED_CHUNKS + 50
    recording = read(store, record(store, settings, *[[lines(n, 1)] for n in range(count)]))
    texts = [
        document["text"]
        for document in documents_of(read_blocks_between(recording, 100 + count / 10, 140, 0).data, "debug")
    ]
    assert texts[-1] == f"line {count - 1}"
    assert LISTED_CHUNKS <= len(texts) < count


def test_too_long_a_range_is_refused_with_the_limit(dive: Recording) -> None:
    with pytest.raises(InvalidError, match="at most 120 s"):
        read_blocks_between(dive, 100.0, 100.1 + RANGE_MAX)


def test_a_range_of_two_minutes_is_not_too_long_by_rounding(dive: Recording) -> None:
    # From 32,768 s on numbers lie twice as far apart.
    zero, starts = 32_700.0, [number / 1000 for number in range(100)]
    ranges = [(zero + start, zero + (start + RANGE_MAX)) for start in starts]
    assert any(end - start > RANGE_MAX for start, end in ranges)
    for start, end in ranges:
        assert read_blocks_between(dive, start, end).left_out == 0


def test_damaged_chunks_are_left_out_and_counted(store: Store, dive: Recording) -> None:
    change(store, "UPDATE chunk SET data = x'00' WHERE topic = 'depth' AND number = 2")
    stretch = read_blocks_between(dive, 100.0, 110.0)
    assert [int(record.time) for _, record in depths(stretch.data)] == [*range(100), *range(150, 500)]
    assert stretch.left_out == 50


@pytest.mark.parametrize("lie", ["count = count + 1", "count = count - 1"])
def test_a_chunk_of_another_count_is_left_out(store: Store, dive: Recording, lie: str) -> None:
    change(store, f"UPDATE chunk SET {lie} WHERE number = 2")
    stretch = read_blocks_between(dive, 100.0, 110.0)
    assert [int(record.time) for _, record in depths(stretch.data)] == [*range(100), *range(150, 500)]
    assert len(documents_of(stretch.data, "debug")) == 90


def test_a_stored_bomb_is_left_out(store: Store, dive: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    size = dive.topics["depth"]["row_bytes"]
    samples = CHUNK_BYTES_MAX // size + 1
    bombs = {"depth": zlib.compress(bytes(samples * size)), "debug": zlib.compress(b"{}\n" * 6_000_000)}

    def store_bombs(connection: Connection) -> None:
        for topic, data in bombs.items():
            which = col(Chunk.topic) == topic, col(Chunk.number) == 2
            connection.execute(update(Chunk).where(*which).values(data=data, count=samples))

    asyncio.run(store.write(store_bombs))
    monkeypatch.setattr(zlib, "decompress", None)
    stretch = read_blocks_between(dive, 100.0, 110.0)
    assert [int(record.time) for _, record in depths(stretch.data)] == [*range(100), *range(150, 500)]
    assert stretch.left_out == 2 * samples
    for read_topic in (
        lambda: dive.columns("depth", ["depth"]),
        lambda: list(dive.rows("depth")),
        lambda: list(dive.documents("debug")),
        lambda: list(dive.changes("debug")),
    ):
        with pytest.raises(RecordingError, match="unpacks to more than 16000000 bytes"):
            read_topic()


def test_rows_of_other_definitions_are_rewritten_by_name_and_scale(store: Store, dive: Recording) -> None:
    # As if depth had been in centimetres' counts, pressure been called otherwise, temperature in kelvin.
    fields = [dict(field) for field in dive.topics["depth"]["fields"]]
    fields[1]["scale"] = 0.01
    fields[2]["name"] = "absolute_pressure"
    fields[3]["unit"] = "K"
    assert dive.row.id is not None
    redefine(store, dive.row.id, "depth", fields)
    stretch = read_blocks_between(read(store, dive.row.id), 100.0, 101.0)
    result = depths(stretch.data)
    assert [int(record.time) for _, record in result] == list(range(50))
    assert [record.depth for _, record in result] == pytest.approx([n / 100 for n in range(50)])
    assert {(record.pressure, record.temperature) for _, record in result} == {(0, 0.0)}
    assert stretch.left_out == 0


def test_rows_of_another_size_are_rewritten(store: Store, settings: Settings) -> None:
    session = record(store, settings, [depth_block(0, 3)])
    recording = read(store, session)
    fields = [dict(field) for field in recording.topics["depth"]["fields"]]
    fields[1] |= {"code": "f", "scale": 1}
    row = np.dtype([("row", "<f8"), ("time", "<u4"), ("depth", "<f4"), ("pressure", "<u4"), ("t", "<i2")])
    rows = np.zeros(3, row)
    rows["row"], rows["depth"] = [100.0, 100.02, 100.04], [0.25, 40.0, -50.0]
    described = dict(recording.topics) | {
        "depth": {**recording.topics["depth"], "fields": fields, "row_bytes": row.itemsize}
    }
    data, _, _ = encode_rows([rows.tobytes()], row.itemsize)

    def run(connection: Connection) -> None:
        connection.execute(text("UPDATE chunk SET data = :data"), {"data": data})
        connection.execute(text("UPDATE session SET topics = :topics"), {"topics": json.dumps(described)})

    asyncio.run(store.write(run))
    blocks_between = depths(read_blocks_between(read(store, session), 100.0, 101.0).data)
    # A value out of a field's range becomes the nearest valid one.
    assert [record.depth for _, record in blocks_between] == pytest.approx([0.25, 32.767, -32.768])


def test_missing_fields_of_documents_get_defaults_or_the_document_is_left_out(
    store: Store, settings: Settings
) -> None:
    lacking = state_block(0)
    (document,) = json.loads(lacking.payload)
    del document["card"], document["connection"], document["refusals"]
    document["forgotten"] = 1
    stated = Block.of(BY_NAME["state"], 1, 0, json.dumps([document]).encode())
    (unsure,) = json.loads(state_block(1, time=100.5).payload)
    del unsure["armed"]
    stated_unsure = Block.of(BY_NAME["state"], 1, 1, json.dumps([unsure]).encode())
    session = record(store, settings, [stated, stated_unsure])
    change(store, "UPDATE session SET version = 'older'")
    stretch = read_blocks_between(read(store, session), 100.0, 101.0)
    (state,) = documents_of(stretch.data, "state")
    assert (state["card"], state["connection"], state["refusals"]) == (None, "", [])
    assert "forgotten" not in state
    assert stretch.left_out == 1


def test_documents_of_this_version_pass_unchanged(dive: Recording, store: Store) -> None:
    before = documents_of(read_blocks_between(dive, 100.0, 110.0).data, "state")
    change(store, "UPDATE session SET version = 'older'")
    assert dive.row.id is not None
    assert documents_of(read_blocks_between(read(store, dive.row.id), 100.0, 110.0).data, "state") == before


def thumbnails(first: int, *times: float) -> list[Block]:
    topic = BY_NAME["thumbnail"]
    return [
        Block.of(topic, 1, first + index, row(time, b"jpeg %d" % (first + index)))
        for index, time in enumerate(times)
    ]


def test_thumbnails_come_as_pictures(store: Store, settings: Settings) -> None:
    batches = [thumbnails(0, 100.0, 100.4), thumbnails(2, 102.0, 102.4)]
    recording = read(store, record(store, settings, *batches))
    stretch = read_blocks_between(recording, 102.2, 103.0, history=0.0)
    assert [(block.topic.name, block.count, block.payload) for block in read_blocks(stretch.data)] == [
        ("picture", 1, row(102.0, b"jpeg 2")),
        ("picture", 1, row(102.4, b"jpeg 3")),
    ]


async def test_a_picture_s_address_does_not_show_that_of_another_session(settings: Settings) -> None:
    with new_store(settings.data) as store:
        session = await record_batches(store, settings, thumbnails(0, 100.0))

    async with serve(settings) as served:
        url = f"/sessions/{session}/thumbnail?time=0"
        first = await served.api.get(url)
        assert (first.content, first.headers["cache-control"]) == (b"jpeg 0", "private, no-cache")
        seen = {"if-none-match": first.headers["etag"]}
        again = await served.api.get(url, headers=seen)
        assert (again.status_code, again.content) == (304, b"")
        # As in a restored database: the number is another session's.
        await served.get(Store).execute(update(SessionRow).values(identifier="another"))
        assert (await served.api.get(url, headers=seen)).status_code == 200


def test_samples_of_an_unknown_topic_are_counted(store: Store, dive: Recording) -> None:
    change(store, """UPDATE session SET topics = replace(topics, '"depth":', '"sonar":')""")
    change(store, "UPDATE chunk SET topic = 'sonar' WHERE topic = 'depth'")
    assert dive.row.id is not None
    for history in (None, 5.0):
        stretch = read_blocks_between(read(store, dive.row.id), 100.0, 110.0, history)
        assert depths(stretch.data) == []
        assert stretch.left_out == 500


def test_the_timeline_has_events_bookmarks_and_gaps(store: Store, settings: Settings) -> None:
    event = documents.Event(time=102.0, kind="arm", severity="info", text="Armed.")
    batches = [
        [state_block(0, time=100.0), state_block(1, time=101.0)],
        [Block.of(BY_NAME["event"], 1, 0, pack_documents([event]))],
        [state_block(2, time=111.0)],
    ]
    session = record(store, settings, *batches)

    def mark(connection: Connection) -> None:
        values = {"session_id": session, "time": 105.5, "text": "here", "made": 1e9}
        connection.execute(insert(BookmarkRow).values(values))

    asyncio.run(store.write(mark))
    timeline = read_timeline(read(store, session))
    (item,) = timeline.events
    assert asdict(event) == {**asdict(item), "time": 102.0}
    assert item.time == 102.0 - STARTED_STEADY
    assert [(mark.time, mark.text) for mark in timeline.markers] == [(105.5 - STARTED_STEADY, "here")]
    assert timeline.holes == [StateSilence(start=101 - STARTED_STEADY, end=111 - STARTED_STEADY)]
    assert timeline.started_steady == STARTED_STEADY
    assert not timeline.filmed


async def test_over_http(settings: Settings) -> None:
    with new_store(settings.data) as store:
        session = await record_batches(store, settings, [depth_block(0, 500), state_block(0)])
        expected = read_blocks_between(read(store, session), 102.0, 103.0, 60.0)

    async with serve(settings) as served:
        start = 102.0 - STARTED_STEADY
        query = {"start": start, "end": start + 1, "history": 60}
        answer = await served.api.get(f"/sessions/{session}/blocks", params=query)
        assert answer.status_code == 200
        assert answer.headers["content-type"] == "application/octet-stream"
        assert answer.headers["left-out"] == "0"
        assert answer.content == expected.data
        answer = await served.api.get(f"/sessions/{session}/timeline")
        assert answer.json()["started_steady"] == STARTED_STEADY

        async def refused(query: str, number: int = session) -> tuple[int, str]:
            answer = await served.api.get(f"/sessions/{number}/blocks?{query}")
            return answer.status_code, answer.json()["detail"]

        status, message = await refused("start=5&end=4")
        assert status == 422
        assert "lies before the start" in message
        status, message = await refused("start=0&end=121")
        assert status == 422
        assert "at most 120 s" in message
        assert (await refused("start=0&end=1", session + 1))[0] == 404
        for invalid in ("start=0", "start=nan&end=1", "start=0&end=inf", "start=0&end=1&history=301"):
            assert (await refused(invalid))[0] == 422


def test_debug_lines_of_one_instant_stay_together(store: Store, settings: Settings) -> None:
    recording = read(store, record(store, settings, [debug_block(0, "a", "b", "c")]))
    assert [
        document["text"]
        for document in documents_of(read_blocks_between(recording, 100.5, 101.5).data, "debug")
    ] == ["b"]
