"""The robot's wiring: parts, supplies and every wire.

The pages of docs/run/hardware are written from these tables. Tests compare their pins and addresses with the
drawing, docs/pictures/wiring.svg, and with those that the firmware uses on the emulated chip. Voltages are in
V, and limits are those of the data sheets, for a supply of 5 V.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum


class Net(StrEnum):
    """A group of wires with one purpose; it has a colour of its own in the drawing."""

    SUPPLY = "supply"
    GROUND = "ground"
    UART = "UART"
    I2C = "I2C"
    SPI = "SPI"
    SIGNAL = "signal"


class Strap(StrEnum):
    """The level of an address input, which the chip reads at power-on."""

    LOW = "ground"
    OPEN = "open"
    HIGH = "supply"


@dataclass(frozen=True)
class Input:
    """Limits of the pins whose names begin with `prefix`: high from this voltage, and the highest allowed."""

    prefix: str
    high_from: float
    maximum: float


@dataclass(frozen=True)
class Part:
    """A part of the robot; `supply` is the range that works, `supply_maximum` what it survives.

    `inputs` are the limits of its pins, of which the first with a fitting prefix counts.
    """

    name: str
    title: str
    count: int
    supply: tuple[float, float] | None
    supply_maximum: float | None
    choice: str
    inputs: tuple[Input, ...] = ()

    def find_input(self, pin: str) -> Input | None:
        """Return the limits of a pin; None where it is no logic input."""
        return next((limits for limits in self.inputs if pin.startswith(limits.prefix)), None)


@dataclass(frozen=True)
class Conductor:
    """A wire from the end that drives it to the end that reads it; on I2C both ends do both.

    `level` is the highest voltage at the far end, behind the resistors of `through`.
    """

    net: Net
    source: str
    source_pin: str
    sink: str
    sink_pin: str
    level: float
    through: str = ""
    pull: str = ""
    note: str = ""


@dataclass(frozen=True)
class FinWiring:
    """Pins and address straps of one fin's encoder and H-bridge."""

    position: str
    select: str
    address: int
    a1: Strap
    a0: Strap


BATTERY_MAX = 8.4
"""V of a full pack of two lithium cells."""
BATTERY_MIN = 6.0

FINS = (
    FinWiring("front right", "D7", 0x64, Strap.OPEN, Strap.OPEN),
    FinWiring("back right", "D8", 0x60, Strap.LOW, Strap.LOW),
    FinWiring("back left", "D9", 0x61, Strap.LOW, Strap.OPEN),
    FinWiring("front left", "D10", 0x63, Strap.OPEN, Strap.LOW),
)
IMU_ADDRESS = 0x69
IMU_STRAP = Strap.HIGH
PRESSURE_ADDRESS = 0x76
RESET_LINE = 4
"""The Pi's GPIO that pulls the board's reset pin."""

PARTS = (
    Part("battery", "battery", 1, None, None,
         "Two lithium cells in series (2S) with protection, 6.0 to 8.4 V; a fuse of 5 A and a switch at +"),
    Part("regulator", "5 V regulator", 1, (BATTERY_MIN, BATTERY_MAX), None,
         "Step-down, 5.0 V from 6.0 to 8.4 V, 3 A: supplies Pi, board and encoders"),
    Part("motor_regulator", "motor regulator", 1, (BATTERY_MIN, BATTERY_MAX), None,
         "Step-down, 5.0 V, for the stall current of four motors (up to 4 A), with an enable input that is "
         "on at 5 V and off when it is open",
         (Input("EN", 2.0, 5.5),)),
    Part("pi", "Raspberry Pi", 1, (4.75, 5.25), None,
         "Zero 2 W or any 64-bit Pi with Raspberry Pi OS 12 or 13, or Zero W with 13; camera at CSI",
         (Input("", 2.0, 3.6),)),
    Part("board", "board", 1, (4.5, 5.5), 6.0,
         "ATmega328P, 5 V, 16 MHz: Arduino Pro Mini, or the thesis's Mini 05",
         (Input("RST", 4.5, 5.5), Input("A4", 3.5, 5.5), Input("A5", 3.5, 5.5), Input("", 3.0, 5.5))),
    Part("shifter", "level shifter", 1, (3.3, 5.5), None,
         "Four bidirectional channels with a BSS138 transistor each, 10 kΩ to LV and to HV in each channel",
         (Input("LV", 2.3, 3.6), Input("HV", 3.5, 5.5))),
    Part("imu", "IMU", 1, (2.375, 3.46), 6.0,
         "MPU-6050 on a board with AD0 led out, such as a GY-521",
         (Input("", 2.3, 3.8),)),
    Part("pressure", "pressure sensor", 1, (1.5, 3.6), 4.0,
         "MS5837-30BA, on a board with its capacitor of 100 nF, sealed against water",
         (Input("", 2.64, 3.6),)),
    Part("encoder", "encoder", 4, (4.5, 5.5), 7.0,
         "AS5040 with its magnet on the fin's shaft; VDD5V and VDD3V3 with the data sheet's capacitors",
         (Input("", 3.5, 5.3),)),
    Part("bridge", "H-bridge", 4, (2.75, 6.8), 7.0,
         "DRV8830 with A0 and A1 led out, and a resistor of 0.2 Ω at ISENSE: 1 A at most",
         (Input("", 2.5, 7.0),)),
    Part("motor", "motor", 4, None, None,
         "DC gear motor for 3 V that takes less than 1 A stalled; a stroke needs up to 6.5 rad/s at the fin"),
    Part("led", "LED", 1, None, None, "Any colour that shows through the hull", (Input("", 0.0, 5.5),)),
    Part("detector", "tone detector", 2, (4.75, 5.5), None,
         "Optional: light sensor with tone detector, whose output is high while it detects its tone"),
    Part("leak_sensor", "leak sensor", 1, None, None,
         "Optional: two wires whose last 5 mm are bare, 3 mm apart, at the lowest place in the hull"),
)  # fmt: skip

