"""The bring-up's steps, and each step's questions to a person."""

from dataclasses import dataclass
from typing import Literal

from robot_runtime.control.fin_check import FINS

NO_FIN = "none"
SKIP = "skip"
"""The action that every step has beside its own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """A number that a person gives, or one of the `choices`."""

    name: str
    label: str
    unit: str = ""
    minimum: float = 0.0
    maximum: float = 0.0
    choices: tuple[str, ...] = ()
    optional: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """An action of a person on the page: a press, or a hold that moves a motor meanwhile."""

    name: str
    label: str
    kind: Literal["press", "hold"] = "press"
    inputs: tuple[Question, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One step: the task, its reason, and the expected result."""

    name: str
    title: str
    about: str
    expected: str
    actions: tuple[Action, ...]


_KEEP = Action(name="keep", label="Keep the default")
_DEVICES = Step(
    name="devices",
    title="Devices on the bus",
    about="The board asks every address of its I2C bus who answers. The motors have power meanwhile, as it "
    "feeds the H-bridges; none of them turns.",
    expected="IMU, pressure sensor and four H-bridges answer, and nothing else.",
    actions=(Action(name="scan", label="Look who answers"),),
)
_SENSORS = Step(
    name="sensors",
    title="Encoders and the kind of IMU",
    about="The IMU says which chip it is; each encoder says how well it sees the magnet on its shaft.",
    expected="A known chip, and four green magnets.",
    actions=(Action(name="look", label="Read them"),),
)
_BATTERY = Step(
    name="battery",
    title="Battery",
    about="Measure the battery at its plug with a multimeter. The board's own measurement rests on its "
    "regulator and on two resistors, and the alarm of a low battery rests on it.",
    expected="Both agree within some per cent; the rest becomes a factor.",
    actions=(
        Action(
            name="compare",
            label="Compare",
            inputs=(Question(name="volts", label="Multimeter", unit="V", minimum=4, maximum=9),),
        ),
        _KEEP,
    ),
)
_AXES = Step(
    name="axes",
    title="How the IMU lies",
    about="Lay the hull down level, then lift its nose up, then roll it onto its right side. Gravity shows "
    "which of the chip's axes points where.",
    expected="Close to 1 g along one axis each time.",
    actions=(
        Action(name="level", label="It lies level"),
        Action(name="nose_up", label="Its nose points up"),
        Action(name="right_down", label="Its right side points down"),
    ),
)
_GYRO = Step(
    name="gyro",
    title="Gyroscope at rest",
    about="Lay the hull down where nothing shakes it, and leave it alone for three seconds.",
    expected="Less than 20 °/s of offset, and no movement.",
    actions=(Action(name="rest", label="Measure at rest"),),
)
_PRESSURE = Step(
    name="pressure",
    title="Pressure",
    about="First in air. A barometer beside it, or the weather report's pressure at your height, shows the "
    "sensor's offset; without one it stays 0, which costs no depth. Then put the sensor into a bucket of "
    "water at a depth that you measure.",
    expected="The pressure of the air, and the depth in the bucket within 2 cm.",
    actions=(
        Action(
            name="air",
            label="In air",
            inputs=(
                Question(
                    name="barometer",
                    label="Barometer",
                    unit="hPa",
                    minimum=800,
                    maximum=1100,
                    optional=True,
                ),
            ),
        ),
        Action(
            name="bucket",
            label="In the bucket",
            inputs=(Question(name="depth", label="Depth", unit="cm", minimum=5, maximum=200),),
        ),
        _KEEP,
    ),
)
_BEACONS = Step(
    name="beacons",
    title="Beacon detectors",
    about="Cover both detectors, then hold the lamp before the right one, then before the left one.",
    expected="Each time that detector's own pin changes.",
    actions=(
        Action(name="dark", label="Both are dark"),
        Action(name="right", label="Lamp at the right"),
        Action(name="left", label="Lamp at the left"),
        _KEEP,
    ),
)
_LEAK = Step(
    name="leak",
    title="Leak sensor",
    about="Put the bare ends of its two wires into a glass of tap water, then dry them with a cloth. Skip "
    "this step if there is no leak sensor: then water in the hull is not detected.",
    expected="Wet in the water, dry again afterwards.",
    actions=(
        Action(name="wet", label="The ends are in water"),
        Action(name="dry", label="They are dry again"),
    ),
)
_STORE = Step(
    name="store",
    title="Keep it",
    about="What was measured goes into the board's EEPROM, where it outlives new firmware and an empty "
    "battery.",
    expected="The board reads it back unchanged.",
    actions=(Action(name="store", label="Store it in the board"),),
)


def _fin(number: int) -> Step:
    return Step(
        name=f"fin_{number}",
        title=f"Fin {FINS[number]}, by hand",
        about="Turn the fin by its root until it points along its mount, as in the picture. Then turn it "
        "slowly by a quarter, its tip down.",
        expected="Its own encoder turns by a quarter.",
        actions=(
            Action(name="along", label="It points along its mount"),
            Action(name="down", label="Its tip points down"),
        ),
    )


def _motor(number: int) -> Step:
    seen = Question(name="fin", label="Fin", choices=(*FINS, NO_FIN))
    return Step(
        name=f"motor_{number}",
        title=f"Motor {FINS[number]}",
        about="Keep hands and cables away from the fins. While you hold the button, this motor turns slowly; "
        "letting go stops it. Then say which fin turned.",
        expected="This fin turns, and its encoder with it. Either way round is fine.",
        actions=(
            Action(name="turn", label="Hold to turn it", kind="hold"),
            Action(name="seen", label="This one turned", inputs=(seen,)),
        ),
    )


STEPS: tuple[Step, ...] = (
    _DEVICES,
    _SENSORS,
    _BATTERY,
    _AXES,
    _GYRO,
    _PRESSURE,
    *map(_fin, range(len(FINS))),
    *map(_motor, range(len(FINS))),
    _BEACONS,
    _LEAK,
    _STORE,
)
