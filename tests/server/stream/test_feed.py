"""The server's bus delivers blocks by topic, and goes on where a listener fails."""

from robot_runtime.contract.topics import DEPTH, STATE
from robot_runtime.transport.blocks import Block
from server.stream.feed import Feed
from tests.server.blocks import debug_block, depth_block, state_block


def test_a_listener_hears_its_topics_alone_in_order() -> None:
    feed, heard, everything = Feed(), list[Block](), list[Block]()
    feed.listen(heard.append, DEPTH)
    feed.listen(everything.append)
    blocks = [depth_block(0, 2), state_block(0), depth_block(2, 2)]
    feed.deliver(blocks)
    assert heard == [blocks[0], blocks[2]]
    assert everything == blocks


def test_a_round_is_heard_whole_after_its_blocks() -> None:
    feed, order = Feed(), list[object]()
    feed.listen_to_rounds(order.append)
    feed.listen(order.append, STATE)
    blocks = [state_block(0), depth_block(0, 1)]
    feed.deliver(blocks)
    assert order == [blocks[0], blocks]


def test_a_listener_that_fails_is_reported_and_the_others_hear() -> None:
    feed, heard, reported = Feed(), list[Block](), list[tuple[str, str]]()

    def fail(_: object) -> None:
        raise ValueError("worn out")

    feed.on_failure = lambda name, problem: reported.append((name.rpartition(".")[2], str(problem)))
    feed.listen(fail, DEPTH)
    feed.listen_to_rounds(fail)
    feed.listen(heard.append, DEPTH)
    feed.deliver([depth_block(0, 1)])
    assert len(heard) == 1
    assert reported == [("fail", "worn out")] * 2


def test_a_listener_that_fails_at_its_own_report_is_reported_once() -> None:
    feed, reported = Feed(), list[str]()

    def fail(_: object) -> None:
        raise ValueError("worn out")

    def report(_name: str, problem: Exception) -> None:
        reported.append(str(problem))
        feed.deliver([debug_block(0, "it has failed")])

    feed.on_failure = report
    feed.listen(fail)
    for position in range(3):
        feed.deliver([depth_block(position, 1)])
    assert reported == ["worn out"]
