"""The pages of docs/run/hardware that are tables of the robot's wiring."""

from collections.abc import Iterator

from robot_runtime.contract.wiring import (
    BATTERY_MAX,
    FINS,
    IMU_ADDRESS,
    PARTS,
    PRESSURE_ADDRESS,
    SPARE_OUTPUTS,
    SPARE_PINS,
    WIRES,
    Conductor,
    Net,
    Part,
    find_part,
    find_wiring_faults,
)
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/contract/wiring.py"

PARTS_INTRODUCTION = """\
One robot. Limits are those of the data sheets, in V; pins that are not named bear no more than their part's
supply. **No robot was built from this list yet** ([why](index.md)). What carries it all: [Hull](hull.md).

## What to buy
"""
SUPPLY_INTRODUCTION = f"""
Besides: a fuse of 5 A, a switch, resistors (330 Ω, 1.8 kΩ, 3.3 kΩ, 2 of 4.7 kΩ, 5 of 10 kΩ), a capacitor of
100 nF for each motor and for A2, one of 100 µF or more at the output of each regulator, an ISP programmer
([Fuses](fuses.md)), a multimeter, a bench supply with a current limit.

## What dies from {BATTERY_MAX:g} V

A full pack of two cells has {BATTERY_MAX:g} V. It belongs at the two regulators and, halved, at A2: nowhere
else.
"""
INPUTS_INTRODUCTION = """
## Levels

A pin reads high from the second column on, and bears the third. The wiring is checked against this table when
it is generated: a wire that damages its part, or whose level the part does not read, is refused.
"""
MOTORS = """
The motors get at most 3.2 V, whatever their supply: the firmware sends no drive above 40 of the DRV8830's 63
steps of 0.08 V. So 5 V is enough for the H-bridges, and keeps them far from their 6.8 V.
"""

WIRING_INTRODUCTION = """\
Switch everything off before you change a wire. Colours of wires are free; keep to those of the drawing.
**No robot was wired by this plan yet** ([why](index.md)).

[![The wiring; the tables below say the same](../../pictures/wiring.svg)](../../pictures/wiring.svg)

Press the drawing to see it alone. A name in a coloured field is a supply: all fields of one name
are joined. GND of all parts meets at the battery's minus; the H-bridges' ground has a wire of its own to that
point.

## Fins
"""
FINS_NOTE = """
*Open* means that nothing is joined to the pin, not even a resistor of its board; *ground* is GND of that
board. The four encoders share CLK and DO, the four H-bridges SDA and SCL.
"""
PINS_INTRODUCTION = """
## Pins of the board

From a reset until the firmware starts, and during an upload, all of them are inputs: so A3 needs its resistor
to ground.
"""
WIRES_INTRODUCTION = """
## Wires

*Level* is the highest voltage at the far end.
"""
NET_TITLES = {
    Net.SUPPLY: "Supply",
    Net.GROUND: "Ground",
    Net.UART: "Serial line",
    Net.I2C: "I2C",
    Net.SPI: "SPI",
    Net.SIGNAL: "Signals",
}
NET_NOTES = {
    Net.UART: """
The board reads high from 3.0 V on (0.6 of its supply), so the Pi's 3.3 V need no shifter. The board sends 5
V; that damages the Pi, and the two resistors make 3.24 V of it.
""",
    Net.I2C: """
The board takes an I2C line for high from 3.5 V on (0.7 of its supply), which 3.3 V never reach: hence the
level shifter. The boards of the H-bridges must have **no pull-up of their own to the motors' supply**: it is
off while the robot is disarmed, and such a resistor then pulls the whole bus down.
""",
    Net.SPI: """
D12 has a pull-up in the chip, so that a missing encoder reads as ones, which the firmware refuses.
""",
    Net.SIGNAL: """
Detectors may be high or low at their tone: the [bring-up](../bring-up.md) finds which, and the board keeps
it. An LM567 is open collector, and low at its tone (data sheet): it needs 10 kΩ from +5 V to its output.

The enable input of the motor regulator must be off when it is open. Many regulator boards pull it up to their
input: **that puts 8.4 V on A3**. Take that resistor off, or choose another board.
""",
}


