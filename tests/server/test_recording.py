import pytest

from server.recording import CHUNKS_AT_ONCE, Recording
from server.sessions import find_row
from server.settings import Settings
from server.store import Store
from tests.server.blocks import debug_block, depth_block
from tests.server.test_export_tables import record


def read(store: Store, session: int) -> Recording:
    row = find_row(store, session)
    assert row is not None
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


def test_a_column_that_is_not_there_is_named(store: Store, settings: Settings) -> None:
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
