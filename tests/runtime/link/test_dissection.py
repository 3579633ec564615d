"""Stored frames as text: their contents, and the reasons of dropped ones."""

import pytest

from robot_runtime.contract.packets import (
    FRAME_BYTES_MAX,
    Acknowledge,
    Beacon,
    Debug,
    Hello,
    Start,
    Stop,
    encode,
)
from robot_runtime.link.dissection import dissect
from robot_runtime.link.frame_ring import RecordedFrame
from robot_runtime.link.framing import OPEN, assemble, build

KEY = 0x0001_0004
BEACON = Beacon(time=5, right=0, left=1)


def recorded(frame: bytes, key: int = KEY, sent: bool = False) -> RecordedFrame:
    return RecordedFrame(1.5, sent, key, frame.removesuffix(b"\0"))


def test_a_frame_is_described_by_its_numbers_and_bytes() -> None:
    line = Debug(time=1, level=1, text="hello")
    frame = build([line, line, Acknowledge(held=3)], 5, 12, KEY)
    answer = dissect(recorded(frame))
    assert answer.kinds == ["Debug", "Debug", "Acknowledge"]
    assert (answer.reliable, answer.open, answer.number, answer.acknowledged) == (True, False, 5, 12)
    assert (answer.time, answer.sent, answer.problem) == (1.5, False, "")
    assert bytes.fromhex(answer.bytes) == frame


def test_unreliable_and_open_frames_are_distinguished() -> None:
    answer = dissect(recorded(build([BEACON], 3000, 2, KEY), sent=True))
    assert (answer.kinds, answer.reliable, answer.open, answer.number, answer.sent) == (
        ["Beacon"],
        False,
        False,
        3000,
        True,
    )
    answer = dissect(recorded(build([Stop()], 0, 0, OPEN)))
    assert (answer.kinds, answer.open, answer.problem) == (["Stop"], True, "")


GOOD = build([BEACON], 1, 0, KEY)
UNKNOWN = assemble(b"\x70" + encode(BEACON), False, 1, 0, KEY)
CUT = assemble(encode(Hello(definitions=1, epoch=2, credit=3))[:-1], False, 1, 0, KEY)


@pytest.mark.parametrize(
    ("frame", "why"),
    [
        (GOOD[:-2] + bytes([GOOD[-2] ^ 1]), "wrong checksum"),
        (build([BEACON], 1, 0, KEY + 1), "another session"),
        (b"\x20\x01", "stuffing"),
        (b"\x03\x01\x02", "too short"),
        (b"\x40" + bytes([7]) * (FRAME_BYTES_MAX - 1), f"longer than {FRAME_BYTES_MAX}"),
        (b"", "too short"),
        (UNKNOWN, "other definitions"),
        (CUT, "other definitions"),
    ],
    ids=["bit", "session", "cobs", "short", "long", "nothing", "unknown", "length"],
)
def test_errors_are_named(frame: bytes, why: str) -> None:
    assert why in dissect(recorded(frame)).problem


@pytest.mark.parametrize("key", [OPEN, KEY])
def test_a_valid_frame_is_never_called_wrong(key: int) -> None:
    for packets in ([Start(epoch=4)], [BEACON], [Debug(time=0, level=0, text="")]):
        assert dissect(recorded(build(packets, 7, 7, key))).problem == ""
