import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

import robot_runtime.transport.replay_cache as cache_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import DebugLine
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import BY_NAME, DEBUG, DEPTH
from robot_runtime.transport.blocks import NUMBERS, Block
from robot_runtime.transport.outbox import Outbox
from robot_runtime.transport.replay_cache import BacklogReply, ReplayCache, write_question
from tests.server.blocks import debug_block, depth_block, depth_record


class Writer:
    """An outbox that also stores all its messages."""

    def __init__(self) -> None:
        self.clock = SimulatedClock(1000.0)
        self.cache = ReplayCache("0123456789abcdef", self.clock)
        self.sent: list[bytes] = []
        self.outbox = Outbox(lambda _, data: self.sent.append(data), lambda _: False, self.cache)

    def depths(self, *numbers: int) -> None:
        for number in numbers:
            self.outbox.add_row(DEPTH, self.clock.now(), depth_record(number).to_bytes())
        self.outbox.flush()

    def debug(self, text: str) -> None:
        self.outbox.add_document(DEBUG, DebugLine(time=self.clock.now(), level=1, text=text))
        self.outbox.flush()

    def ask(self, **expected: int) -> BacklogReply:
        return BacklogReply.from_bytes(self.cache.answer(write_question(expected)))


def test_a_request_returns_the_sent_blocks_oldest_first() -> None:
    writer = Writer()
    writer.depths(0, 1)
    writer.debug("a")
    writer.depths(2)
    writer.debug("b")
    stored = writer.ask(depth=0, debug=0)
    assert b"".join(block.data for block in stored.blocks) == b"".join(writer.sent)
    assert stored.run == "0123456789abcdef"
    assert {name: stored.next[name] for name in ("depth", "debug", "imu")} == {
        "depth": 3,
        "debug": 2,
        "imu": 0,
    }
    assert [(block.topic.name, block.first) for block in writer.ask(depth=2).blocks] == [("depth", 2)]
    assert writer.ask(depth=3).blocks == []
    assert writer.ask().blocks == []


def test_old_blocks_are_dropped() -> None:
    writer = Writer()
    writer.depths(0)
    writer.clock.forward(cache_module.SECONDS)
    writer.depths(1)
    assert [block.first for block in writer.ask(depth=0).blocks] == [0, 1]
    writer.clock.forward(1)
    writer.depths(2)
    assert [block.first for block in writer.ask(depth=0).blocks] == [1, 2]


def test_the_cache_is_limited_in_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache_module, "BYTES_MAX", 1000)
    writer = Writer()
    for number in range(100):
        writer.depths(number)
    stored = writer.ask(depth=0)
    size = len(stored.blocks[0].data)
    assert [block.first for block in stored.blocks] == list(range(100 - 1000 // size, 100))
    assert stored.next["depth"] == 100


@given(st.integers(0, NUMBERS - 1), st.integers(1, 5), st.integers(-7, 7))
def test_numbers_wrap(first: int, count: int, ahead: int) -> None:
    block = depth_block(first, count)
    assert block.following == (first + count) % NUMBERS
    assert block.after((first + ahead) % NUMBERS) is (ahead < count)
    if 0 <= ahead < count:
        assert block.time_of((first + ahead) % NUMBERS) == pytest.approx(100 + (first + ahead) * 0.02)
    else:
        with pytest.raises(IndexError):
            block.time_of((first + ahead) % NUMBERS)


def test_times_of_documents_are_found() -> None:
    block = debug_block(5, "a", "b")
    assert [block.time_of(number) for number in (5, 6)] == [105.0, 106.0]
    with pytest.raises(LayoutError, match="damaged"):
        Block.of(BY_NAME["debug"], 2, 0, b"[]").time_of(1)


@pytest.mark.parametrize(
    ("question", "why"),
    [
        (b"nonsense", "Expecting value"),
        (b"[]", "must be a JSON object"),
        (b'{"deep": 1}', "no topic 'deep'"),
        (b'{"depth": -1}', "whole number"),
        (b'{"depth": 1.5}', "whole number"),
        (b'{"depth": true}', "whole number"),
        (b'{"depth": 4294967296}', "whole number"),
    ],
)
def test_bad_questions_are_refused(question: bytes, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        Writer().cache.answer(question)


@given(st.binary(max_size=60))
def test_invalid_bytes_are_no_answer(data: bytes) -> None:
    with pytest.raises(LayoutError):
        BacklogReply.from_bytes(data)


def test_a_truncated_answer_is_refused() -> None:
    writer = Writer()
    writer.depths(0)
    answer = writer.cache.answer(json.dumps({"depth": 0}).encode())
    with pytest.raises(LayoutError):
        BacklogReply.from_bytes(answer[:-1])


@pytest.mark.parametrize("number", [b"Infinity", b"NaN", b"null", b"[" * 100_000])
def test_numbers_that_are_none_are_refused(number: bytes) -> None:
    head = b'{"run": "a", "next": {"depth": %s}}' % number
    with pytest.raises(LayoutError):
        BacklogReply.from_bytes(len(head).to_bytes(4, "little") + head)


def test_a_number_is_one_that_a_block_can_have() -> None:
    head = b'{"run": "a", "next": {"depth": %d}}' % (2**80 + 5)
    assert BacklogReply.from_bytes(len(head).to_bytes(4, "little") + head).next == {"depth": 5}
