"""The reference robot's power: what each part draws, what a stroke costs, and how long a pack lasts.

Nobody has measured it. Currents are typical ones of the data sheets, at 5 V; the fins' power follows from the
water's torque on a stroking blade and from the motor that the emulated board has.
"""

from dataclasses import dataclass
from math import acos, cos, pi

from robot_runtime.contract.buoyancy import DENSITY
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.wiring import PARTS

VOLTS = 5.0
"""V behind the regulators."""
EFFICIENCY = 0.88
"""Of a regulator. Assumed: 0.85 to 0.92 at these currents."""
CELL_CAPACITY, CELL_VOLTS, CELLS = 3.35, 3.6, 2
"""Ah and V of one cell (Panasonic NCR18650B), in series."""
USABLE = 0.7
"""Share of the capacity that a dive uses. Assumed: cold water, age, and an end at 6.8 V."""
FUSE = 5.0
"""A."""
STALL = 1.0
"""A of each motor at most, by the resistor at its H-bridge."""
FREQUENCY, AMPLITUDE_MAX = 1.3, 1.6
"""Hz, and rad from peak to peak: of a fin at full effort."""
FIN_LENGTH = 0.088
"""m, from shaft to tip."""
MOTOR_SPEED, MOTOR_TORQUE, MOTOR_CURRENT, MOTOR_VOLTS = 220 * 2 * pi / 60, 0.235, 1.5, 6.0
"""rad/s without load, N m and A stalled at this voltage: a micro metal gear motor (Pololu, 150:1 HP 6 V)."""
FRICTION = 0.02
"""N m of shaft seal, bearings and gear. Assumed: 0.01 to 0.03; measure yours."""

_CURRENTS = {
    "pi": (
        0.40,
        "assumed, with camera, vision and Wi-Fi; others measured 120 idle",
    ),
    "board": (0.020, "assumed: 9 mA of the chip (data sheet), its LED and regulator"),
    "encoder": (0.016, "data sheet"),
    "led": (0.009, "5 V less 2 V of the LED, behind 330 Ω"),
    "detector": (0.010, "assumed"),
    "imu": (0.004, "data sheet"),
    "bridge": (0.002, "assumed, without its motor"),
    "shifter": (0.002, "its pull-ups while the buses are busy"),
}
_SMALL_CURRENT = (0.001, "assumed")
_UNPOWERED = {"battery", "regulator", "motor_regulator", "motor"}


@dataclass(frozen=True)
class Consumer:
    """Parts of one kind of the wiring, and the current (A, at 5 V) that each draws."""

    title: str
    count: int
    current: float
    origin: str


def list_consumers() -> list[Consumer]:
    """Return every part of the wiring that draws current whenever the robot is on."""
    return [
        Consumer(part.title, part.count, *_CURRENTS.get(part.name, _SMALL_CURRENT))
        for part in PARTS
        if part.name not in _UNPOWERED
    ]


def flap_thrust(craft: Craft, amplitude: float) -> float:
    """Return the published mean thrust, N, of one fin that flaps with this amplitude (rad, peak to peak)."""
    stroke = DENSITY * craft.fin_drag * craft.fin_area * (craft.fin_centre * pi * FREQUENCY) ** 2
    return 8 * stroke * (1 - cos(amplitude))


def flap_amplitude(craft: Craft, thrust: float) -> float:
    """Return the amplitude (rad, peak to peak) for this mean thrust (N) of one fin. Raise ValueError."""
    share = thrust / (flap_thrust(craft, AMPLITUDE_MAX) / (1 - cos(AMPLITUDE_MAX)))
    if not 0 <= share <= 1 - cos(AMPLITUDE_MAX):
        raise ValueError(f"a fin cannot push {thrust:g} N")
    return acos(1 - share)


def flap_power(craft: Craft, amplitude: float) -> float:
    """Return the mean power (W, at the H-bridge) of one flapping fin, which gives nothing back."""
    steps, peak = 200, amplitude / 2 * 2 * pi * FREQUENCY
    blade = 0.5 * DENSITY * craft.fin_normal * craft.fin_area * FIN_LENGTH**3 / 4
    total = 0.0
    for step in range(steps):
        speed = abs(peak * cos(2 * pi * step / steps))
        torque = blade * speed**2 + FRICTION
        volts = MOTOR_VOLTS * (speed / MOTOR_SPEED + torque / MOTOR_TORQUE)
        total += volts * torque / MOTOR_TORQUE * MOTOR_CURRENT
    return total / steps if amplitude else 0.0


def electronics_power() -> float:
    """Return the W that all parts but the motors take from the battery."""
    return sum(consumer.count * consumer.current for consumer in list_consumers()) * VOLTS / EFFICIENCY


def dive_power(craft: Craft) -> float:
    """Return the W that the battery gives while all fins swim at the most: the mean load at its worst."""
    fins = len(craft.fin_positions) * flap_power(craft, AMPLITUDE_MAX)
    return fins / EFFICIENCY + electronics_power()


def motor_power(drive: float, speed: float) -> float:
    """Return the W that an H-bridge takes for a motor at `drive` (V) that turns at `speed` (rad/s).

    A motor that is driven by the water gives nothing back.
    """
    current = (abs(drive) / MOTOR_VOLTS - abs(speed) / MOTOR_SPEED) * MOTOR_CURRENT
    return abs(drive) * max(current, 0.0)


def pack_energy() -> float:
    """Return the Wh of a new, full pack."""
    return CELL_CAPACITY * CELL_VOLTS * CELLS
