"""The checks of the bring-up: readings in, results as text out."""

from collections.abc import Collection, Sequence
from math import degrees

from robot_runtime.calibration.gyro import judge_rest
from robot_runtime.contract.calibration import GYRO_BIAS, Axis
from robot_runtime.contract.packets import FIN_COUNT, Raw
from robot_runtime.contract.wiring import FINS as WIRED_FINS
from robot_runtime.contract.wiring import IMU_ADDRESS, PRESSURE_ADDRESS
from robot_runtime.control.fin_check import FINS
from robot_runtime.experiments.bring_up.readings import (
    Three,
    field,
    mean_force,
    mean_pressure,
    mean_volts,
    movements,
)
from robot_runtime.experiments.bring_up.results import Result

DEVICES = {
    IMU_ADDRESS: "IMU",
    PRESSURE_ADDRESS: "pressure sensor",
    **{fin.address: f"H-bridge of the {fin.position} fin" for fin in WIRED_FINS},
}
_BRIDGE_RANGE = range(0x60, 0x69)
"""The addresses that the two straps of a DRV8830 can choose."""
IDENTITIES = {
    0x68: "an MPU-6050",
    0x70: "an MPU-6500 or a clone of the MPU-6050",
    0x71: "an MPU-9250",
    0x72: "a clone of the MPU-6050",
    0x98: "a clone of the MPU-6050",
}

MOVED = 40
"""Counts, 14°, from which an encoder has been turned."""
QUARTER = 256
_QUARTER_TOLERANCE = 128
_LEVEL, _TILTED = 0.8, 0.6
"""g along one axis, from which the hull counts as lying so."""
_FORCE_TOLERANCE = 0.1
"""g; an MPU-6050 is off by 0.05 g at most, a clone by more."""
AIR = (80_000, 110_000)
"""Pa, from a high mountain to a strong high."""
SENSOR_TOLERANCE = 5_000
"""Pa; the MS5837-30BA is off by 50 hPa at most between 0 and 40 °C."""
OF_02BA = 20
"""Times the true pressure that the 30BA's formulas make of an MS5837-02BA's counts (data sheets)."""
DEPTH_TOLERANCE = 0.02
"""m, and as much as a twentieth of the depth."""
PRESSURE_PER_METRE = 9_810


def check_devices(answering: Collection[int]) -> list[Result]:
    """Check the devices that answer on I2C. An answer from an unused address hints at a wrong strap."""
    strangers = sorted(set(answering) - set(DEVICES))
    return [
        *(_check_device(address, name, answering, strangers) for address, name in DEVICES.items()),
        *(
            Result(
                what=f"0x{address:02X}",
                expected="silent",
                measured="answers",
                verdict="note",
                advice=_stranger(address),
            )
            for address in strangers
        ),
    ]


def _check_device(address: int, name: str, answering: Collection[int], strangers: Sequence[int]) -> Result:
    there = address in answering
    return Result(
        what=f"{name} at 0x{address:02X}",
        expected="answers",
        measured="answers" if there else "silent",
        verdict="good" if there else "wrong",
        advice="" if there else _missing(address, strangers, answering),
    )


def _missing(address: int, strangers: Sequence[int], answering: Collection[int]) -> str:
    if not answering:
        return (
            "Nothing answers: check SDA (A4), SCL (A5), their pull-ups, and that no device holds them down."
        )
    if address == IMU_ADDRESS:
        if 0x68 in strangers:
            return "An IMU answers at 0x68: its strap AD0 must lie at its supply."
        return "Check the IMU's supply and its two wires."
    if address == PRESSURE_ADDRESS:
        if 0x77 in strangers:
            return "Another sensor answers at 0x77, such as an MS5611. The robot needs an MS5837-30BA."
        return "Check the pressure sensor's supply and its two wires."
    bridges = [address for address in strangers if address in _BRIDGE_RANGE]
    if bridges:
        places = ", ".join(f"0x{address:02X}" for address in bridges)
        return f"A bridge answers at {places} instead: compare its straps A0 and A1 with the wiring table."
    return "Check this bridge's supply and straps: two bridges with the same straps answer as one."


