"""The wiring's table: no wire damages a part, and nothing is forgotten."""

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from robot_runtime.config import LinkConfig
from robot_runtime.contract.wiring import (
    BATTERY_MAX,
    FINS,
    IMU_ADDRESS,
    IMU_STRAP,
    PARTS,
    PRESSURE_ADDRESS,
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
from robot_runtime.generate import hardware

DRAWING = Path(__file__).parents[2] / "docs/pictures/wiring.svg"
SVG = "{http://www.w3.org/2000/svg}"
BOX = "#f5f8f9"
FIN_SELECTS = {fin.select for fin in FINS}
UNNAMED = {"VOUT", "VIN", "anode", "leads", *FIN_SELECTS}
"""Pins that the drawing shows without their names: a part of one wire, a supply, and D7 to D10 as one."""
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
    (wire,) = [wire for wire in WIRES if (wire.sink, wire.sink_pin) == (sink, pin)]
    assert fault in list(find_wiring_faults([replace(wire, level=level)]))


def test_a_bus_is_checked_at_both_ends() -> None:
    (wire,) = [wire for wire in WIRES if (wire.source_pin, wire.sink_pin) == ("A4", "HV1")]
    faults = list(find_wiring_faults([replace(wire, level=3.3)]))
    assert "3.3 V at board A4: it reads high from 3.5 V on" in faults


@pytest.mark.parametrize(("sink", "pin", "source_volts"), [("pi", "10", 5.0), ("board", "A2", BATTERY_MAX)])
def test_the_resistors_of_a_divider_give_its_level(sink: str, pin: str, source_volts: float) -> None:
    (wire,) = [wire for wire in WIRES if (wire.sink, wire.sink_pin) == (sink, pin)]
    series, shunt = (float(ohms) for ohms in re.findall(r"([\d.]+) kΩ", wire.through))
    assert wire.level == pytest.approx(source_volts * shunt / (series + shunt), abs=0.01)


def test_the_page_refuses_a_wiring_that_damages_a_part(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hardware, "find_wiring_faults", lambda: ["8.4 V at the H-bridge"])
    with pytest.raises(ValueError, match=r"8\.4 V at the H-bridge"):
        hardware.wiring_page()


def test_the_straps_give_the_addresses_of_the_data_sheets() -> None:
    assert [bridge_address(fin.a1, fin.a0) for fin in FINS] == [fin.address for fin in FINS]
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
    (wire,) = [wire for wire in WIRES if wire.source == "pi" and wire.sink_pin == "LV3"]
    assert HEADER[wire.source_pin] == f"GPIO {RESET_LINE}"


def test_the_pi_s_pins_are_those_of_its_header() -> None:
    sources = {wire.source_pin for wire in WIRES if wire.source == "pi"}
    assert sources | {wire.sink_pin for wire in WIRES if wire.sink == "pi"} == set(HEADER)


def test_the_drawing_shows_each_part_with_all_its_pins_and_no_others() -> None:
    drawn = read_drawing()
    assert set(drawn) == {part.title for part in PARTS}
    for part in PARTS:
        pins = {wire.sink_pin for wire in WIRES if wire.sink == part.name}
        pins |= {wire.source_pin for wire in WIRES if wire.source == part.name}
        assert {pin for pin in pins if not is_drawn(pin, drawn[part.title])} <= UNNAMED, part.title
        known = {wire.sink_pin for wire in WIRES} | {wire.source_pin for wire in WIRES}
        others = known - pins - FIN_SELECTS - {"1", "2", "6", "+", "-"}
        assert not [pin for pin in others if is_drawn(pin, drawn[part.title])], part.title


def test_the_drawing_has_the_addresses_and_straps_of_the_table() -> None:
    rows = [text.text or "" for text in ElementTree.parse(DRAWING).iter(f"{SVG}text")]
    for number, fin in enumerate(FINS):
        row = [str(number), fin.position, fin.select, f"0x{fin.address:02x}", fin.a1.value, fin.a0.value]
        start = rows.index(fin.position) - 1
        assert rows[start : start + len(row)] == row
    drawn = read_drawing()
    bus = [wire for wire in WIRES if wire.net is Net.I2C and (wire.source, wire.sink) == ("board", "shifter")]
    assert {f"{wire.source_pin} {wire.note}" for wire in bus} <= set(drawn["board"])
    assert f"0x{IMU_ADDRESS:02x}" in drawn["IMU"]
    assert f"0x{PRESSURE_ADDRESS:02x}" in drawn["pressure sensor"]
    assert f"{', '.join(['RAW', *SPARE_OUTPUTS])}: open" in drawn["board"]


def read_drawing() -> dict[str, list[str]]:
    """Return the texts in each part's box, by the part's title."""
    tree = ElementTree.parse(DRAWING)
    titles = {part.title for part in PARTS}
    parts = {}
    for box in tree.iter(f"{SVG}rect"):
        left, top, width, height = (float(box.get(name, 0)) for name in ("x", "y", "width", "height"))
        texts = [
            text.text or ""
            for text in tree.iter(f"{SVG}text")
            if left <= float(text.get("x", -1)) <= left + width
            and top <= float(text.get("y", -1)) <= top + height
        ]
        title = next((text for text in texts if text in titles), None)
        if title and box.get("fill") == BOX:
            parts[title] = texts
    return parts


def is_drawn(pin: str, texts: list[str]) -> bool:
    """Return whether one of the texts names this pin, such as "A4 SDA" or "VCC: +5 V" does."""
    return any(text == pin or re.match(rf"{re.escape(pin)}(:| (?!V))", text) for text in texts)
