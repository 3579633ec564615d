"""docs/pictures/wiring.svg: the places of the parts, and the ways of the wires."""

from typing import NamedTuple

from robot_runtime.contract.wiring import (
    BATTERY_MAX,
    BATTERY_MIN,
    FINS,
    IMU_ADDRESS,
    PRESSURE_ADDRESS,
    SPARE_OUTPUTS,
    Net,
)
from robot_runtime.generate.wiring_drawing import (
    COLOURS,
    FILL,
    LINE,
    PAPER,
    RAILS,
    SOFT,
    Drawing,
    strap_rows,
)

WIDTH, HEIGHT = 624, 1064
LABEL = (
    "Battery and regulator at the top, Raspberry Pi and sensors on the left, level shifter and board in the "
    "middle, LED, tone detectors and motor regulator on the right, one of the four fins at the bottom, with "
    "a table of the pins and straps of each. The tables of the page say the same in words."
)
PI_RIGHT, SHIFTER_LEFT, SHIFTER_RIGHT, BOARD_LEFT, BOARD_RIGHT, RIGHT = 150, 192, 288, 336, 446, 484


class BusLine(NamedTuple):
    """A line of the bus: its names, and its places at the parts."""

    pin: str
    name: str
    channel: str
    y_board: float
    x_bridge: float
    x_sensors: float
    y_imu: float
    y_pressure: float
    y_bridge: float
    y_pull: float


BUS = (
    BusLine("A4", "SDA", "1", 326, 302, 166, 404, 556, 712, 462),
    BusLine("A5", "SCL", "2", 354, 320, 178, 426, 578, 738, 488),
)


def wiring_picture() -> str:
    """The whole text of wiring.svg."""
    drawing = Drawing(WIDTH, HEIGHT, LABEL)
    _draw_power(drawing)
    _draw_parts(drawing)
    _draw_line(drawing)
    _draw_bus(drawing)
    _draw_signals(drawing)
    _draw_fin(drawing)
    _draw_encoder(drawing)
    _draw_straps(drawing)
    _draw_legend(drawing)
    return drawing.finish()


def _draw_power(drawing: Drawing) -> None:
    drawing.box("battery", 16, 16, 134, 78, f"2S, {BATTERY_MIN:.1f} to {BATTERY_MAX:g} V")
    drawing.pill(24, 68, "-: GND", COLOURS[Net.GROUND])
    drawing.box("regulator", BOARD_LEFT, 16, 148, 78)
    wire = drawing.take("battery", "+", "regulator", "VIN")
    drawing.wire(wire, (PI_RIGHT, 76), (BOARD_LEFT, 76))
    drawing.rectangle(166, 68, 36, 16, PAPER, COLOURS[Net.SUPPLY], 3)
    drawing.line(Net.SUPPLY, (166, 76), (202, 76))
    drawing.text(184, 60, "fuse 5 A", 12, "middle", SOFT)
    drawing.rectangle(222, 66, 30, 20, PAPER, PAPER, 0)
    drawing.line(Net.SUPPLY, (222, 76), (249, 64))
    drawing.dot(Net.SUPPLY, 222, 76)
    drawing.dot(Net.SUPPLY, 252, 76)
    drawing.text(240, 102, "switch", 12, "middle", SOFT)
    drawing.dot(Net.SUPPLY, 292, 76)
    drawing.line(Net.SUPPLY, (292, 76), (292, 50))
    name, colour = RAILS["battery"]
    drawing.pill(261, 32, name, colour)
    drawing.pills("regulator", 412, 44, 60)
    drawing.line(Net.SUPPLY, (484, 76), (504, 76))
    drawing.text(478, 80.5, "VOUT", 13, "end")
    name, colour = RAILS["regulator"]
    drawing.pill(504, 67, name, colour)


