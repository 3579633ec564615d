"""The serial line between two UARTs, at equal and at different speeds."""

import os
import random

import psutil
import pytest

from tests.board.conftest import Make
from tests.board.monitor import SerialMonitor
from tests.board.rig import CLOCK, wait_for

CHARACTER_BITS = 10
CHIP_BIT = 136 / CLOCK
"""s; the chip's 115200 is 117647."""
START = 0.01
"""s for a sketch to be ready."""


def random_bytes(count: int) -> bytes:
    return (
        random.Random(7).randbytes(count).translate(bytes(byte if byte > 4 else 255 for byte in range(256)))
    )


def test_500_bytes_take_as_long_as_on_copper(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    rig.port.write(random_bytes(500))
    took = rig.run_until(lambda: rig.board.stats()["bytes_to_board"] == 500, step=1e-5, limit=0.1)
    # The last byte is there in the middle of its stop bit.
    expected = 499 * CHARACTER_BITS / 115200 + 9.5 * CHIP_BIT
    assert took == pytest.approx(expected, abs=2e-5)
    assert 0.0432 < took < 0.0435


@pytest.mark.parametrize(("code", "baud"), [(1, 9600), (2, 115200), (3, 250000), (4, 500000)])
def test_echo_at_the_chips_speed(make_rig: Make, code: int, baud: int) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    assert rig.exchange(bytes([code]), 0.002) == bytes([code])
    rig.port.set_baud(baud)
    data = random_bytes(200)
    assert rig.exchange(data, 230 * CHARACTER_BITS / baud) == data
    stats = rig.board.stats()
    assert stats["framing_errors_board"] == stats["framing_errors_host"] == stats["overruns"] == 0


@pytest.mark.parametrize("baud", [112000, 123000])
def test_nearly_the_same_speed_works(make_rig: Make, baud: int) -> None:
    rig = make_rig("echo", baud=baud)
    rig.board.run(START)
    data = random_bytes(100)
    assert rig.exchange(data, 0.02) == data


@pytest.mark.parametrize("baud", [9600, 57600, 108000, 128000, 250000])
def test_another_speed_gives_garbage_and_framing_errors(make_rig: Make, baud: int) -> None:
    rig = make_rig("echo", baud=baud)
    rig.board.run(START)
    data = random_bytes(100)
    assert rig.exchange(data, 0.02 + 130 * CHARACTER_BITS / baud) != data
    assert rig.board.stats()["framing_errors_board"] > 0


def test_bytes_before_a_much_slower_receiver_take_as_long_as_on_copper(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    assert rig.exchange(bytes([1]), 0.002) == bytes([1])  # from now on at 9600
    rig.port.set_baud(250_000)
    rig.port.write(random_bytes(500))
    rig.run_until(lambda: rig.board.stats()["waiting"] > 0, step=1e-5, limit=0.1)
    took = rig.run_until(lambda: rig.board.stats()["waiting"] == 0, step=1e-5, limit=0.1)
    assert took == pytest.approx(500 * CHARACTER_BITS / 250_000, abs=2e-4)


def test_a_program_that_does_not_read_keeps_three_bytes_and_detects_the_overrun(make_rig: Make) -> None:
    rig = make_rig("deaf")
    rig.board.run(START)
    data = random_bytes(100)
    output = rig.exchange(data, 0.06)
    assert output[0::2] == data[:3]
    data_overrun = 1 << 3
    assert output[1] & data_overrun
    stats = rig.board.stats()
    assert stats["overruns"] == 97
    assert stats["bytes_to_board"] == 100


def test_two_bytes_wait_while_interrupts_are_disabled(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    rig.exchange(bytes([4]), 0.002)
    rig.port.set_baud(500000)
    rig.exchange(bytes([0]), 0.002)
    # Up to three bytes come in the 45 µs; the program then fetches them quicker than others come.
    data = random_bytes(200)
    assert rig.exchange(data, 0.05) == data
    assert rig.board.stats()["overruns"] == 0


def test_a_program_gets_a_byte_as_soon_as_it_has_come(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    rig.port.write(b"x")
    rig.run_until(lambda: rig.board.stats()["bytes_to_board"] == 1, step=1e-6, limit=1e-3)
    took = rig.run_until(lambda: rig.board.stats()["bytes_from_board"] == 1, step=1e-6, limit=1e-3)
    assert took < 10e-6


def test_the_program_sees_framing_errors(make_rig: Make) -> None:
    rig = make_rig("deaf", baud=57600)
    rig.board.run(START)
    # At half the speed a zero lasts as long as 18 of the chip's bits: a zero byte and no stop bit.
    rig.exchange(b"\0", 0.02)
    rig.port.set_baud(115200)
    output = rig.exchange(b"", 0.04)
    framing_error = 1 << 4
    assert output[0] == 0
    assert output[1] & framing_error


def test_characters_leave_without_gaps(make_rig: Make) -> None:
    monitor = SerialMonitor(rig := make_rig("monitor"))
    monitor.boot()
    # The last character has gone when its stop bit has, and the loop that sees it takes a few cycles.
    assert monitor.flood() == pytest.approx(16 * CHARACTER_BITS * CHIP_BIT, abs=3e-6)
    assert rig.board.stats()["framing_errors_host"] == 0


def test_the_host_gets_eight_bytes_at_a_time_or_the_bytes_before_a_pause(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    rig.port.write(random_bytes(12))
    given: list[int] = []
    for _ in range(300):
        rig.board.run(1e-5)
        given.append(int(rig.board.stats()["bytes_to_host"]))
    assert sorted(set(given)) == [0, 8, 12]
    character = CHARACTER_BITS * CHIP_BIT
    silence = (given.index(12) - given.index(8)) * 1e-5 - 4 * character
    assert silence == pytest.approx(32 / 115200, abs=4e-5)


def test_a_host_that_does_not_read_loses_bytes_and_never_stops_the_board(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    rig.exchange(bytes([4]), 0.002)
    rig.port.set_baud(500000)
    sent = 0
    while rig.board.stats()["bytes_lost"] == 0:
        assert sent < 300_000, "the operating system keeps everything"
        rig.port.write(random_bytes(4000))
        rig.board.run(4000 * CHARACTER_BITS / 500000)
        sent += 4000
    rig.board.run(0.01)
    stats = rig.board.stats()
    assert stats["bytes_from_board"] == stats["bytes_to_board"] == sent + 1
    assert stats["bytes_to_host"] + stats["bytes_lost"] >= stats["bytes_from_board"] - 8


def test_the_port_can_be_closed_and_opened_again(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(START)
    assert rig.exchange(b"before", 0.01) == b"before"
    rig.port.write(b"unheard")
    rig.port.close()
    rig.board.run(0.01)
    assert rig.board.stats()["bytes_lost"] == len(b"unheard")
    again = type(rig.port)(rig.process.tty, rig.board, 115200)
    rig.port = again
    assert rig.exchange(b"after", 0.01) == b"after"


def test_opening_the_port_resets_the_board_with_reset_on_open(make_rig: Make) -> None:
    rig = make_rig("monitor", "--reset-on-open")
    external = 1 << 1
    wait_for(lambda: rig.board.stats()["resets"] == 2, "the reset")
    assert SerialMonitor(rig).boot() == external
    os.close(os.open(rig.process.tty, os.O_RDWR | os.O_NOCTTY))  # it is open already: no reset
    rig.board.run(0.01)
    assert rig.board.stats()["resets"] == 2


def test_closing_and_opening_the_port_unnoticed_resets_the_board(make_rig: Make) -> None:
    rig = make_rig("monitor", "--reset-on-open")
    wait_for(lambda: rig.board.stats()["resets"] == 2, "the reset")
    rig.port.write(b"of the host before")
    emulator = psutil.Process(rig.process.process.pid)
    emulator.suspend()
    wait_for(lambda: emulator.status() == psutil.STATUS_STOPPED, "the board to stand still")
    rig.port.close()
    again = os.open(rig.process.tty, os.O_RDWR | os.O_NOCTTY)
    emulator.resume()
    rig.board.run(0.01)
    assert rig.board.stats()["resets"] == 3
    assert rig.board.stats()["bytes_to_board"] == 0
    os.close(again)