def parts_page() -> str:
    """Return the whole text of docs/run/hardware/parts.md."""
    shopping = table(
        ("part", "how many", "what"), ((part.title, str(part.count), part.choice) for part in PARTS)
    )
    supplies = table(
        ("part", "works from", "to", "at most", f"at {BATTERY_MAX:g} V"),
        (row for part in PARTS for row in _supply_row(part)),
    )
    inputs = table(
        ("part", "pins", "high from", "at most"),
        (
            (
                part.title,
                limits.prefix or ("others" if len(part.inputs) > 1 else "all"),
                _volts(limits.high_from),
                _volts(limits.maximum),
            )
            for part in PARTS
            for limits in part.inputs
            if limits.high_from
        ),
    )
    return page(
        "Parts",
        SOURCE,
        PARTS_INTRODUCTION,
        shopping + MOTORS + SUPPLY_INTRODUCTION,
        supplies + INPUTS_INTRODUCTION,
        inputs,
    )


def wiring_page() -> str:
    """Return the whole text of docs/run/hardware/wiring.md.

    Raise ValueError where a wire would damage a part.
    """
    faults = list(find_wiring_faults())
    if faults:
        raise ValueError("the wiring is wrong: " + "; ".join(faults))
    fins = table(
        ("fin", "place", "CSn of its encoder", "address of its H-bridge", "A1", "A0"),
        (
            (str(number), fin.position, fin.select, f"0x{fin.address:02x}", fin.a1.value, fin.a0.value)
            for number, fin in enumerate(FINS)
        ),
    )
    sensors = (
        f"\nOn the same bus: the IMU at 0x{IMU_ADDRESS:02x} (AD0 high) and the pressure sensor at "
        f"0x{PRESSURE_ADDRESS:02x}.\n"
    )
    parts = [WIRING_INTRODUCTION, fins + FINS_NOTE + sensors + PINS_INTRODUCTION]
    parts += [
        table(("pin", "of the chip", "direction", "joined to", "note"), _pin_rows()) + WIRES_INTRODUCTION
    ]
    for net, title in NET_TITLES.items():
        rows = (_wire_row(wire) for wire in WIRES if wire.net is net)
        head = ("from", "to", "level", "through", "pulled by", "note")
        parts.append(f"### {title}\n\n" + table(head, rows) + NET_NOTES.get(net, ""))
    return page("Wiring", SOURCE, *parts)


def chip_pin(pin: str) -> str:
    """Return the ATmega328P's name, such as PD7, of an Arduino's pin, such as D7."""
    kind, number = pin[0], int(pin[1:])
    if kind == "A":
        return f"PC{number}"
    return f"PD{number}" if number < 8 else f"PB{number - 8}"


def _pin_rows() -> Iterator[tuple[str, ...]]:
    pins = [f"D{number}" for number in range(14)] + [f"A{number}" for number in range(6)]
    for pin in pins:
        wires = [
            wire
            for wire in WIRES
            if ("board", pin) in ((wire.source, wire.source_pin), (wire.sink, wire.sink_pin))
        ]
        if pin in SPARE_OUTPUTS:
            yield pin, chip_pin(pin), "output", "nothing", SPARE_OUTPUTS[pin]
        elif pin in SPARE_PINS:
            yield pin, chip_pin(pin), "input", "nothing", ""
        else:
            yield (
                pin,
                chip_pin(pin),
                _direction(wires[0]),
                ", ".join(_far_end(wire) for wire in wires),
                _notes(wires),
            )


def _direction(wire: Conductor) -> str:
    if wire.net is Net.I2C:
        return "open drain"
    return "output" if wire.source == "board" else "input"


def _far_end(wire: Conductor) -> str:
    name, pin = (wire.sink, wire.sink_pin) if wire.source == "board" else (wire.source, wire.source_pin)
    return f"{find_part(name).title} {pin}"


def _notes(wires: list[Conductor]) -> str:
    return "; ".join(dict.fromkeys(text for wire in wires for text in (wire.through, wire.pull) if text))


def _wire_row(wire: Conductor) -> tuple[str, ...]:
    return (
        f"{find_part(wire.source).title} {wire.source_pin}",
        f"{find_part(wire.sink).title} {wire.sink_pin}",
        _volts(wire.level),
        wire.through,
        wire.pull,
        wire.note,
    )


def _supply_row(part: Part) -> Iterator[tuple[str, ...]]:
    if part.supply is None:
        return
    low, high = part.supply
    if high >= BATTERY_MAX:
        verdict = "works"
    elif part.supply_maximum is None:
        verdict = "**assume that it dies**"
    else:
        verdict = "**dies**"
    highest = _volts(part.supply_maximum) if part.supply_maximum else "see its maker"
    yield part.title, _volts(low), _volts(high), highest, verdict


def _volts(level: float) -> str:
    return f"{level:g} V"
