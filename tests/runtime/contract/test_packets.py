"""Packets: encoding and decoding, limits, refusals."""

import math
from functools import partial
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract.packets import (
    FRAME_BYTES_MAX,
    PACKETS,
    Debug,
    Depth,
    Motor,
    Navigation,
    Packet,
    decode,
    encode,
)
from robot_runtime.contract.packets.layout import LayoutError, Wire


def _scaled(wire: Wire, count: int) -> float:
    return count if wire.scale == 1 else count * wire.scale


@st.composite
def packets(draw: st.DrawFn) -> Packet:
    """Any packet, each field at any count that its code can hold."""
    cls = draw(st.sampled_from(sorted(PACKETS.values(), key=lambda packet: packet.type)))
    values: dict[str, Any] = {}
    for name, wire in cls.wires.items():
        bits = wire.size // wire.count * 8
        low, high = (0, 2**bits - 1) if wire.code.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        counts = st.integers(low, high).map(partial(_scaled, wire))
        values[name] = draw(st.tuples(*[counts] * wire.count)) if wire.count > 1 else draw(counts)
    if cls.tail:
        name, text = cls.tail
        values[name] = draw(st.text(max_size=text.max_bytes // 4))
    return cls(**values)


@given(packets())
def test_every_packet_survives_its_own_bytes(packet: Packet) -> None:
    data = encode(packet)
    assert decode(data[0], data[1:]) == packet


@given(packets(), st.integers(-3, 3).filter(bool))
def test_a_wrong_length_is_refused(packet: Packet, change: int) -> None:
    data = packet.to_bytes()
    wrong = data[:change] if change < 0 else data + bytes(change)
    if len(wrong) == len(data):
        return
    with pytest.raises(LayoutError, match="bytes; expected"):
        type(packet).from_bytes(wrong)


def test_the_type_numbers_of_the_thesis_are_unchanged() -> None:
    assert {cls.__name__: number for number, cls in PACKETS.items() if number < 0x0A} == {
        "Stop": 0,
        "Start": 1,
        "Navigation": 2,
        "Imu": 3,
        "Depth": 4,
        "Beacon": 5,
        "Motor": 6,
        "Debug": 9,
    }


def test_a_navigation_command_is_six_signed_bytes() -> None:
    command = Navigation(x=0.0, y=0.5, z=1.0, roll=-1.0, pitch=2.0, yaw=-7.0)
    assert command.to_bytes() == bytes([0, 64, 127, 256 - 127, 127, 128])


def test_numbers_out_of_range_are_clamped() -> None:
    depth = Depth(time=0, depth=100.0, pressure=-1, temperature=0.0)
    assert Depth.from_bytes(depth.to_bytes()).depth == pytest.approx(32.767)
    assert Depth.from_bytes(depth.to_bytes()).pressure == 0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_nan_is_refused(value: float) -> None:
    with pytest.raises(LayoutError, match="Navigation cannot be written"):
        Navigation(x=value, y=0.0, z=0.0, roll=0.0, pitch=0.0, yaw=0.0).to_bytes()


def test_long_text_is_cut_at_a_whole_character() -> None:
    data = Debug(time=0, level=1, text="é" * 30 + "x").to_bytes()
    assert Debug.from_bytes(data).text == "é" * 20
    odd = Debug(time=0, level=1, text="x" + "é" * 30).to_bytes()
    assert Debug.from_bytes(odd).text == "x" + "é" * 19


def test_an_unknown_type_is_refused() -> None:
    with pytest.raises(LayoutError, match="0x7f"):
        decode(0x7F, b"")


def test_the_fastest_telemetry_shares_one_frame() -> None:
    imu, motor = PACKETS[3].layout.size, Motor.layout.size
    control, crc, cobs, end = 1, 4, 1, 1
    assert control + (1 + imu) + (1 + motor) + crc + cobs + end <= FRAME_BYTES_MAX
