"""Frames of the firmware, against zlib, the cobs package and the packets' Python side."""

import ctypes
import zlib
from collections.abc import Callable, Iterator

import pytest
from cobs import cobs
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract import packets
from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    FRAME_BYTES_MAX,
    Debug,
    Heartbeat,
    Hello,
    Navigation,
    Packet,
    Start,
    Stop,
    encode,
)
from robot_runtime.link import framing

CONTENT_MAX = FRAME_BYTES_MAX - 2
MESSAGES_MAX = CONTENT_MAX - 6

Decode = Callable[[bytes], tuple[list[list[tuple[int, bytes]]], int]]

int8s = st.integers(-127, 127).map(lambda count: count / 127)
unreliable: st.SearchStrategy[Packet] = st.one_of(
    st.just(Stop()),
    st.builds(Heartbeat, time=st.integers(0, 0xFFFFFFFF)),
    st.builds(Navigation, x=int8s, y=int8s, z=int8s, roll=int8s, pitch=int8s, yaw=int8s),
    st.builds(
        Hello,
        definitions=st.integers(0, 0xFFFFFFFF),
        epoch=st.integers(0, 0xFFFF),
        credit=st.integers(0, 0xFFFF),
    ),
)
reliable: st.SearchStrategy[Packet] = st.one_of(
    st.builds(Start, epoch=st.integers(0, 0xFFFF)),
    st.builds(
        Debug,
        time=st.integers(0, 0xFFFFFFFF),
        level=st.integers(0, 3),
        text=st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=40),
    ),
)


def fitting(some: list[Packet]) -> bool:
    return 0 < sum(len(encode(packet)) for packet in some) <= MESSAGES_MAX


frames = st.one_of(
    st.lists(unreliable, min_size=1, max_size=5), st.lists(reliable, min_size=1, max_size=5)
).filter(fitting)
keys = st.integers(0, 0xFFFFFFFF)


def raw_frame(content: bytes) -> bytes:
    """Return a frame of any control and messages with a valid checksum; 0 as number, where it has one."""
    first = packets.PACKETS.get(content[1]) if len(content) > 1 else None
    if first is None or not first.reliable:
        content += b"\0"
    return bytes(cobs.encode(content + zlib.crc32(content).to_bytes(4, "little"))) + b"\0"


@pytest.fixture(scope="session")
def decode(firmware: ctypes.CDLL) -> Decode:
    """The messages of each valid frame in some bytes, and the count of invalid ones, by a new decoder."""

    def run(data: bytes) -> tuple[list[list[tuple[int, bytes]]], int]:
        decoder = firmware.decoder_create()
        type_, payload = ctypes.c_uint8(), ctypes.create_string_buffer(64)
        results: list[list[tuple[int, bytes]]] = []
        for byte in data:
            if firmware.decoder_feed(decoder, byte):
                messages: list[tuple[int, bytes]] = []
                while (size := firmware.decoder_next(decoder, ctypes.byref(type_), payload)) >= 0:
                    messages.append((type_.value, payload.raw[:size]))
                results.append(messages)
        invalid = firmware.decoder_invalid(decoder)
        firmware.decoder_destroy(decoder)
        return results, invalid

    return run


def expected(some: list[Packet]) -> list[tuple[int, bytes]]:
    return [(encode(packet)[0], encode(packet)[1:]) for packet in some]


@given(data=st.binary(max_size=255))
def test_crc_is_zlibs(firmware: ctypes.CDLL, data: bytes) -> None:
    assert firmware.firmware_crc32(data, len(data)) == zlib.crc32(data)


@given(data=st.binary(min_size=1, max_size=253))
def test_cobs_is_the_packages(firmware: ctypes.CDLL, data: bytes) -> None:
    out = ctypes.create_string_buffer(255)
    size = firmware.firmware_encode_cobs(data, len(data), out)
    assert out.raw[:size] == cobs.encode(data)
    again = ctypes.create_string_buffer(cobs.encode(data), 255)
    assert firmware.firmware_decode_cobs(again, size) == len(data)
    assert again.raw[: len(data)] == data


# A zero would have ended the block.
@given(data=st.binary(min_size=1, max_size=63).map(lambda data: data.replace(b"\0", b"\1")))
def test_malformed_cobs_is_refused_where_the_package_refuses_it(firmware: ctypes.CDLL, data: bytes) -> None:
    try:
        good = cobs.decode(data)
    except cobs.DecodeError:
        good = b""
    room = ctypes.create_string_buffer(data, 64)
    size = firmware.firmware_decode_cobs(room, len(data))
    assert room.raw[:size] == good


@given(some=frames, number=st.integers(0, 4095))
def test_a_frame_of_the_host_is_decoded(decode: Decode, some: list[Packet], number: int) -> None:
    assert decode(framing.build(some, number, 0)) == ([expected(some)], 0)