def _draw_parts(drawing: Drawing) -> None:
    drawing.box("pi", 16, 116, 134, 230)
    drawing.pills("pi", 24, 294, 126)
    name, colour = RAILS["pi"]
    drawing.pill(24, 318, f"1: {name} out", colour)
    drawing.box("shifter", SHIFTER_LEFT, 216, SHIFTER_RIGHT - SHIFTER_LEFT, 226)
    drawing.pills("shifter", SHIFTER_LEFT + 8, 370, 88)
    drawing.box("board", BOARD_LEFT, 116, BOARD_RIGHT - BOARD_LEFT, 440, "ATmega328P", "5 V, 16 MHz", down=98)
    drawing.pills("board", BOARD_LEFT + 8, 436, 60)
    spare = ", ".join(("RAW", *SPARE_OUTPUTS))
    drawing.text(BOARD_LEFT + 6, 394, f"{spare}: open", 12, colour=SOFT)
    drawing.box("imu", 16, 366, 134, 132)
    drawing.text(24, 409, f"0x{IMU_ADDRESS:02x}", 13, colour=SOFT)
    drawing.pills("imu", 24, 446, 126)
    drawing.box("pressure", 16, 518, 134, 104)
    drawing.text(24, 561, f"0x{PRESSURE_ADDRESS:02x}", 13, colour=SOFT)
    drawing.pills("pressure", 24, 594, 130)
    drawing.box("led", RIGHT, 124, 128, 56)
    drawing.pills("led", RIGHT + 14, 152, 110)
    drawing.box("detector", RIGHT, 196, 128, 102)
    drawing.text(RIGHT + 118, 274, "optional", 12, "end", SOFT)
    drawing.pills("detector", RIGHT + 6, 226, 130)
    drawing.box("motor_regulator", RIGHT, 372, 128, 104)


def _draw_line(drawing: Drawing) -> None:
    wire = drawing.take("pi", "8", "board", "D0")
    drawing.wire(wire, (PI_RIGHT, 156), (BOARD_LEFT, 156), ends=("8 TXD", "D0"))
    drawing.text(238, 150, "3.3 V, direct", 12, "middle", SOFT)
    wire = drawing.take("board", "D1", "pi", "10")
    drawing.wire(wire, (BOARD_LEFT, 184), (PI_RIGHT, 184), ends=("D1", "10 RXD"))
    drawing.resistor(270, 184, upright=False)
    drawing.text(270, 174, "1.8 kΩ", 12, "middle", SOFT)
    _draw_shunt(drawing, Net.UART, 180, 184)
    drawing.text(190, 207, "3.3 kΩ", 12, colour=SOFT)
    wire = drawing.take("pi", "7", "shifter", "LV3")
    drawing.wire(wire, (PI_RIGHT, 270), (SHIFTER_LEFT, 270), ends=("7 GPIO4", "LV3"))
    drawing.wire(drawing.take("shifter", "HV3", "board", "RST"), (SHIFTER_RIGHT, 270), (BOARD_LEFT, 270))


def _draw_shunt(drawing: Drawing, net: Net, x: float, y: float) -> None:
    drawing.dot(net, x, y)
    drawing.line(net, (x, y), (x, y + 24))
    drawing.resistor(x, y + 13, upright=True)
    drawing.ground(x, y + 25)


def _draw_bus(drawing: Drawing) -> None:
    for one in BUS:
        high, low = f"HV{one.channel}", f"LV{one.channel}"
        wire = drawing.take("board", one.pin, "shifter", high)
        ends = (f"{one.pin} {one.name}", high)
        drawing.wire(wire, (BOARD_LEFT, one.y_board), (SHIFTER_RIGHT, one.y_board), ends=ends)
        drawing.dot(Net.I2C, one.x_bridge, one.y_board)
        drawing.dot(Net.I2C, one.x_bridge, one.y_pull)
        drawing.line(Net.I2C, (one.x_bridge, one.y_pull), (248, one.y_pull))
        drawing.resistor(270, one.y_pull, upright=False)
        drawing.text(SHIFTER_LEFT + 6, one.y_board + 4.5, low)
        for sensor, y in (("imu", one.y_imu), ("pressure", one.y_pressure)):
            wire = drawing.take("shifter", low, sensor, one.name)
            way = (
                (SHIFTER_LEFT, one.y_board),
                (one.x_sensors, one.y_board),
                (one.x_sensors, y),
                (PI_RIGHT, y),
            )
            drawing.wire(wire, *way, ends=("", one.name))
        drawing.dot(Net.I2C, one.x_sensors, one.y_imu)
    drawing.line(Net.I2C, (248, BUS[0].y_pull), (248, BUS[1].y_pull))
    name, colour = RAILS["regulator"]
    drawing.line(Net.I2C, (238, 475), (248, 475))
    drawing.pill(203, 466, name, colour)
    drawing.text(258, 510, "4.7 kΩ each", 12, "middle", SOFT)


