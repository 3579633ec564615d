from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract.topics import BY_NAME, AnyTopic
from robot_runtime.transport.blocks import read_blocks
from server.stream.broadcast import CHUNK_SECONDS, BroadcastBuffer, TopicHistory
from tests.server.blocks import debug_block, depth_block, link_block, state_block

DEPTH, DEBUG = BY_NAME["depth"], BY_NAME["debug"]


def test_a_buffer_keeps_the_newest_messages() -> None:
    lane = BroadcastBuffer(messages_max=3, bytes_max=10**6)
    blocks = [depth_block(number, 1) for number in range(5)]
    for block in blocks:
        lane.append([block])
    assert (lane.first, lane.end) == (2, 5)
    assert [lane.get(number).data for number in range(2, 5)] == [block.data for block in blocks[2:]]


def test_a_buffer_is_limited_in_bytes_but_keeps_the_newest_message_of_any_size() -> None:
    lane = BroadcastBuffer(messages_max=100, bytes_max=1000)
    for number in range(20):
        lane.append([depth_block(number, 10)])
    stored = sum(len(lane.get(number).data) for number in range(lane.first, lane.end))
    assert 0 < stored <= 1000
    lane.append([depth_block(0, 500)])
    assert lane.end - lane.first == 1


def test_one_message_holds_all_blocks_of_a_round() -> None:
    lane = BroadcastBuffer(messages_max=3, bytes_max=10**6)
    blocks = [depth_block(0, 2), debug_block(0, "a")]
    lane.append(blocks)
    assert lane.get(0).data == blocks[0].data + blocks[1].data


@given(st.lists(st.integers(1, 9), min_size=1, max_size=40), st.integers(0, 40))
def test_lost_samples_are_counted_exactly(counts: list[int], read: int) -> None:
    lane = BroadcastBuffer(messages_max=5, bytes_max=10**6)
    seen = lane.totals
    first = 0
    for number, count in enumerate(counts):
        lane.append([depth_block(first, count), debug_block(number, "x")])
        first += count
        if number < read:
            seen = lane.totals
    delivered = counts[: min(read, len(counts))]
    left_in_lane = counts[lane.first :]
    lost = max(0, len(counts) - len(delivered) - len(left_in_lane))
    expected = sum(counts[len(delivered) : len(delivered) + lost])
    assert dict(lane.lost(seen)) == ({DEPTH: expected, DEBUG: lost} if lost else {})


def numbers(data: bytes, topic: AnyTopic = DEPTH) -> list[int]:
    return [
        number
        for block in read_blocks(data)
        if block.topic is topic
        for number in range(block.first, block.first + block.count)
    ]


def everything(history: TopicHistory) -> bytes:
    return b"".join(b"".join(group) for group in history.since(-1, 10**6))


def filled(seconds: float, bytes_max: int = 10**7) -> TopicHistory:
    """Return a history of 50 depths a second, sent in blocks of two, from 100 s on."""
    history = TopicHistory(seconds=600, bytes_max=bytes_max)
    for tick in range(int(seconds * 25)):
        history.add(depth_block(2 * tick, 2), tick, 100.0 + tick / 25)
    return history


def test_the_history_of_ten_minutes_takes_little_more_memory_than_its_rows() -> None:
    history = filled(700)
    stored = everything(history)
    expected = list(range(numbers(stored)[0], 700 * 50))
    assert numbers(stored) == expected
    assert 600 * 50 - CHUNK_SECONDS * 50 <= len(expected) <= (600 + CHUNK_SECONDS) * 50
    assert len(stored) < 1.02 * DEPTH.row_bytes * len(expected)
    assert sum(map(len, history.since(-1, 10**6))) < 600 / CHUNK_SECONDS + 3


def test_the_history_is_limited_per_topic() -> None:
    history = filled(0)
    line = debug_block(0, "kept")
    history.add(line, tick=0, now=100.0)
    bounded = filled(100, bytes_max=20_000)
    assert everything(history) == line.data
    assert 18_000 < len(everything(bounded)) <= 20_000
    assert numbers(everything(bounded))[-1] == 100 * 50 - 1


@given(st.lists(st.integers(0, 200), max_size=5))
def test_history_and_later_blocks_give_every_block_once(asked: list[int]) -> None:
    history = TopicHistory(seconds=600, bytes_max=10**6)
    given: list[int] = []
    tick = -1
    for number in range(200):
        if number in asked:
            given += numbers(b"".join(b"".join(group) for group in history.since(tick, 500)))
            tick = number
        history.add(depth_block(number, 1), number + 1, 100.0 + number * 0.02)
    given += numbers(b"".join(b"".join(group) for group in history.since(tick, 500)))
    assert given == list(range(200))


def test_a_message_of_history_is_limited_in_size() -> None:
    groups = filled(100).since(-1, message_bytes=10_000)
    assert len(groups) > 5
    assert all(sum(map(len, group)) <= 10_000 for group in groups)


def test_a_later_start_applies_to_rows_and_not_to_documents() -> None:
    history = filled(100)
    history.add(debug_block(0, "old"), tick=0, now=100.0)
    data = b"".join(b"".join(group) for group in history.since(-1, 10**6, rows_from=190.0))
    assert 500 <= len(numbers(data)) <= (10 + 2 * CHUNK_SECONDS) * 50
    assert numbers(data)[-1] == 100 * 50 - 1
    assert numbers(data, DEBUG) == [0]


def test_only_the_newest_state_is_in_the_history() -> None:
    history = TopicHistory(seconds=600, bytes_max=10**6)
    for number in range(5):
        history.add(state_block(number), tick=number, now=100.0 + number)
    assert everything(history) == state_block(4).data


def test_a_gap_in_the_numbers_stays_a_gap() -> None:
    history = TopicHistory(seconds=600, bytes_max=10**6)
    for first in (0, 2, 7, 8):
        history.add(depth_block(first, 1), tick=first, now=100.0)
    blocks = read_blocks(everything(history))
    assert [(block.first, block.count) for block in blocks] == [(0, 1), (2, 1), (7, 2)]


def test_rows_before_a_time_are_selected_by_topic() -> None:
    history = filled(100)
    history.add(link_block(0, 1), tick=0, now=100.0)
    data = b"".join(history.rows({"depth"}, until=150.0))
    assert 2500 <= len(numbers(data)) <= (50 + CHUNK_SECONDS) * 50
    assert numbers(data)[0] == 0
    assert {block.topic for block in read_blocks(data)} == {DEPTH}
