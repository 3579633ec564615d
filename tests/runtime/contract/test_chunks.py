import json
import math
import struct
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract import chunks
from robot_runtime.contract.topics import TOPICS, Kind
from robot_runtime.transport.blocks import Block, read_rows, row
from tests.server.blocks import debug_block, depth_block


@given(st.integers(1, 60), st.integers(0, 50), st.randoms(use_true_random=False))
def test_shuffling_is_undone(size: int, count: int, random: object) -> None:
    rows = random.randbytes(size * count)  # type: ignore[attr-defined]
    assert chunks.unshuffle(chunks.shuffle(rows, size), size) == rows


def test_shuffling_groups_bytes_of_equal_place() -> None:
    assert chunks.shuffle(b"a1a2a3", 2) == b"aaa123"


@given(st.lists(st.binary(max_size=60), max_size=5), st.integers(1, 12))
def test_shuffled_parts_are_joined_as_their_rows_are(parts: list[bytes], size: int) -> None:
    whole = [part[: len(part) // size * size] for part in parts]
    joined = chunks.join_shuffled([chunks.shuffle(part, size) for part in whole], size)
    assert joined == chunks.shuffle(b"".join(whole), size)


def test_times_are_read_from_shuffled_rows() -> None:
    rows = b"".join(struct.pack("<dh", time, 7) for time in (1.5, 2.25, -3.0))
    assert chunks.shuffled_times(chunks.shuffle(rows, 10), 10) == (1.5, 2.25, -3.0)


def test_incomplete_rows_are_refused() -> None:
    with pytest.raises(ValueError, match="not whole rows"):
        chunks.decode_rows(zlib.compress(b"12345"), 2)


@given(st.lists(st.integers(1, 20), min_size=1, max_size=10))
def test_rows_of_several_blocks_become_one_chunk(counts: list[int]) -> None:
    blocks: list[Block] = []
    for count in counts:
        blocks.append(depth_block(sum(block.count for block in blocks), count))
    size = blocks[0].topic.row_bytes
    data, first, last = chunks.encode_rows([block.payload for block in blocks], size)
    assert chunks.decode_rows(data, size) == b"".join(block.payload for block in blocks)
    assert (first, last) == (read_rows(blocks[0])[0][0], read_rows(blocks[-1])[-1][0])


def test_shuffled_rows_are_smaller() -> None:
    block = depth_block(0, 50)
    data, _, _ = chunks.encode_rows([block.payload], block.topic.row_bytes)
    assert len(data) < 0.6 * len(zlib.compress(block.payload, chunks.LEVEL))


def test_rows_without_a_time_are_refused() -> None:
    block = depth_block(0, 1)
    with pytest.raises(ValueError, match="nan"):
        chunks.encode_rows([row(math.nan, block.payload[8:])], block.topic.row_bytes)


def test_documents_become_lines() -> None:
    blocks = [debug_block(0, "é", "two"), debug_block(2, "three")]
    data, first, last = chunks.encode_documents([block.payload for block in blocks], 3)
    results = list(chunks.decode_documents(data))
    assert results == [document for block in blocks for document in json.loads(block.payload)]
    assert (first, last) == (100.0, 102.0)
    assert zlib.decompress(data).count(b"\n") == 3


@pytest.mark.parametrize(
    "payload",
    [
        b"nonsense",
        b"[1]",
        b"[]",
        b"5",
        b"null",
        b'[{"text": "x"}]',
        b'{"time": 1}',
        b'[{"time": 1%s}]' % (b"0" * 400),
        b"[" * 5000,
    ],
)
def test_bytes_that_are_no_list_of_documents_are_refused(payload: bytes) -> None:
    with pytest.raises((ValueError, RecursionError)):
        chunks.encode_documents([payload], 1)


def test_rows_of_every_topic_can_be_read_by_their_stored_description() -> None:
    described = json.loads(json.dumps(chunks.describe_topics()))
    for topic in TOPICS:
        if topic.kind is Kind.ROWS:
            layout = chunks.row_layout(described[topic.name])
            assert layout.row.size == topic.row_bytes == described[topic.name]["row_bytes"]
            assert len(layout.columns) == len(layout.scales) == len(layout.line.split(","))
    assert set(described) == {topic.name for topic in TOPICS} - {
        "picture",
        "observer",
        "mask",
        "balanced",
        "camera",
    }
    assert chunks.row_layout(described["motor"]).columns[1:3] == ("wanted_0 [rad]", "wanted_1 [rad]")
