"""docs/run/hardware/hull.md: the reference hull, its parts, and the budgets of weight and power."""

from robot_runtime.contract import power_budget as power
from robot_runtime.contract.buoyancy import GRAVITY, RESERVE, buoyancy_reserve, water_density
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.hull import (
    DEPTH_MAX,
    HullPart,
    ballast_thickness,
    opening,
    plate_stress,
    squeeze,
    weigh,
)
from robot_runtime.contract.wiring import BATTERY_MIN
from robot_runtime.generate.markdown import fill, page, table

SOURCE = "robot_runtime/contract/hull.py and power_budget.py"
PARTS = (
    ("tray", "PVC-U plates of 8 mm, glued: 240 x 120 x 92, edges broken by 6"),
    ("lid", "cast acrylic, 8 mm, clear: the LED is seen through it"),
    ("frame", "PVC-U bars of 15 x 15, glued under the edge; takes the inserts of the screws"),
    ("dome", "acrylic half sphere, 50 outside, 2 thick, glued into a PVC ring 60 x 5"),
    ("camera", "lens in the middle of the dome, 125 before that of the hull; on a printed mount. "
     "Raspberry Pi Camera Module 2: 25 US$ (April 2016)"),
    ("ballast", "steel, painted, {plate:.0f} x {plate_width:.0f} x {thickness:.1f}; {pieces} g of "
     "it as loose pieces of 2 to 50 g"),
    ("battery", "two 18650 cells in series, {capacity:.2f} Ah, protected, fuse of {fuse:g} A; strapped "
     "down. Panasonic NCR18650B"),
    ("Raspberry Pi, board", "on a carrier plate that lifts out. Raspberry Pi Zero 2 W: 15 US$ "
     "(October 2021)"),
    ("pressure sensor", "MS5837-30BA, potted in a threaded plug M10 through the lid. Blue Robotics "
     "Bar30: 68 US$ (September 2018)"),
    ("switch, vent plug", "M10 with O-ring. The vent is open while the lid is closed, and takes the "
     "pump of the test"),
    ("boss (4)", "PVC-U rod of 24, glued into the corner, 30° off the side, as the fin's shaft lies"),
    ("fin (4)", "rubber of 3, 88 from shaft to tip, 45 cm²; clamped to its shaft"),
    ("lid's screws (16)", "M4 x 20, stainless A4, in brass inserts, outside of the cord"),
    ("cord", "NBR 70, 3 thick, in a groove of 4.2 x 2.35; its ends cut at 45° and glued"),
    ("regulators", "see [Parts](parts.md)"),
    ("shaft's seals (8)", "O-rings 4 x 1.5, NBR 70, two in each boss, silicone grease between them"),
    ("bearings (8)", "plain, plastic, bore 4: steel balls rust here"),
    ("magnet, encoder (4 each)", "magnet 6 x 2.5, magnetised across, 1 from the encoder. ams AS5040"),
    ("gears (4 pairs)", "1 : 1, module 0.5: the encoder must see the fin's own angle"),
    ("motor (4)", "beside its shaft, under the frame. Pololu micro metal gear motor 150:1 HP 6 V"),
)  # fmt: skip
"""Name (with how many, if not one) and figures of the parts, in the order of the drawing's numbers."""