def _stranger(address: int) -> str:
    if address == 0x68:
        return "An IMU whose strap AD0 lies at ground."
    if address in _BRIDGE_RANGE:
        return "An H-bridge with other straps than any fin's."
    return "The robot does not need it."


def check_identity(raw: Raw) -> Result:
    """Check the kind of the IMU."""
    known = IDENTITIES.get(raw.identity)
    return Result(
        what="kind of IMU",
        expected="an MPU-6050 or one whose registers agree",
        measured=known or (f"WHO_AM_I 0x{raw.identity:02X}" if raw.identity else "silent"),
        verdict="good" if known else "wrong",
        advice="" if known else "Another chip answers there, or none. The robot cannot use it.",
    )


def check_fields(raw: Raw) -> list[Result]:
    """Check the magnet that each encoder sees."""
    advice = {
        "green": "",
        "yellow": "The magnet is a little too near or too far: usable, but the angle is less exact.",
        "red": "The magnet is far too near, too far, or off its centre.",
        "silent": "No encoder answers: check its supply, its select line, and the bus.",
    }
    fields = [field(word) for word in raw.encoders]
    return [
        Result(
            what=f"encoder of the {name} fin",
            expected="green",
            measured=now,
            verdict="good" if now == "green" else "note" if now == "yellow" else "wrong",
            advice=advice[now],
        )
        for name, now in zip(FINS, fields, strict=True)
    ]


def check_turn(fin: int, before: Raw, after: Raw) -> tuple[Result, bool | None]:
    """Check a fin whose tip was turned a quarter down by hand; return also True if its counts fell."""
    turned = movements([before, after])
    moved = [index for index in range(FIN_COUNT) if abs(turned[index]) >= MOVED]
    what, expected = f"{FINS[fin]} fin turned by hand", "its own encoder turns by a quarter"
    if moved == [fin] and abs(abs(turned[fin]) - QUARTER) <= _QUARTER_TOLERANCE:
        falls = turned[fin] < 0
        way = "fall" if falls else "rise"
        measured = f"{abs(turned[fin]) * 360 / 1024:.0f}°; its counts {way} as the tip goes down"
        return Result(what=what, expected=expected, measured=measured), falls
    if not moved:
        measured, advice = "no encoder turned", "Is the magnet glued to the shaft? Turn the fin by its root."
    elif moved == [fin]:
        measured = f"{abs(turned[fin]) * 360 / 1024:.0f}°"
        advice = "Turn it by a quarter, slowly, the way its tip goes down, and measure again."
    elif len(moved) == 1:
        measured = f"the encoder of the {FINS[moved[0]]} fin turned"
        advice = (
            f"The select lines of the {FINS[fin]} and the {FINS[moved[0]]} encoder are swapped, or you "
            "turned the other fin. Swap them and measure both again."
        )
    else:
        measured = f"the encoders of {' and '.join(FINS[index] for index in moved)} turned"
        advice = "Turn one fin alone; else two encoders are selected at once."
    return Result(what=what, expected=expected, measured=measured, verdict="wrong", advice=advice), None


def check_jog(fin: int, raws: Sequence[Raw], seen: int | None) -> tuple[Result, bool | None]:
    """Check a motor that was driven forwards; `seen` is the fin that a person saw turn.

    Return also True if the counts fell, None where that is not clear.
    """
    turned = movements(raws)
    moved = [index for index in range(FIN_COUNT) if abs(turned[index]) >= MOVED]
    what = f"motor of the {FINS[fin]} fin"
    expected = "this fin turns, and its encoder with it"
    eyes = "no fin turned" if seen is None else f"the {FINS[seen]} fin turned"
    encoders = " and ".join(FINS[index] for index in moved)
    measured = f"{eyes}; {f'encoder: {encoders}' if moved else 'no encoder'}"
    if moved == [fin] and seen == fin:
        return Result(what=what, expected=expected, measured=measured), turned[fin] < 0
    return (
        Result(
            what=what,
            expected=expected,
            measured=measured,
            verdict="wrong",
            advice=_explain_jog(fin, moved, seen),
        ),
        None,
    )