@given(some=frames, key=keys, theirs=keys)
def test_frames_of_other_sessions_are_dropped(
    firmware: ctypes.CDLL, some: list[Packet], key: int, theirs: int
) -> None:
    decoder = firmware.decoder_create()
    firmware.decoder_set_key(decoder, key)
    taken = True in [firmware.decoder_feed(decoder, byte) for byte in framing.build(some, 0, 0, theirs)]
    opened = firmware.decoder_open(decoder)
    firmware.decoder_destroy(decoder)
    assert taken == (theirs in (key, framing.OPEN))
    if taken:
        assert opened == (theirs == framing.OPEN)


@given(some=st.lists(frames, min_size=1, max_size=4), key=keys)
def test_a_frame_of_the_board_is_decoded(firmware: ctypes.CDLL, some: list[list[Packet]], key: int) -> None:
    packer = firmware.packer_create()
    data, room = b"", ctypes.create_string_buffer(FRAME_BYTES_MAX)
    for number, frame in enumerate(some):
        for packet in frame:
            message = encode(packet)
            assert firmware.packer_add(packer, message[0], message[1:], len(message) - 1)
        size = firmware.packer_close(packer, number + 1000 * (not frame[0].reliable), 3, key, room)
        assert size <= FRAME_BYTES_MAX
        data += room.raw[:size]
    firmware.packer_destroy(packer)
    decoder = framing.Decoder()
    decoder.key = key
    heard = list(decoder.feed(data))
    assert [list(frame.messages) for frame in heard] == [expected(frame) for frame in some]
    numbers = [i + 1000 * (not frame[0].reliable) for i, frame in enumerate(some)]
    assert [(frame.number, frame.acknowledged) for frame in heard] == [(number, 3) for number in numbers]
    assert {frame.open for frame in heard} == {key == framing.OPEN}


@pytest.mark.parametrize("size", range(46))
def test_packer_takes_as_much_as_a_frame_holds(firmware: ctypes.CDLL, size: int) -> None:
    packer = firmware.packer_create()
    count = 0
    while firmware.packer_add(packer, 3, bytes(size), size):
        count += 1
    room = ctypes.create_string_buffer(FRAME_BYTES_MAX)
    written = firmware.packer_close(packer, 0, 0, 0, room)
    firmware.packer_destroy(packer)
    assert count == MESSAGES_MAX // (size + 1)
    assert written == count * (size + 1) + 8 <= FRAME_BYTES_MAX


@given(some=st.lists(frames, min_size=1, max_size=4), cuts=st.lists(st.integers(0, 255), max_size=3))
def test_frames_survive_zeros_between_them(decode: Decode, some: list[list[Packet]], cuts: list[int]) -> None:
    data = b"\0".join(bytes(len(cuts)) + framing.build(frame, 0, 0) for frame in some)
    assert decode(data) == ([expected(frame) for frame in some], 0)


@given(noise=st.binary(max_size=200), some=frames)
def test_a_frame_after_noise_is_decoded(decode: Decode, noise: bytes, some: list[Packet]) -> None:
    result, _ = decode(noise + b"\0" + framing.build(some, 0, 0))
    assert result[-1:] == [expected(some)]


@given(some=frames, cut=st.data())
def test_truncated_frame_is_dropped_and_counted(
    decode: Decode, some: list[Packet], cut: st.DataObject
) -> None:
    whole = framing.build(some, 0, 0)
    length = cut.draw(st.integers(1, len(whole) - 2))
    result, invalid = decode(whole[:length] + b"\0" + whole)
    assert result == [expected(some)]
    assert invalid == 1