def hull_page() -> str:
    """Return the whole text of hull.md."""
    craft, budget = Craft(), weigh()
    fresh = water_density(20)
    energy = power.pack_energy() * power.USABLE
    stalled = len(craft.fin_positions) * power.STALL * power.VOLTS / power.EFFICIENCY
    values = {
        "share": 100 * RESERVE,
        "depth": DEPTH_MAX,
        "friction": 1000 * power.FRICTION,
        "torque": 1000 * power.MOTOR_TORQUE * 3.2 / power.MOTOR_VOLTS,
        "stress": plate_stress(DEPTH_MAX) / 1e6,
        "deep_stress": plate_stress(10) / 1e6,
        "squeeze": squeeze(DEPTH_MAX) * 1e6,
        "mass": 1000 * budget.mass,
        "plate": 1000 * opening()[0],
        "plate_width": 1000 * opening()[1],
        "thickness": 1000 * ballast_thickness(budget.ballast.mass),
        "pieces": 150,
        "capacity": power.CELL_CAPACITY,
        "fuse": power.FUSE,
        "volume": 1000 * budget.volume,
        "craft_volume": 1000 * craft.volume,
        "kilograms": budget.mass,
        "craft_mass": craft.mass,
        "reserve": 1000 * (budget.volume * fresh - budget.mass),
        "craft_reserve": buoyancy_reserve(craft, fresh),
        "height": 1000 * budget.buoyancy_height,
        "craft_height": 1000 * craft.buoyancy_height,
        "uncertain": 200 * sum(part.count * part.mass for part in budget.parts if "assumed" in part.origin),
        "efficiency": 100 * power.EFFICIENCY,
        "electronics": power.electronics_power(),
        "energy": power.pack_energy(),
        "usable": 100 * power.USABLE,
        "worst": (stalled + power.electronics_power()) / BATTERY_MIN,
        "low": BATTERY_MIN,
    }
    parts = table(
        ("part", "figures that matter"),
        (
            (f"{number}. {title}", figures.format(**values))
            for number, (title, figures) in enumerate(PARTS, 1)
        ),
    )
    weights = table(
        ("part", "g in all", "forward, mm", "down, mm", "origin"),
        (*map(_weight_row, budget.parts), _total_row(budget.mass)),
    )
    consumers = power.list_consumers()
    total = sum(consumer.count * consumer.current for consumer in consumers)
    currents = table(
        ("part", "mA in all", "origin"),
        (
            *(
                (
                    _name(consumer.title, consumer.count),
                    f"{1000 * consumer.count * consumer.current:.0f}",
                    consumer.origin,
                )
                for consumer in consumers
            ),
            ("**in all**", f"**{1000 * total:.0f}**", ""),
        ),
    )
    times = table(
        ("the robot", "fins, W", "at the battery, W", "dive, hours"),
        (_time_row(name, watts, energy) for name, watts in _states(craft, 1000 * RESERVE * craft.mass)),
    )
    return page(
        "Hull",
        SOURCE,
        fill("hull", **values, parts=parts, weights=weights, currents=currents, times=times),
    )


def _weight_row(part: HullPart) -> tuple[str, ...]:
    return (
        _name(part.title, part.count),
        f"{1000 * part.count * part.mass:.0f}",
        f"{1000 * part.forward:.0f}",
        f"{1000 * part.down:.0f}",
        part.origin,
    )


def _name(title: str, count: int) -> str:
    return f"{title} ({count})" if count > 1 else title


def _total_row(mass: float) -> tuple[str, ...]:
    return "**in all**", f"**{1000 * mass:.0f}**", "", "", ""


def _states(craft: Craft, reserve: float) -> list[tuple[str, float]]:
    """Return what the robot may do for a whole dive, and the W of its fins at their H-bridges."""
    hold = power.flap_amplitude(craft, reserve / 1000 * GRAVITY / 4)
    full = power.flap_power(craft, power.AMPLITUDE_MAX)
    return [
        ("waits, fins still", 0.0),
        (
            f"holds its depth against {reserve:.0f} g, strokes of {hold:.2f} rad",
            4 * power.flap_power(craft, hold),
        ),
        ("swims forward with both front fins at the most", 2 * full),
        ("all four fins at the most", 4 * full),
    ]


def _time_row(name: str, watts: float, energy: float) -> tuple[str, ...]:
    total = watts / power.EFFICIENCY + power.electronics_power()
    return name, f"{watts:.1f}", f"{total:.1f}", f"{energy / total:.1f}"
