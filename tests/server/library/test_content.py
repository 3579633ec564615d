import asyncio
from typing import Any

import pytest
from sqlalchemy import update

from robot_runtime.contract.chunks import decode_pictures, encode_pictures
from server.library.content import CHUNKS_AT_ONCE, Recording, RecordingError
from server.platform.models import Chunk
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, picture_block, state_block, thumbnail_block
from tests.server.features.exports.recordings import record

BOTH_DATABASES = True


def read(store: Store, session: int) -> Recording:
    row = find_row(store, session)
    return Recording(store, row)


def test_a_range_of_time_gives_its_samples_and_no_others(store: Store, settings: Settings) -> None:
    batches = [[depth_block(10 * number, 10)] for number in range(2 * CHUNKS_AT_ONCE)]
    recording = read(store, record(store, settings, *batches))
    times, columns = recording.columns("depth", ["depth", "pressure"])
    count = 20 * CHUNKS_AT_ONCE
    assert recording.counts() == {"depth": count}
    assert columns["depth"].tolist() == pytest.approx([n / 1000 for n in range(count)])
    start, end = times[33], times[-12]
    within, columns = recording.columns("depth", ["pressure"], start, end)
    assert within.tolist() == times[33:-11].tolist()
    assert columns["pressure"].tolist() == [101_325 + n for n in range(33, count - 11)]
    assert len(list(recording.chunks("depth", start, end))) < 2 * CHUNKS_AT_ONCE


def test_a_missing_column_is_named(store: Store, settings: Settings) -> None:
    recording = read(store, record(store, settings, [depth_block(0, 1)]))
    with pytest.raises(KeyError, match="depth has no column deep; it has time, depth, pressure"):
        recording.columns("depth", ["deep"])


def test_documents_of_a_range(store: Store, settings: Settings) -> None:
    recording = read(store, record(store, settings, [debug_block(0, "a", "b", "c")]))
    first, second, third = recording.documents("debug")
    assert [first["text"], second["text"], third["text"]] == ["a", "b", "c"]
    assert first["time"] <= second["time"] <= third["time"]
    if first["time"] < second["time"]:
        assert list(recording.documents("debug", second["time"], second["time"])) == [second]


def test_thumbnails_are_recorded_and_other_pictures_are_not(store: Store, settings: Settings) -> None:
    small = [thumbnail_block(n, 100.0 + 2 * n, bytes([n]) * (n + 1)) for n in range(3)]
    recording = read(store, record(store, settings, [small[0], small[1], picture_block(0)], [small[2]]))
    assert recording.counts() == {"thumbnail": 3}
    assert list(recording.pictures("thumbnail")) == [
        (100.0, b"\0"),
        (102.0, b"\1\1"),
        (104.0, b"\2\2\2"),
    ]
    assert [time for time, _ in recording.pictures("thumbnail", 101.0, 103.0)] == [102.0]


def test_a_truncated_chunk_of_pictures_is_damaged() -> None:
    data, _, _ = encode_pictures([thumbnail_block(0, 1.0, b"jpeg").payload])
    assert list(decode_pictures(data)) == [(1.0, b"jpeg")]
    for end in range(1, len(data)):
        with pytest.raises(ValueError, match="cut off"):
            list(decode_pictures(data[:end]))


def test_changes_are_documents_that_differ_from_the_one_before(store: Store, settings: Settings) -> None:
    documents = [(100.0, 0.5), (101.0, 0.5), (102.0, 1.0), (103.0, 1.0), (104.0, 0.5)]
    batches = [
        [state_block(index, time=time, set_point_default=set_point)]
        for index, (time, set_point) in enumerate(documents)
    ]
    changes = list(read(store, record(store, settings, *batches)).changes("state"))
    assert [(change["time"], change["set_point_default"]) for change in changes] == [
        (100.0, 0.5),
        (102.0, 1.0),
        (104.0, 0.5),
    ]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"data": b""}, "is damaged"),
        ({"encoding": "other"}, "is of another version: it is encoded as 'other'"),
    ],
)
def test_an_unreadable_recording_is_reported(
    store: Store, settings: Settings, change: dict[str, Any], message: str
) -> None:
    recording = read(store, record(store, settings, [depth_block(0, 5), state_block(0)]))
    asyncio.run(store.execute(update(Chunk).values(change)))
    with pytest.raises(RecordingError, match=f"chunk 0 of depth {message}"):
        recording.columns("depth", ["depth"])
    with pytest.raises(RecordingError, match=f"chunk 0 of state {message}"):
        list(recording.changes("state"))