@given(some=frames, flips=st.sets(st.integers(0, 8 * 63 - 1), min_size=1, max_size=8))
def test_frames_with_flipped_bits_are_never_accepted(
    decode: Decode, some: list[Packet], flips: set[int]
) -> None:
    whole = bytearray(framing.build(some, 0, 0))
    damaged = whole.copy()
    for flip in flips:
        damaged[flip // 8 % (len(whole) - 1)] ^= 1 << flip % 8
    result, invalid = decode(bytes(damaged))
    if damaged != whole:
        assert result == []
        assert invalid >= 1


@given(data=st.binary(max_size=300))
def test_garbage_is_dropped(decode: Decode, data: bytes) -> None:
    assert decode(data)[0] == []


@pytest.mark.parametrize("excess", [1, 2, 100, 1000])
def test_oversized_frame_is_dropped_whole(decode: Decode, excess: int) -> None:
    hello = encode(Hello(definitions=DEFINITIONS_HASH, epoch=1, credit=255))
    content = (b"\x00" + hello * 200)[: CONTENT_MAX - 4 + excess]
    stuffed = cobs.encode(content + zlib.crc32(content).to_bytes(4, "little"))
    result, invalid = decode(bytes(stuffed) + b"\0" + framing.build([Stop()], 0, 0))
    assert (result, invalid) == ([[(Stop.type, b"")]], 1)


@pytest.mark.parametrize("tail", [1, 2, 50])
def test_largest_frame_with_a_tail_is_dropped(decode: Decode, tail: int) -> None:
    start = Start(epoch=5)
    largest = framing.build([Debug(time=1, level=1, text="a" * 40), start, start, start, Stop()], 0, 0)
    assert len(largest) == FRAME_BYTES_MAX
    assert decode(largest)[1] == 0
    assert decode(largest[:-1] + b"\x01" * tail + b"\0") == ([], 1)


@pytest.mark.parametrize(
    ("messages", "why"),
    [
        (b"", "no message at all"),
        (b"\x07", "an unknown type"),
        (b"\xff\x00", "an unknown type"),
        (b"\x01\x05", "START with one byte missing"),
        (b"\x00\x01\x05\x00\x55", "an unknown type after good messages"),
        (b"\x02\0\0\0\0\0", "NAVIGATION with one byte missing"),
        (b"\x09\0\0\0\0\1", "a text without its size"),
        (b"\x09\0\0\0\0\1\x05abcd", "a text that is shorter than it says"),
        (b"\x09\0\0\0\0\1\x29" + b"a" * 41, "a text longer than texts may be"),
    ],
)
def test_wrong_length_or_type_refuses_the_whole_frame(decode: Decode, messages: bytes, why: str) -> None:
    assert decode(raw_frame(b"\x00" + messages)) == ([], 1), why


def test_the_decoder_returns_the_frame_s_number(firmware: ctypes.CDLL) -> None:
    decoder = firmware.decoder_create()
    for number in (0, 5, 15):
        fed = [firmware.decoder_feed(decoder, byte) for byte in framing.build([Start(epoch=1)], number, 0)]
        assert fed == [False] * (len(fed) - 1) + [True]
        assert firmware.decoder_number(decoder) == number
    firmware.decoder_destroy(decoder)


@pytest.fixture
def queue(firmware: ctypes.CDLL) -> Iterator[int]:
    made = firmware.queue_create()
    yield made
    firmware.queue_destroy(made)


def popped(firmware: ctypes.CDLL, queue: int, most: int) -> list[bytes]:
    """Take up to this many of the oldest messages."""
    room = ctypes.create_string_buffer(64)
    sizes = (firmware.queue_pop(queue, room) for _ in range(most))
    return [room.raw[:size] for size in sizes if size]


def pushed(firmware: ctypes.CDLL, queue: int, packet: Packet) -> bool:
    data = encode(packet)
    return bool(firmware.queue_push(queue, data[0], data[1:], len(data) - 1))


queueable: st.SearchStrategy[Packet] = st.one_of(
    st.builds(Debug, time=st.integers(0, 0xFFFFFFFF), level=st.integers(0, 3), text=st.text(max_size=20)),
    st.builds(
        packets.BoardEvent, time=st.integers(0, 9), kind=st.just(1), detail=st.just(2), value=st.just(3)
    ),
    st.builds(packets.TestMsg, number=st.integers(0, 0xFFFF)),
)


@given(some=st.lists(queueable, max_size=60), takes=st.lists(st.integers(0, 4), max_size=60))
def test_queued_lines_come_in_order(firmware: ctypes.CDLL, some: list[Packet], takes: list[int]) -> None:
    queue = firmware.queue_create()
    came: list[bytes] = []
    accepted: list[bytes] = []
    rest = iter(takes)
    for packet in some:
        if pushed(firmware, queue, packet):
            accepted.append(encode(packet))
        came += popped(firmware, queue, next(rest, 0))
    came += popped(firmware, queue, len(some))
    firmware.queue_destroy(queue)
    assert came == accepted


@pytest.mark.parametrize(
    ("message", "least"),
    [
        (packets.BoardEvent(time=1, kind=0, detail=0, value=1), 10),
        (Debug(time=1, level=0, text="a" * 40), 2),
    ],
)
def test_the_queue_holds_the_events_of_a_start_and_then_refuses(
    firmware: ctypes.CDLL, queue: int, message: Packet, least: int
) -> None:
    stored = sum(pushed(firmware, queue, message) for _ in range(100))
    assert least <= stored < 100
    assert popped(firmware, queue, 100) == [encode(message)] * stored


@given(number=st.integers(0, 0xFFFF))
def test_numbers_are_written_in_decimal(firmware: ctypes.CDLL, number: int) -> None:
    room = ctypes.create_string_buffer(40)
    size = firmware.debug_number(number, 0, room)
    assert room.raw[:size] == str(number).encode()
    size = firmware.debug_number(number % 100, 2, room)
    assert room.raw[:size] == f"{number % 100:02}".encode()
