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
from robot_runtime.generate.markdown import fill, page, table

SOURCE = "robot_runtime/contract/wiring.py"
BOARD_PINS = (*(f"D{number}" for number in range(14)), *(f"A{number}" for number in range(6)))
"""The pins of the board that have a row of their own."""


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
        fill("parts", shopping=shopping, supplies=supplies, inputs=inputs, battery=BATTERY_MAX),
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
    supply = [wire for wire in WIRES if wire.net is Net.SUPPLY]
    others = [
        wire
        for wire in WIRES
        if wire.net not in (Net.SUPPLY, Net.GROUND) and not any(_is_at(wire, pin) for pin in BOARD_PINS)
    ]
    columns = ("from", "to", "level", "remark")
    ground = ", ".join(
        f"{find_part(wire.sink).title} {wire.sink_pin}" + (f" ({wire.note})" if wire.note else "")
        for wire in WIRES
        if wire.net is Net.GROUND
    )
    text = fill(
        "wiring",
        supply=table(columns, map(_wire_row, supply)),
        others=table(columns, map(_wire_row, others)),
        ground=ground,
        fins=fins,
        pins=table(("pin", "of the chip", "direction", "joined to", "note"), _pin_rows()),
        imu=IMU_ADDRESS,
        pressure=PRESSURE_ADDRESS,
    )
    return page("Wiring", SOURCE, text)


def chip_pin(pin: str) -> str:
    """Return the ATmega328P's name, such as PD7, of an Arduino's pin, such as D7."""
    kind, number = pin[0], int(pin[1:])
    if kind == "A":
        return f"PC{number}"
    return f"PD{number}" if number < 8 else f"PB{number - 8}"


def _pin_rows() -> Iterator[tuple[str, ...]]:
    for pin in BOARD_PINS:
        wires = [wire for wire in WIRES if _is_at(wire, pin)]
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


def _is_at(wire: Conductor, pin: str) -> bool:
    return ("board", pin) in ((wire.source, wire.source_pin), (wire.sink, wire.sink_pin))


def _direction(wire: Conductor) -> str:
    if wire.net is Net.I2C:
        return "open drain"
    return "output" if wire.source == "board" else "input"


def _far_end(wire: Conductor) -> str:
    name, pin = (wire.sink, wire.sink_pin) if wire.source == "board" else (wire.source, wire.source_pin)
    return f"{find_part(name).title} {pin}"


def _notes(wires: list[Conductor]) -> str:
    texts = (text for wire in wires for text in (wire.through, wire.pull, wire.note))
    return "; ".join(dict.fromkeys(text for text in texts if text))


def _wire_row(wire: Conductor) -> tuple[str, ...]:
    return (
        f"{find_part(wire.source).title} {wire.source_pin}",
        f"{find_part(wire.sink).title} {wire.sink_pin}",
        _volts(wire.level),
        "; ".join(text for text in (wire.through, wire.pull, wire.note) if text),
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
