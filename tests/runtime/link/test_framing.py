"""Frames: complete, in pieces, several at once, damaged in every way."""

import zlib

import pytest
from cobs import cobs
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract.packets import (
    FRAME_BYTES_MAX,
    Beacon,
    Debug,
    Hello,
    Navigation,
    Packet,
    Start,
    Stop,
)
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.link.framing import MESSAGES_BYTES_MAX, Decoder, Frame, build

SOME: list[Packet] = [
    Stop(),
    Navigation(x=0.0, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=0.0),
    Beacon(time=0, right=1, left=0),
]
LINES: list[Packet] = [Debug(time=0, level=1, text="dive"), Start(epoch=3), Debug(time=1, level=2, text="up")]


def frames(data: bytes) -> list[Frame]:
    return list(Decoder().feed(data))


def raw(content: bytes) -> bytes:
    """Return a frame of any content with a valid checksum; 0 as number, where it has one."""
    if content[1:2] != bytes([Debug.type]):
        content += b"\0"
    return cobs.encode(content + zlib.crc32(content).to_bytes(4, "little")) + b"\0"  # type: ignore[no-any-return]


@pytest.mark.parametrize(("some", "number"), [(SOME, 3), (SOME, 4095), (LINES, 3), (LINES, 15)])
def test_a_frame_carries_its_packets_and_numbers(some: list[Packet], number: int) -> None:
    (frame,) = frames(build(some, number, 12))
    assert (frame.number, frame.acknowledged) == (number, 12)
    assert frame.reliable == (some is LINES)
    assert [type_ for type_, _ in frame.messages] == [packet.type for packet in some]
    assert [payload for _, payload in frame.messages] == [packet.to_bytes() for packet in some]


def test_a_frame_of_another_session_is_dropped() -> None:
    decoder = Decoder()
    decoder.key = 0x0001_0002
    assert list(decoder.feed(build(SOME, 1, 0, 0x0001_0003))) == []
    assert [frame.open for frame in decoder.feed(build(SOME, 1, 0, decoder.key))] == [False]
    assert [frame.open for frame in decoder.feed(build(SOME, 1, 0))] == [True]
    assert decoder.invalid == 1


@given(st.lists(st.integers(1, 20), max_size=40))
def test_pieces_of_any_size_give_the_same_frames(cuts: list[int]) -> None:
    data = b"".join(build([packet], number, 0) for number, packet in enumerate(SOME)) * 3
    decoder, result, rest = Decoder(), [], data
    for cut in cuts:
        result += list(decoder.feed(rest[:cut]))
        rest = rest[cut:]
    result += list(decoder.feed(rest))
    assert result == frames(data)
    assert len(result) == 9
    assert decoder.invalid == 0


@given(st.integers(0, 7), st.data())
def test_any_flipped_bit_is_detected(bit: int, data: st.DataObject) -> None:
    good = bytearray(build(SOME, 1, 2))
    at = data.draw(st.integers(0, len(good) - 2))
    good[at] ^= 1 << bit
    assert frames(bytes(good)) == []


@given(st.binary(max_size=400))
def test_after_any_garbage_the_next_frame_is_decoded(garbage: bytes) -> None:
    decoder = Decoder()
    list(decoder.feed(garbage + b"\0"))
    assert [frame.number for frame in decoder.feed(build(SOME, 5, 0))] == [5]


@pytest.mark.parametrize("missing", range(1, 12))
def test_a_truncated_frame_is_dropped_and_counted(missing: int) -> None:
    decoder = Decoder()
    whole = build(SOME, 1, 0)
    assert list(decoder.feed(whole[: -1 - missing] + b"\0")) == []
    assert decoder.invalid == 1


def test_an_oversized_frame_is_dropped_once_and_takes_no_memory() -> None:
    decoder = Decoder()
    for _ in range(1000):
        assert list(decoder.feed(b"\x01" * 1000)) == []
    assert len(decoder._pending) <= FRAME_BYTES_MAX
    assert [frame.number for frame in decoder.feed(b"\0" + build(SOME, 9, 0))] == [9]
    assert decoder.invalid == 1


def test_idle_zeros_are_no_error() -> None:
    decoder = Decoder()
    assert list(decoder.feed(bytes(50))) == []
    assert decoder.invalid == 0


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x10\x7f",
        b"\x10" + bytes([Navigation.type]) + bytes(5),
        b"\x10" + bytes([Debug.type]) + bytes(5),
        b"\x10" + bytes([Debug.type]) + bytes(5) + b"\x04abc",
        b"\x10" + bytes([Debug.type]) + bytes(5) + b"\x29" + b"a" * 41,
        b"\x10" + bytes([Hello.type]) + bytes(8) + bytes([Beacon.type]),
    ],
    ids=[
        "empty",
        "unknown type",
        "short",
        "text without length",
        "text cut off",
        "text too long",
        "second cut off",
    ],
)
def test_invalid_contents_with_a_valid_checksum_are_dropped(content: bytes) -> None:
    decoder = Decoder()
    assert list(decoder.feed(raw(content))) == []
    assert decoder.invalid == 1


def test_the_longest_frame_has_exactly_the_longest_length() -> None:
    filler = MESSAGES_BYTES_MAX - 1
    frame = build([Stop()] * filler, 0, 0)
    assert len(frame) == FRAME_BYTES_MAX
    assert len(frames(frame)[0].messages) == filler
    with pytest.raises(LayoutError, match="do not fit a frame"):
        build([Stop()] * (filler + 1), 0, 0)
    reliable = build([Start(epoch=1)] * (MESSAGES_BYTES_MAX // 3), 0, 0)
    assert len(reliable) == FRAME_BYTES_MAX
