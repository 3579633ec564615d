"""Blocks: encoding and decoding, refusals."""

import json

import pytest

from robot_runtime.contract.documents import DebugLine
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import BY_NAME, DEBUG, DEPTH, PICTURE, Kind
from robot_runtime.transport.blocks import Block, read_blocks, read_rows
from robot_runtime.transport.outbox import Outbox


def depth(metres: float) -> Depth:
    return Depth(time=7, depth=metres, pressure=101_325, temperature=12.5)


def sent_by(outbox_use: list[tuple[str, bytes]]) -> Outbox:
    return Outbox(lambda name, data: outbox_use.append((name, data)), lambda _: False)


def test_rows_arrive_as_one_numbered_block() -> None:
    sent: list[tuple[str, bytes]] = []
    outbox = sent_by(sent)
    for index in range(3):
        outbox.add_row(DEPTH, 10.0 + index, depth(index).to_bytes())
    outbox.flush()
    outbox.add_row(DEPTH, 20.0, depth(9).to_bytes())
    outbox.flush()
    outbox.flush()
    assert [name for name, _ in sent] == ["stream", "stream"]
    first, second = (read_blocks(data)[0] for _, data in sent)
    assert (first.first, first.count, second.first, second.count) == (0, 3, 3, 1)
    assert read_rows(first) == [(10.0, depth(0)), (11.0, depth(1)), (12.0, depth(2))]


def test_all_topics_share_a_message_and_one_can_be_taken_alone() -> None:
    sent: list[tuple[str, bytes]] = []
    outbox = Outbox(lambda name, data: sent.append((name, data)), lambda name: name == "debug")
    outbox.add_row(DEPTH, 1.0, depth(0.1).to_bytes())
    outbox.add_document(DEBUG, DebugLine(time=1.0, level=1, text="one"))
    outbox.flush()
    assert [name for name, _ in sent] == ["stream", "debug"]
    assert [block.topic.name for block in read_blocks(sent[0][1])] == ["depth", "debug"]
    assert sent[0][1].endswith(sent[1][1])


def test_documents_arrive_as_json_in_order() -> None:
    sent: list[tuple[str, bytes]] = []
    outbox = sent_by(sent)
    outbox.add_document(DEBUG, DebugLine(time=1.0, level=1, text="one"))
    outbox.add_document(DEBUG, DebugLine(time=2.0, level=2, text="zwei ü"))
    outbox.flush()
    (block,) = read_blocks(sent[0][1])
    assert block.topic.kind is Kind.DOCUMENTS
    assert [line["text"] for line in json.loads(block.payload)] == ["one", "zwei ü"]


def test_a_picture_is_sent_at_once_with_its_time() -> None:
    sent: list[tuple[str, bytes]] = []
    sent_by(sent).send_picture(PICTURE, 3.5, b"jpeg")
    (block,) = read_blocks(sent[0][1])
    assert (block.topic.name, block.payload[8:]) == ("picture", b"jpeg")


def test_several_blocks_in_one_message() -> None:
    data = Block.of(BY_NAME["depth"], 1, 5, bytes(20)).data
    two = Block.of(BY_NAME["debug"], 1, 6, b"[{}]").data
    assert [block.first for block in read_blocks(data + two)] == [5, 6]


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"\x02\x00\x01", "header is cut off"),
        (Block.of(BY_NAME["depth"], 1, 0, bytes(20)).data[:-1], "is cut off: 19 of 20"),
        (Block.of(BY_NAME["depth"], 2, 0, bytes(20)).data, "20 bytes, which are not 2 samples"),
        (Block.of(BY_NAME["debug"], 0, 0, b"[]").data, "not 0 samples"),
        (b"\xee" + bytes(11), "no topic 238"),
        (b"\x02\x01" + bytes(10), "no topic 2 of kind 1"),
    ],
)
def test_damaged_blocks_are_refused(data: bytes, why: str) -> None:
    with pytest.raises(LayoutError, match=why):
        read_blocks(data)


def test_values_that_json_lacks_are_refused() -> None:
    outbox = sent_by([])
    outbox.add_document(DEBUG, DebugLine(time=float("nan"), level=1, text=""))
    with pytest.raises(ValueError, match="Out of range"):
        outbox.flush()