_DIVIDER = "1.8 kΩ in series, 3.3 kΩ to ground"
_HALF = "10 kΩ in series, 10 kΩ and 100 nF to ground"
_BUS_PULL = "4.7 kΩ to +5 V"
_CHIP_PULL = "pull-up in the chip"
_OFF_PULL = "10 kΩ to ground"
_ABSENT_PULL = "10 kΩ to ground where none is fitted"

WIRES = (
    Conductor(Net.SUPPLY, "battery", "+", "regulator", "VIN", BATTERY_MAX, "fuse, switch"),
    Conductor(Net.SUPPLY, "battery", "+", "motor_regulator", "VIN", BATTERY_MAX, "fuse, switch"),
    Conductor(Net.SUPPLY, "regulator", "VOUT", "pi", "2", 5.0, note="no fuse behind this pin: measure first"),
    Conductor(Net.SUPPLY, "regulator", "VOUT", "board", "VCC", 5.0, note="RAW stays open"),
    Conductor(Net.SUPPLY, "regulator", "VOUT", "encoder", "VDD5V", 5.0),
    Conductor(Net.SUPPLY, "regulator", "VOUT", "shifter", "HV", 5.0),
    Conductor(Net.SUPPLY, "regulator", "VOUT", "detector", "VCC", 5.0),
    Conductor(Net.SUPPLY, "motor_regulator", "VOUT", "bridge", "VCC", 5.0, note="never the battery"),
    Conductor(Net.SUPPLY, "pi", "1", "shifter", "LV", 3.3),
    Conductor(Net.SUPPLY, "pi", "1", "imu", "VCC", 3.3),
    Conductor(Net.SUPPLY, "pi", "1", "imu", "AD0", 3.3, note=f"strap: address 0x{IMU_ADDRESS:02x}"),
    Conductor(Net.SUPPLY, "pi", "1", "pressure", "VDD", 3.3),
    Conductor(Net.GROUND, "battery", "-", "regulator", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "motor_regulator", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "pi", "6", 0),
    Conductor(Net.GROUND, "battery", "-", "board", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "shifter", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "imu", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "pressure", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "encoder", "VSS", 0, note="and its pin PROG"),
    Conductor(Net.GROUND, "battery", "-", "bridge", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "led", "cathode", 0),
    Conductor(Net.GROUND, "battery", "-", "detector", "GND", 0),
    Conductor(Net.GROUND, "battery", "-", "leak_sensor", "GND", 0),
    Conductor(Net.UART, "pi", "8", "board", "D0", 3.3, note="TXD, GPIO 14; high enough for the board"),
    Conductor(Net.UART, "board", "D1", "pi", "10", 3.24, _DIVIDER, note="RXD, GPIO 15; 5 V would damage it"),
    Conductor(Net.SIGNAL, "pi", "7", "shifter", "LV3", 3.3, note=f"GPIO {RESET_LINE}: `reset` in robot.toml"),
    Conductor(Net.SIGNAL, "shifter", "HV3", "board", "RST", 5.0, pull="10 kΩ to +5 V, on the board",
         note="low resets"),
    Conductor(Net.I2C, "board", "A4", "shifter", "HV1", 5.0, pull=_BUS_PULL, note="SDA"),
    Conductor(Net.I2C, "board", "A5", "shifter", "HV2", 5.0, pull=_BUS_PULL, note="SCL"),
    Conductor(Net.I2C, "board", "A4", "bridge", "SDA", 5.0, note="the same pull-up"),
    Conductor(Net.I2C, "board", "A5", "bridge", "SCL", 5.0, note="the same pull-up"),
    Conductor(Net.I2C, "shifter", "LV1", "imu", "SDA", 3.3, pull="pull-up on the IMU's board"),
    Conductor(Net.I2C, "shifter", "LV2", "imu", "SCL", 3.3, pull="pull-up on the IMU's board"),
    Conductor(Net.I2C, "shifter", "LV1", "pressure", "SDA", 3.3, note="the same pull-up"),
    Conductor(Net.I2C, "shifter", "LV2", "pressure", "SCL", 3.3, note="the same pull-up"),
    Conductor(Net.SPI, "board", "D13", "encoder", "CLK", 5.0, note="to all four"),
    Conductor(Net.SPI, "encoder", "DO", "board", "D12", 5.0, pull=_CHIP_PULL, note="from all four"),
    *(Conductor(Net.SPI, "board", fin.select, "encoder", "CSn", 5.0, note=f"fin {number}, low selects")
      for number, fin in enumerate(FINS)),
    Conductor(Net.SIGNAL, "board", "A1", "led", "anode", 5.0, "330 Ω"),
    Conductor(Net.SIGNAL, "battery", "+", "board", "A2", BATTERY_MAX / 2, _HALF, note="behind the switch"),
    Conductor(Net.SIGNAL, "board", "A3", "motor_regulator", "EN", 5.0, pull=_OFF_PULL, note="high is on"),
    Conductor(Net.SIGNAL, "detector", "right", "board", "D4", 5.0, pull=_ABSENT_PULL),
    Conductor(Net.SIGNAL, "detector", "left", "board", "D5", 5.0, pull=_ABSENT_PULL),
    Conductor(Net.SIGNAL, "leak_sensor", "wire", "board", "D2", 5.0, pull=_CHIP_PULL,
             note="water pulls it low"),
    Conductor(Net.SIGNAL, "bridge", "OUT1, OUT2", "motor", "leads", 3.21, note="100 nF between the leads"),
)  # fmt: skip

