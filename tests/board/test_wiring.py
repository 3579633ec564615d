"""The pins and addresses of the firmware, and of the emulated devices, are those of the wiring's table.

A probe runs the firmware on a bare chip and notes what it does with its pins; no source is read.
"""

import subprocess
from collections import defaultdict

import pytest

from robot_runtime.contract.wiring import (
    BATTERY_MAX,
    FINS,
    IMU_ADDRESS,
    PRESSURE_ADDRESS,
    SPARE_OUTPUTS,
    WIRES,
    Conductor,
    Net,
)
from robot_runtime.generate.hardware import chip_pin
from robot_runtime.simulation.boards.emulator_process import STILL_WATER
from tests.board.monitor import ACKNOWLEDGED_ADDRESS, SerialMonitor
from tests.board.rig import ROOT, BoardRig, build

SERIAL = {"D0", "D1"}
"""The chip's serial unit takes these whatever their direction says."""
SECONDS = "1.0"

Notes = dict[str, list[list[str]]]


@pytest.fixture(scope="session")
def notes(built: None) -> Notes:  # noqa: ARG001 - it builds as well
    """The probe's lines about the firmware's first second, by their first word."""
    build(ROOT / "firmware", "robot")
    build(ROOT / "tests/board/pin_probe")
    command = [str(ROOT / "build/pin_probe/pin_probe"), str(ROOT / "build/firmware/robot.elf"), SECONDS]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    result: Notes = defaultdict(list)
    for line in printed.splitlines():
        word, *rest = line.split()
        result[word].append(rest)
    return result


def board_pins(net: Net | None = None, *, driven: bool) -> set[str]:
    """Return the board's pins that it drives, or reads, by the table; I2C is neither."""
    wires = [wire for wire in WIRES if wire.net is not Net.I2C and net in (None, wire.net)]
    if driven:
        return {wire.source_pin for wire in wires if wire.source == "board"}
    return {wire.sink_pin for wire in wires if wire.sink == "board"} - {"VCC", "GND", "RST"}


def find_wire(source: str, sink: str) -> Conductor:
    """Return the only wire between these parts that is no supply."""
    supplies = (Net.SUPPLY, Net.GROUND)
    (wire,) = [
        wire for wire in WIRES if (wire.source, wire.sink) == (source, sink) and wire.net not in supplies
    ]
    return wire


def find_pin(source: str, sink: str) -> str:
    """Return the board's pin of the only wire between these parts."""
    wire = find_wire(source, sink)
    return wire.source_pin if source == "board" else wire.sink_pin


def bits(rows: list[list[str]]) -> set[str]:
    """Return the chip's pins in lines of a port and a mask."""
    return {f"P{port}{bit}" for port, mask in rows for bit in range(8) if int(mask, 16) >> bit & 1}


def on_chip(pins: set[str]) -> set[str]:
    return {chip_pin(pin) for pin in pins}


def mask(pin: str) -> int:
    """Return the bit of a pin in its port."""
    return 1 << int(chip_pin(pin)[2])


# The firmware


def test_the_outputs_are_those_of_the_table(notes: Notes) -> None:
    outputs = board_pins(driven=True) | set(SPARE_OUTPUTS)
    assert bits(notes["direction"]) == on_chip(outputs - SERIAL)
    assert not bits(notes["direction"]) & on_chip(board_pins(driven=False))


def test_each_fin_s_encoder_is_selected_by_its_pin(notes: Notes) -> None:
    selects = on_chip({fin.select for fin in FINS})
    low = [bits([["B", b], ["D", d]]) & selects for b, d in notes["byte"]]
    in_turn = [{chip_pin(fin.select)} for fin in FINS for _ in range(3)]
    assert low == 2 * in_turn


def test_only_the_encoders_data_line_and_the_leak_sensor_have_a_pull_up(notes: Notes) -> None:
    pulled = board_pins(Net.SPI, driven=False) | {find_pin("leak_sensor", "board")}
    assert bits(notes["pulled"]) == on_chip(pulled)


def test_the_i2c_addresses_are_those_of_the_table(notes: Notes) -> None:
    addresses = [int(address, 16) for (address,) in notes["address"]]
    assert addresses[: len(FINS)] == [fin.address for fin in FINS]
    assert set(addresses[len(FINS) :]) == {IMU_ADDRESS, PRESSURE_ADDRESS}


def test_the_led_blinks_at_its_pin_and_nothing_else_changes(notes: Notes) -> None:
    edges = {f"P{port}{bit}": int(count) for port, bit, count in notes["edges"]}
    selects = on_chip({fin.select for fin in FINS})
    # Five times a second: the bare chip has no sensors, which is a fault.
    assert {pin: count for pin, count in edges.items() if pin not in selects} == {
        chip_pin(find_pin("board", "led")): 10
    }


def test_the_motors_have_no_power_from_the_first_instruction(notes: Notes) -> None:
    power = chip_pin(find_pin("board", "motor_regulator"))
    assert power in bits(notes["direction"])
    assert [power[1], power[2]] not in notes["high"]


def test_the_battery_is_read_at_its_pin(notes: Notes) -> None:
    assert notes["converted"] == [[find_pin("battery", "board").removeprefix("A")]]


def test_the_serial_line_is_that_of_the_table(notes: Notes) -> None:
    assert {find_pin("pi", "board"), find_pin("board", "pi")} == SERIAL
    ((sent,),) = notes["sent"]
    assert int(sent) > 100
    assert notes["listens"] == [["1"]]


# The emulated devices


def test_the_emulated_bus_has_the_devices_of_the_table(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(mask(find_pin("board", "motor_regulator")))
    assert rig.board.fins().powered
    answering = {address for address in range(8, 120) if monitor.transfer(address)[0] == ACKNOWLEDGED_ADDRESS}
    assert answering == {fin.address for fin in FINS} | {IMU_ADDRESS, PRESSURE_ADDRESS}
    for number, fin in enumerate(FINS):
        monitor.transfer(fin.address, bytes([0, 20 << 2 | 1]))
        assert [drive for drive in rig.board.fins().drives if drive] == [20] * (number + 1)
        assert rig.board.fins().drives[number] == 20


def test_the_emulated_pins_are_those_of_the_table(rig: BoardRig, monitor: SerialMonitor) -> None:
    monitor.outputs(mask(find_pin("board", "led")))
    assert rig.board.led()
    sides = {wire.source_pin: mask(wire.sink_pin) for wire in WIRES if wire.source == "detector"}
    rig.board.sense(STILL_WATER._replace(beacon_right=True, battery=BATTERY_MAX))
    assert monitor.inputs() & (sides["right"] | sides["left"]) == sides["right"]
    rig.board.sense(STILL_WATER._replace(beacon_left=True, battery=BATTERY_MAX))
    assert monitor.inputs() & (sides["right"] | sides["left"]) == sides["left"]
    water = mask(find_pin("leak_sensor", "board"))
    assert monitor.inputs() & water
    rig.board.fault("leak", "wet")
    assert not monitor.inputs() & water
    divider = find_wire("battery", "board")
    counts = monitor.adc(int(divider.sink_pin.removeprefix("A")))
    assert counts == pytest.approx(divider.level / 5 * 1023, abs=1)