def _explain_jog(fin: int, moved: Sequence[int], seen: int | None) -> str:
    if len(moved) > 1:
        both = " and ".join(FINS[index] for index in moved)
        return f"Two motors turn: the H-bridges of {both} have the same straps."
    if seen is None and not moved:
        return (
            "Is the motors' supply on, and the motor at its bridge? A bridge that has tripped rests. "
            "If the fin is too stiff for half the drive, loosen its shaft's seal: by hand it turns easily."
        )
    if not moved:
        return "The fin turns but no encoder sees it: check this encoder's magnet and select line."
    (encoder,) = moved
    if seen is None:
        return f"The encoder of the {FINS[encoder]} fin turned though no fin did: look again."
    if seen == encoder:
        return (
            f"The motors of the {FINS[fin]} and the {FINS[seen]} fin are swapped at their bridges, or the "
            "bridges' straps are."
        )
    if seen == fin:
        return (
            f"This fin turns, but the encoders of {FINS[fin]} and {FINS[encoder]} have swapped select lines."
        )
    return "Motors and encoders are swapped: begin with the motor's wires, then repeat both steps."


def find_axis(force: Three, sign: int, least: float) -> Axis | None:
    """Return the chip's axis along gravity, with this sign; None where the chip lies askew."""
    axis = max(range(3), key=lambda index: abs(force[index]))
    return _name(axis, (force[axis] > 0) == (sign > 0)) if abs(force[axis]) >= least else None


def check_pose(what: str, raws: Sequence[Raw], sign: int, level: bool) -> tuple[Result, Axis | None]:
    """Check the hull in a pose in which one axis of the body lies along gravity.

    `sign`: -1 where the body's axis points down, 1 where it points up (specific force points up at rest).
    """
    force = mean_force(raws)
    size = sum(part * part for part in force) ** 0.5
    axis = find_axis(force, sign, _LEVEL if level else _TILTED)
    shown = f"{force[0]:+.2f}, {force[1]:+.2f}, {force[2]:+.2f} g"
    if size == 0:
        advice = "The IMU says nothing."
    elif abs(size - 1) > _FORCE_TOLERANCE:
        advice = f"At rest it must feel 1 g, but feels {size:.2f} g: it moved, or it is a bad clone."
    elif axis is None:
        advice = "It lies askew: lay the hull as the picture shows, and measure again."
    else:
        return Result(what=what, expected="1 g along one axis", measured=shown), axis
    return Result(
        what=what, expected="1 g along one axis", measured=shown, verdict="wrong", advice=advice
    ), None


def complete_axes(forward: Axis, down: Axis) -> tuple[Axis, Axis, Axis] | None:
    """Return the chip's axes forward, right and down; None where forward and down are the same axis."""
    first, last = "xyz".index(forward[-1]), "xyz".index(down[-1])
    if first == last:
        return None
    # Right is the cross product of down and forward.
    cyclic = (first - last) % 3 == 1
    positive = forward.startswith("-") == down.startswith("-")
    return forward, _name(3 - first - last, positive == cyclic), down


def _name(axis: int, positive: bool) -> Axis:
    names: tuple[Axis, ...] = ("x", "y", "z") if positive else ("-x", "-y", "-z")
    return names[axis]


def check_air(raws: Sequence[Raw], barometer: float | None) -> Result:
    """Compare the pressure in air, Pa, with that of a barometer at the same height, if there is one."""
    pressure = mean_pressure(raws)
    expected = f"{barometer / 100:.1f} hPa" if barometer else f"{AIR[0] / 100:.0f} to {AIR[1] / 100:.0f} hPa"
    good = (
        AIR[0] <= pressure <= AIR[1] if barometer is None else abs(pressure - barometer) <= SENSOR_TOLERANCE
    )
    advice = "A sound sensor is off by 50 hPa at most. Is it wet, or pressed by its potting?"
    if not pressure:
        advice = "The sensor says nothing: its PROM could not be read, or it does not answer."
    elif AIR[0] <= pressure / OF_02BA <= AIR[1]:
        advice = "It counts as an MS5837-02BA does. The robot needs the 30BA, which bears more than 10 m."
    return Result(
        what="pressure in air",
        expected=expected,
        measured=f"{pressure / 100:.1f} hPa",
        verdict="good" if good else "wrong",
        advice="" if good else advice,
    )