def _draw_signals(drawing: Drawing) -> None:
    drawing.wire(
        drawing.take("board", "A1", "led", "anode"), (BOARD_RIGHT, 142), (RIGHT, 142), ends=("A1", "")
    )
    drawing.resistor(465, 142, upright=False)
    drawing.text(465, 132, "330 Ω", 12, "middle", SOFT)
    for side, pin, y in (("right", "D4", 262), ("left", "D5", 284)):
        drawing.wire(drawing.take("detector", side, "board", pin), (RIGHT, y), (BOARD_RIGHT, y))
    name, colour = RAILS["battery"]
    wire = drawing.take("battery", "+", "board", "A2")
    drawing.wire(wire, (540, 330), (BOARD_RIGHT, 330), ends=("", "A2"))
    drawing.pill(534, 321, name, colour)
    drawing.resistor(504, 330, upright=False)
    drawing.text(504, 320, "10 kΩ", 12, "middle", SOFT)
    _draw_shunt(drawing, Net.SIGNAL, 462, 330)
    drawing.text(472, 354, "10 kΩ, 100 nF", 12, colour=SOFT)
    drawing.wire(drawing.take("board", "A3", "motor_regulator", "EN"), (BOARD_RIGHT, 410), (RIGHT, 410))
    _draw_shunt(drawing, Net.SIGNAL, 465, 410)
    drawing.text(465, 459, "10 kΩ", 12, "middle", SOFT)
    drawing.pills("motor_regulator", RIGHT + 8, 424, 120)
    name, colour = RAILS["motor_regulator"]
    drawing.pill(RIGHT + 8, 448, f"{name} out", colour)


def _draw_fin(drawing: Drawing) -> None:
    for behind in (12, 8, 4, 0):
        drawing.rectangle(16 + behind, 652 - behind, 580, 212, PAPER, LINE)
    drawing.text(30, 674, "one of four fins", 13.5, bold=True)
    drawing.box("bridge", 32, 688, 196, 160, "DRV8830")
    for one in BUS:
        wire = drawing.take("board", one.pin, "bridge", one.name)
        way = ((one.x_bridge, one.y_board), (one.x_bridge, one.y_bridge), (228, one.y_bridge))
        drawing.wire(wire, *way)
    drawing.text(42, 762, "A1, A0: see the table", 12, colour=SOFT)
    drawing.pills("bridge", 42, 774, 180)
    drawing.box("motor", 268, 806, 84, 34)
    wire = drawing.take("bridge", "OUT1, OUT2", "motor", "leads")
    drawing.wire(wire, (228, 823), (268, 823), ends=("OUT1, OUT2", ""))


def _draw_encoder(drawing: Drawing) -> None:
    drawing.box("encoder", 396, 688, 186, 160, "AS5040", down=48)
    drawing.pills("encoder", 410, 766, 160)
    drawing.rectangle(352, 820, 44, 6, FILL, LINE, 0)
    drawing.text(374, 814, "shaft", 12, "middle", SOFT)
    clock = drawing.take("board", "D13", "encoder", "CLK")
    drawing.wire(clock, (BOARD_RIGHT, 492), (552, 492), (552, 688))
    data = drawing.take("encoder", "DO", "board", "D12")
    drawing.wire(data, (508, 688), (508, 516), (BOARD_RIGHT, 516))
    for fin in FINS:
        select = drawing.take("board", fin.select, "encoder", "CSn")
    pins = f"{FINS[0].select} to {FINS[-1].select}"
    drawing.wire(select, (BOARD_RIGHT, 540), (464, 540), (464, 688), ends=(pins, "CSn"))


def _draw_straps(drawing: Drawing) -> None:
    columns = (30, 72, 190, 316, 420, 510)
    heads = ("fin", "place", "select (CSn)", "H-bridge", "its A1", "its A0")
    for x, head in zip(columns, heads, strict=True):
        drawing.text(x, 896, head, 13, colour=SOFT)
    for number, row in enumerate(strap_rows()):
        for x, cell in zip(columns, row, strict=True):
            drawing.text(x, 922 + 25 * number, cell, 14)


def _draw_legend(drawing: Drawing) -> None:
    x = 30.0
    for net, colour in COLOURS.items():
        drawing.line(net, (x, 1036), (x + 22, 1036))
        drawing.text(x + 28, 1040, net.value, 13, colour=colour)
        x += 54 + 8 * len(net.value)
