from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.topics import BY_NAME
from server.live.lanes import History, Lane
from tests.server.blocks import debug_block, depth_block

DEPTH, DEBUG = BY_NAME["depth"], BY_NAME["debug"]


def test_lane_keeps_the_newest_messages() -> None:
    lane = Lane(messages_max=3, bytes_max=10**6)
    blocks = [depth_block(number, 1) for number in range(5)]
    for block in blocks:
        lane.append([block])
    assert (lane.first, lane.end) == (2, 5)
    assert [lane.get(number).data for number in range(2, 5)] == [block.data for block in blocks[2:]]


def test_lane_is_bounded_in_bytes_but_keeps_the_newest_message_however_large() -> None:
    lane = Lane(messages_max=100, bytes_max=1000)
    for number in range(20):
        lane.append([depth_block(number, 10)])
    kept = sum(len(lane.get(number).data) for number in range(lane.first, lane.end))
    assert 0 < kept <= 1000
    lane.append([depth_block(0, 500)])
    assert lane.end - lane.first == 1


def test_one_message_holds_all_blocks_of_a_round() -> None:
    lane = Lane(messages_max=3, bytes_max=10**6)
    blocks = [depth_block(0, 2), debug_block(0, "a")]
    lane.append(blocks)
    assert lane.get(0).data == blocks[0].data + blocks[1].data


@given(st.lists(st.integers(1, 9), min_size=1, max_size=40), st.integers(0, 40))
def test_lost_samples_are_counted_exactly(counts: list[int], read: int) -> None:
    lane = Lane(messages_max=5, bytes_max=10**6)
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


def test_history_lets_go_of_what_is_old() -> None:
    history = History(seconds=10, bytes_max=10**6)
    blocks = [depth_block(number, 1) for number in range(30)]
    for number, block in enumerate(blocks):
        history.add(block, tick=number, now=float(number))
    assert b"".join(b"".join(group) for group in history.since(-1, 10**6)) == b"".join(
        block.data for block in blocks[19:]
    )


def test_history_is_bounded_for_each_topic_alone() -> None:
    history = History(seconds=1000, bytes_max=2000)
    line = debug_block(0, "kept")
    history.add(line, tick=0, now=0)
    for number in range(200):
        history.add(depth_block(number * 5, 5), tick=number + 1, now=0)
    data = b"".join(b"".join(group) for group in history.since(-1, 10**6))
    assert data.startswith(line.data)
    assert 1000 < len(data) - len(line.data) <= 2000


def test_history_gives_only_what_came_after_a_tick_in_messages_of_bounded_size() -> None:
    history = History(seconds=1000, bytes_max=10**6)
    blocks = [depth_block(number, 1) for number in range(50)]
    for number, block in enumerate(blocks):
        history.add(block, tick=number, now=0)
    groups = history.since(9, message_bytes=5 * len(blocks[0].data))
    assert [len(group) for group in groups] == [5] * 8
    assert [data for group in groups for data in group] == [block.data for block in blocks[10:]]