def check_bucket(air: float, raws: Sequence[Raw], depth: float) -> Result:
    """Check the pressure at a known depth (m) of fresh water."""
    measured = (mean_pressure(raws) - air) / PRESSURE_PER_METRE
    good = abs(measured - depth) <= max(DEPTH_TOLERANCE, depth / 20)
    return Result(
        what="depth in a bucket",
        expected=f"{depth * 100:.0f} cm",
        measured=f"{measured * 100:.1f} cm",
        verdict="good" if good else "wrong",
        advice="" if good else "Hold its opening at that depth, and wait until no bubble sits in it.",
    )


def check_battery(raws: Sequence[Raw], multimeter: float) -> tuple[Result, float | None]:
    """Compare the battery's voltage with a multimeter's; return also the factor that corrects it."""
    volts = mean_volts(raws)
    factor = multimeter / volts if volts > 1 else 0.0
    good = 0.8 <= factor <= 1.25
    sound = abs(factor - 1) <= 0.06
    advice = "" if sound else "The regulator or the divider is out of its tolerance. The factor mends it."
    if not good:
        advice = "Is the divider made of two equal resistors, its middle at A2?"
    return (
        Result(
            what="battery voltage",
            expected=f"{multimeter:.2f} V by the multimeter",
            measured=f"{volts:.2f} V",
            verdict="wrong" if not good else "good" if sound else "note",
            advice=advice,
        ),
        factor if good else None,
    )


def check_lamp(side: int, dark: Raw, lit: Raw) -> tuple[Result, bool | None]:
    """Check one detector (0: right, 1: left) with a lamp; return also True if its pin is low in the light."""
    names = ("right", "left")
    changed = dark.beacons ^ lit.beacons
    what, expected = f"{names[side]} detector", "its own pin changes in the light"
    if changed == 1 << side:
        low = not lit.beacons >> side & 1
        return Result(what=what, expected=expected, measured=f"its pin goes {'low' if low else 'high'}"), low
    if changed == 0:
        measured, advice = (
            "no pin changed",
            "Does the lamp blink at the detector's frequency? Check its supply.",
        )
    elif changed == 2 >> side:
        measured = f"the {names[1 - side]} detector's pin changed"
        advice = "The detectors are swapped: right belongs to D4, left to D5."
    else:
        measured, advice = "both pins changed", "Shade the other detector, and measure again."
    return Result(what=what, expected=expected, measured=measured, verdict="wrong", advice=advice), None


def check_leak(raws: Sequence[Raw], *, wet: bool) -> Result:
    """Check the leak sensor with its ends in water, or dry."""
    shares = [bool(raw.leak) for raw in raws]
    steady = all(shares) or not any(shares)
    measured = ("wet" if shares[-1] else "dry") if steady else "wet and dry by turns"
    advice = (
        "Is one wire at D2 and the other at GND, and are their ends bare? Pure water does not conduct: take "
        "tap water, or add a little salt."
        if wet
        else "Dry the ends well and keep them apart. If it stays wet, D2 touches GND somewhere."
    )
    good = steady and shares[-1] == wet
    return Result(
        what=f"leak sensor {'in water' if wet else 'dried'}",
        expected="wet" if wet else "dry",
        measured=measured,
        verdict="good" if good else "wrong",
        advice="" if good else advice,
    )


def check_rest(raws: Sequence[Raw]) -> tuple[Result, Three | None]:
    """Check the turn rate of a hull at rest; return also its mean about the chip's axes (rad/s)."""
    rest = judge_rest([raw.rate for raw in raws])
    shown = ", ".join(f"{degrees(part):+.2f}" for part in rest.rate)
    what, expected, measured = "turn rate at rest", "below 20 °/s, and steady", f"{shown} °/s"
    if rest.moved is not None:
        advice = "The hull moved. Lay it down where nothing shakes it, and measure again."
    elif max(map(abs, rest.rate)) > GYRO_BIAS.maximum:
        advice = "No sound gyroscope is off by so much: the hull turned, or the chip is broken."
    elif rest.stuck:
        advice = "The readings do not change at all: the IMU does not answer, or has stopped."
    else:
        return Result(what=what, expected=expected, measured=measured), rest.rate
    return Result(what=what, expected=expected, measured=measured, verdict="wrong", advice=advice), None
