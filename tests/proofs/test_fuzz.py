"""A short version of `make fuzz`, and the same for the host: valid checksums around any content."""

import ctypes
import zlib
from pathlib import Path

import pytest
from cobs import cobs
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_runtime.contract.packets import DEFINITIONS_HASH, FRAME_BYTES_MAX, PACKETS, Hello, encode
from robot_runtime.link.framing import OPEN, Decoder, Frame, assemble
from robot_runtime.link.session import LinkSession, session_key
from tests.proofs import fuzz

EXECUTIONS = 15_000
HOST, BOARD = 5, 6
KEY = session_key(HOST, BOARD)


# On a busy computer it takes minutes.
@pytest.mark.timeout(900)
def test_the_firmware_survives_any_input(tmp_path: Path) -> None:
    fuzz.prepare(tmp_path / "corpus")
    assert fuzz.run(tmp_path / "corpus", f"-runs={EXECUTIONS}", "-seed=1") == EXECUTIONS


def framed(content: bytes, key: int) -> bytes:
    return bytes(cobs.encode(content + (zlib.crc32(content) ^ key).to_bytes(4, "little"))) + b"\0"


@st.composite
def contents(draw: st.DrawFn) -> bytes:
    """Control, messages of known and other types, sometimes too short or too long, and a number."""
    content = draw(st.binary(min_size=1, max_size=1))
    for type_ in draw(st.lists(st.sampled_from([*PACKETS, 7, 0xFF]), max_size=5)):
        cls = PACKETS.get(type_)
        size = cls.layout.size if cls else draw(st.integers(0, 8))
        content += bytes([type_]) + draw(st.binary(min_size=size, max_size=size))
        if cls and cls.tail:
            text = draw(st.binary(max_size=20) | st.binary(min_size=39, max_size=42))
            content += bytes([draw(st.just(len(text)) | st.integers(0, 255))]) + text
    content += draw(st.binary(max_size=3))
    return content[: FRAME_BYTES_MAX - 6]


@given(st.lists(st.binary(max_size=100), max_size=5))
def test_garbage_in_any_pieces_is_never_a_frame(pieces: list[bytes]) -> None:
    decoder = Decoder()
    decoder.key = KEY
    assert [frame for piece in pieces for frame in decoder.feed(piece)] == []


def again(frame: Frame) -> bytes:
    messages = b"".join(bytes([type_]) + payload for type_, payload in frame.messages)
    key = OPEN if frame.open else KEY
    return assemble(messages, frame.reliable, frame.number, frame.acknowledged, key)


@settings(max_examples=1000)
@given(contents(), st.sampled_from([OPEN, KEY]))
def test_both_decoders_agree_on_any_content(firmware: ctypes.CDLL, content: bytes, key: int) -> None:
    data = framed(content, key)
    decoder = Decoder()
    decoder.key = KEY
    believed = list(decoder.feed(data))
    chip = firmware.decoder_create()
    firmware.decoder_set_key(chip, KEY)
    chips = [firmware.decoder_feed(chip, byte) for byte in data][-1]
    messages = []
    type_, payload = ctypes.c_uint8(), ctypes.create_string_buffer(64)
    while chips and (size := firmware.decoder_next(chip, ctypes.byref(type_), payload)) >= 0:
        messages.append((type_.value, payload.raw[:size]))
    firmware.decoder_destroy(chip)
    assert [again(frame) for frame in believed] == [data] * chips
    assert [list(frame.messages) for frame in believed] == [messages] * chips


@settings(max_examples=300)
@given(st.lists(st.tuples(contents(), st.sampled_from([OPEN, KEY])), max_size=20))
def test_the_host_s_session_survives_any_input(answer: list[tuple[bytes, int]]) -> None:
    session = LinkSession(HOST, 250_000)
    hello = encode(Hello(definitions=DEFINITIONS_HASH, epoch=BOARD, credit=64))
    session.receive(framed(b"\0" + hello + b"\0", OPEN), 0.0)
    for step, (content, key) in enumerate(answer):
        session.receive(framed(content, key), step / 100)
        session.poll(step / 100)
