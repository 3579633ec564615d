"""Resets, the watchdog, sleep, the EEPROM and crashing programs."""

from pathlib import Path

import pytest

from robot_runtime.simulation.boards.emulator_process import BoardError
from tests.board.conftest import Make
from tests.board.monitor import SerialMonitor
from tests.board.rig import SKETCHES, BoardRig

POWER_ON, RESET_PIN, BROWN_OUT, WATCHDOG = 1 << 0, 1 << 1, 1 << 2, 1 << 3


def test_the_program_learns_the_reset_cause(make_rig: Make) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    assert monitor.boot() == POWER_ON
    rig.board.reset()
    assert monitor.boot() == RESET_PIN
    assert rig.board.stats()["resets"] == 2


@pytest.mark.parametrize("lost", [0.0, 0.3, 1.0])
def test_a_brown_out_loses_a_part_of_the_memory(make_rig: Make, lost: float) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    monitor.boot()
    monitor.outputs(1 << 3)
    monitor.fill_memory()
    rig.board.brown_out(lost)
    assert not rig.board.fins().powered
    assert monitor.boot() == BROWN_OUT
    # One random byte in 256 is what it was.
    assert monitor.memory_lost() == pytest.approx(lost * 255 / 256, abs=0.08 if 0 < lost < 1 else 0.01)
    with pytest.raises(BoardError, match="the share of the memory"):
        rig.board.brown_out(1.1)


def test_two_brown_outs_are_not_alike(make_rig: Make) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    monitor.boot()
    lost = []
    for _ in range(2):
        monitor.fill_memory()
        rig.board.brown_out(0.5)
        monitor.boot()
        lost.append(monitor.memory_lost())
    assert lost[0] != lost[1]


# It hangs in a loop, sleeps with interrupts off, or jumps into erased memory.
@pytest.mark.parametrize("command", [b"H", b"Z", b"J"])
def test_the_watchdog_resets_a_hung_chip(make_rig: Make, command: bytes) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    monitor.boot()
    rig.port.write(command)
    took = rig.run_until(lambda: rig.board.stats()["watchdog_resets"] == 1, step=0.001, limit=0.4)
    # The watchdog's 250 ms are 32768 cycles of its 128 kHz.
    assert took == pytest.approx(0.256, abs=0.003)
    assert monitor.boot() == WATCHDOG
    # Time has advanced outside the chip too: line, motors and buses work as before.
    assert monitor.transfer(0x76)[0] == 0x18
    assert monitor.flood() > 0
    assert rig.board.stats()["resets"] == 2


def test_a_hung_chip_without_watchdog_stays_hung(make_rig: Make) -> None:
    rig = make_rig("monitor")
    SerialMonitor(rig).boot()
    rig.port.write(b"J")
    rig.board.run(0.1)
    rig.board.reset()
    SerialMonitor(rig).boot()
    assert rig.board.stats()["crashes"] == 1


def test_bytes_on_the_line_are_cut_off_by_a_reset(make_rig: Make) -> None:
    rig = make_rig("monitor")
    SerialMonitor(rig).boot()
    rig.port.write(b"F")
    rig.board.run(0.5e-3)
    rig.board.reset()
    rig.board.run(5e-3)
    output = rig.port.read()
    assert output.count(b"x") < 10
    assert output.endswith(b"R" + bytes([RESET_PIN]))


def test_writing_the_eeprom_takes_its_time(make_rig: Make) -> None:
    rig = make_rig("monitor")
    monitor = SerialMonitor(rig)
    monitor.boot()
    assert monitor.read_eeprom(0) == 0xFF
    assert monitor.read_eeprom(200) == 0xFF
    assert monitor.write_eeprom(200, 0x5A) == pytest.approx(3.4e-3, abs=20e-6)
    assert monitor.read_eeprom(200) == 0x5A


@pytest.mark.usefixtures("built")
def test_the_eeprom_survives_a_kill_of_the_board(tmp_path: Path) -> None:
    options = ("--eeprom", str(tmp_path / "eeprom"))
    rig = BoardRig(SKETCHES / "monitor.elf", tmp_path, *options)
    with rig:
        monitor = SerialMonitor(rig)
        monitor.boot()
        monitor.write_eeprom(3, 42)
        rig.process.process.kill()
        rig.process.process.wait()
    assert (tmp_path / "eeprom").stat().st_size == 1024
    with BoardRig(SKETCHES / "monitor.elf", tmp_path, *options) as again:
        monitor = SerialMonitor(again)
        monitor.boot()
        assert monitor.read_eeprom(3) == 42


def test_a_timer_in_phase_correct_pwm_overflows_when_it_has_counted_up_and_down(make_rig: Make) -> None:
    monitor = SerialMonitor(make_rig("monitor"))
    monitor.boot()
    assert monitor.phase_correct_period() == pytest.approx(510 / 2e6, rel=0.02)


def test_another_program_can_be_loaded(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(0.01)
    assert rig.exchange(b"hello", 0.01) == b"hello"
    rig.board.load(SKETCHES / "monitor.elf")
    assert SerialMonitor(rig).boot() == RESET_PIN


def test_an_invalid_program_is_refused_and_the_old_one_runs_on(make_rig: Make) -> None:
    rig = make_rig("echo")
    rig.board.run(0.01)
    with pytest.raises(BoardError, match="not an ELF file for an AVR"):
        rig.board.load(Path(__file__))
    with pytest.raises(BoardError, match="No such file"):
        rig.board.load(Path("/nowhere.elf"))
    assert rig.exchange(b"hello", 0.01) == b"hello"
    assert rig.board.stats()["resets"] == 1


def test_time_is_exact(make_rig: Make) -> None:
    rig = make_rig("echo")
    assert [rig.board.run(0.0001) for _ in range(1000)][-1] == pytest.approx(0.1, abs=1e-6)
    assert rig.board.run(1.0) == pytest.approx(1.1, abs=1e-6)