SPARE_OUTPUTS = {"D11": "MOSI: the encoders have no data input"}
"""Pins that the firmware drives and that stay open."""
SPARE_PINS = ("D3", "D6", "A0")
"""Pins that the firmware does not use; they stay open."""


def find_part(name: str) -> Part:
    """Return the part of this name. Raise KeyError where there is none."""
    parts = {part.name: part for part in PARTS}
    return parts[name]


def bridge_address(a1: Strap, a0: Strap) -> int:
    """Return a DRV8830's I2C address (7 bits), by the data sheet's table of its two inputs."""
    order = list(Strap)
    return 0x60 + 3 * order.index(a1) + order.index(a0)


def imu_address(ad0: Strap) -> int:
    """Return an MPU-6050's I2C address (7 bits)."""
    return 0x68 + (ad0 is Strap.HIGH)


def find_wiring_faults(wires: Iterable[Conductor] = WIRES) -> Iterator[str]:
    """Yield a line for each wire that damages the part at its end, or has a level which it does not read."""
    for wire in wires:
        ends = [(wire.sink, wire.sink_pin)]
        if wire.net is Net.I2C:
            ends.append((wire.source, wire.source_pin))
        for name, pin in ends:
            part = find_part(name)
            end = f"{wire.level:g} V at {part.title} {pin}"
            if wire.net is Net.SUPPLY and pin != "AD0":
                if part.supply is None or not part.supply[0] <= wire.level <= part.supply[1]:
                    yield f"{end}: outside its supply range"
            elif wire.net is not Net.GROUND and (limits := part.find_input(pin)):
                if wire.level > limits.maximum:
                    yield f"{end}: it bears {limits.maximum:g} V"
                if wire.level < limits.high_from:
                    yield f"{end}: it reads high from {limits.high_from:g} V on"
