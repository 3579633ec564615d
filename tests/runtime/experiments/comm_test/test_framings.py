"""The host's ends of the framings, against bytes written out by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.experiments.comm_test.framings import (
    ANSWER_BYTES,
    REQUEST_RESULT,
    STREAM_FRAMINGS,
    FramingName,
    find_answer,
    make_packet,
)
from robot_runtime.experiments.comm_test.results import Counts

PLAIN, THESIS = STREAM_FRAMINGS["plain"], STREAM_FRAMINGS["thesis"]
ANSWER = make_packet(REQUEST_RESULT, b"006200000001000200ff0384")
COUNTS = Counts(98, 0, 1, 2, 255, 900)


def test_numbers_on_the_wire() -> None:
    assert PLAIN.message(100) == b"\x00\x64"
    assert PLAIN.request == b"\xff"
    assert THESIS.message(0x1234) == b"~\x01\x12\x34\x00\x00\x00\x27\n"
    assert THESIS.request == b"~\x02\x00\x00\x00\x02\n"


@pytest.mark.parametrize("name", STREAM_FRAMINGS)
def test_a_clean_stream_counts_every_number(name: FramingName) -> None:
    framing = STREAM_FRAMINGS[name]
    stream = b"".join(map(framing.message, range(20, 120)))
    assert framing.count(stream, 20, 120) == Counts(right=100, bytes_read=len(stream))


def test_an_end_mark_within_a_packet_loses_exactly_two_numbers_of_the_thesis() -> None:
    counts = THESIS.count(b"".join(map(THESIS.message, range(1, 101))), 1, 101)
    assert counts == Counts(98, 0, 0, 2, 0, 900)
    lost = [n for n in range(1, 101) if THESIS.count(THESIS.message(n), 1, 101).right == 0]
    assert lost == [10, 11]


def test_a_changed_byte_is_a_checksum_error() -> None:
    assert THESIS.count(b"~\x01\x00\x05\x00\x00\x00\x05\n", 1, 101) == Counts(0, 0, 1, 0, 0, 9)
    assert THESIS.count(b"~\x01\x00\x05\x00\x01\x00\x04\n", 1, 101).checksum_errors == 1
    # The XOR's weakness: the same bit twice.
    assert THESIS.count(b"~\x01\x01\x05\x00\x00\x00\x05\n", 1, 1000).right == 1


def test_an_odd_number_of_lost_plain_bytes_spoils_all_that_follow() -> None:
    stream = b"".join(map(PLAIN.message, range(1, 11)))
    assert PLAIN.count(stream[:6] + stream[7:], 1, 101) == Counts(3, 6, 0, 1, 0, 19)


def test_numbers_from_before_the_test_are_out_of_sequence() -> None:
    stream = b"".join(map(PLAIN.message, (1, 2, 5, 4, 5, 6, 101)))
    assert PLAIN.count(stream, 1, 101) == Counts(4, 3, 0, 0, 0, 14)


def test_the_answer_is_found_behind_anything() -> None:
    assert find_answer(ANSWER) == (COUNTS, 0)
    assert find_answer(b"~\x02~\x02\n" + ANSWER + ANSWER) == (COUNTS, 5)


def test_a_damaged_answer_is_none() -> None:
    assert len(ANSWER) == ANSWER_BYTES
    for at in range(len(ANSWER)):
        changed = bytearray(ANSWER)
        changed[at] ^= 0x10
        assert find_answer(bytes(changed)) is None
    assert find_answer(ANSWER[:-1]) is None
    assert find_answer(make_packet(REQUEST_RESULT, b"g" * 24)) is None


@given(st.binary(max_size=200))
def test_noise_never_breaks_a_receiver(noise: bytes) -> None:
    for framing in STREAM_FRAMINGS.values():
        counts = framing.count(noise, 1, 101)
        assert counts.bytes_read == len(noise)
        assert counts.right <= 100
    find_answer(noise)
