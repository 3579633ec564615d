"""The wiring's table: no wire damages a part, and nothing is forgotten."""

import re
from dataclasses import replace

import pytest

from robot_runtime.config import LinkConfig
from robot_runtime.contract.wiring import (
    BATTERY_MAX,
    FINS,
    IMU_ADDRESS,
    IMU_STRAP,
    PARTS,
    RESET_LINE,
    SPARE_OUTPUTS,
    SPARE_PINS,
    WIRES,
    Net,
    Strap,
    bridge_address,
    find_wiring_faults,
    imu_address,
)
from robot_runtime.generate import hardware, wiring_drawing
from robot_runtime.generate.wiring_picture import wiring_picture

BOARD_PINS = {f"D{number}" for number in range(14)} | {f"A{number}" for number in range(6)}
HEADER = {"1": "3.3 V", "2": "5 V", "6": "ground", "7": "GPIO 4", "8": "GPIO 14", "10": "GPIO 15"}
"""The pins of the Pi's header that are used; a Pi's own manual says what they are."""


def test_no_wire_damages_a_part_and_each_level_is_read() -> None:
    assert list(find_wiring_faults()) == []


@pytest.mark.parametrize(
    ("sink", "pin", "level", "fault"),
    [
        ("bridge", "VCC", BATTERY_MAX, "8.4 V at H-bridge VCC: outside its supply range"),
        ("board", "VCC", BATTERY_MAX, "8.4 V at board VCC: outside its supply range"),
        ("pressure", "VDD", 5.0, "5 V at pressure sensor VDD: outside its supply range"),
        ("pi", "10", 5.0, "5 V at Raspberry Pi 10: it bears 3.6 V"),
        ("board", "A2", BATTERY_MAX, "8.4 V at board A2: it bears 5.5 V"),
        ("imu", "SDA", 5.0, "5 V at IMU SDA: it bears 3.8 V"),
        ("shifter", "HV1", 3.3, "3.3 V at level shifter HV1: it reads high from 3.5 V on"),
        ("board", "RST", 3.3, "3.3 V at board RST: it reads high from 4.5 V on"),
    ],
)
def test_a_wire_that_must_not_be_is_found(sink: str, pin: str, level: float, fault: str) -> None:
    (wire,) = [one for one in WIRES if (one.sink, one.sink_pin) == (sink, pin)]
    assert fault in list(find_wiring_faults([replace(wire, level=level)]))


def test_a_bus_is_checked_at_both_ends() -> None:
    (wire,) = [one for one in WIRES if (one.source_pin, one.sink_pin) == ("A4", "HV1")]
    faults = list(find_wiring_faults([replace(wire, level=3.3)]))
    assert "3.3 V at board A4: it reads high from 3.5 V on" in faults


@pytest.mark.parametrize(("sink", "pin", "source_volts"), [("pi", "10", 5.0), ("board", "A2", BATTERY_MAX)])
def test_the_resistors_of_a_divider_give_its_level(sink: str, pin: str, source_volts: float) -> None:
    (wire,) = [one for one in WIRES if (one.sink, one.sink_pin) == (sink, pin)]
    series, shunt = (float(ohms) for ohms in re.findall(r"([\d.]+) kΩ", wire.through))
    assert wire.level == pytest.approx(source_volts * shunt / (series + shunt), abs=0.01)


def test_the_page_refuses_a_wiring_that_damages_a_part(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hardware, "find_wiring_faults", lambda: ["8.4 V at the H-bridge"])
    with pytest.raises(ValueError, match=r"8\.4 V at the H-bridge"):
        hardware.wiring_page()


def test_the_straps_give_the_addresses_of_the_data_sheets() -> None:
    assert [bridge_address(one.a1, one.a0) for one in FINS] == [one.address for one in FINS]
    assert bridge_address(Strap.HIGH, Strap.HIGH) == 0x68
    assert imu_address(IMU_STRAP) == IMU_ADDRESS


def test_every_pin_of_the_board_is_said_to_be_something_and_only_once() -> None:
    ends = [
        pin
        for wire in WIRES
        if wire.net is not Net.I2C
        for part, pin in ((wire.source, wire.source_pin), (wire.sink, wire.sink_pin))
        if part == "board" and pin in BOARD_PINS
    ]
    bus = {wire.source_pin for wire in WIRES if wire.net is Net.I2C and wire.source == "board"}
    assert bus == {"A4", "A5"}
    assert len(ends) == len(set(ends))
    assert sorted([*ends, *bus, *SPARE_OUTPUTS, *SPARE_PINS]) == sorted(BOARD_PINS)


def test_every_part_with_a_supply_gets_it_and_a_ground() -> None:
    for part in PARTS:
        if part.supply:
            nets = {wire.net for wire in WIRES if wire.sink == part.name}
            assert {Net.SUPPLY, Net.GROUND} <= nets, part.name


def test_the_reset_line_is_that_of_the_configuration() -> None:
    assert LinkConfig().reset.endswith(f":{RESET_LINE}")
    (wire,) = [one for one in WIRES if one.source == "pi" and one.sink_pin == "LV3"]
    assert HEADER[wire.source_pin] == f"GPIO {RESET_LINE}"


def test_the_pi_s_pins_are_those_of_its_header() -> None:
    sources = {wire.source_pin for wire in WIRES if wire.source == "pi"}
    assert sources | {wire.sink_pin for wire in WIRES if wire.sink == "pi"} == set(HEADER)


def test_the_drawing_shows_every_wire(monkeypatch: pytest.MonkeyPatch) -> None:
    another = replace(WIRES[-1], sink="led", sink_pin="anode")
    monkeypatch.setattr(wiring_drawing, "WIRES", (*WIRES, another))
    with pytest.raises(ValueError, match="bridge OUT1, OUT2 - led"):
        wiring_picture()


def test_the_drawing_has_no_wire_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wiring_drawing, "WIRES", [one for one in WIRES if one.sink_pin != "A2"])
    with pytest.raises(KeyError, match="battery, \\+, board, A2"):
        wiring_picture()
