"""The bring-up of one robot: performs a person's actions, and stores their results."""

import threading
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Literal, TypeVar

from robot_runtime.calibration.gyro import SECONDS as REST_SECONDS
from robot_runtime.contract.calibration import STEPS as STEPS_IN_WORDS
from robot_runtime.contract.calibration import Axis, CalibrationValues, StepName
from robot_runtime.contract.packets import FIN_COUNT, Raw
from robot_runtime.control.fin_check import FINS
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.bring_up import checks
from robot_runtime.experiments.bring_up.bench import Bench
from robot_runtime.experiments.bring_up.guide import NO_FIN, SKIP, STEPS, Action, Question
from robot_runtime.experiments.bring_up.readings import counts, mean_pressure
from robot_runtime.experiments.bring_up.results import Result

StepState = Literal["open", "done", "wrong", "skipped"]
V = TypeVar("V")
Given = Mapping[str, float | str]

JOG_DRIVE = 20
"""H-bridge command: the one at which the robot's firmware expects the stiffest fin to turn. One without a
seal turns by 300 ° a second, and a hand holds it."""
LEAK_CHECKS = 2
"""Wet, and dry: a sensor that is always dry, or not there, has not shown that it finds water."""
_LOOK = 0.4
"""s over which a reading is averaged."""


class BringUp:
    """One robot's bring-up on its `bench`. `perform` may take some seconds."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._results: dict[str, dict[str, Result]] = {step.name: {} for step in STEPS}
        self._skipped: set[str] = set()
        self._along: dict[int, Raw] = {}
        self._zeros: dict[int, int] = {}
        self._encoders: dict[int, bool] = {}
        self._turned: dict[int, list[Raw]] = {}
        self._jogging = threading.Lock()
        self._stopped = False
        """A STOP came since a motor's button was pressed: what is still held must not turn it again."""
        self._motors: dict[int, bool] = {}
        self._poses: dict[str, Axis] = {}
        self._axes: tuple[Axis, Axis, Axis] | None = None
        self._bias: tuple[float, float, float] | None = None
        self._air: float | None = None
        self._offset: int | None = None
        self._factor: float | None = None
        self._dark: Raw | None = None
        self._inverted: dict[int, bool] = {}
        self._beacons: bool | None = None
        self._stored: CalibrationValues | None = None
        self._do: dict[tuple[str, str], Callable[[Given], None]] = {
            ("devices", "scan"): self._scan,
            ("sensors", "look"): self._look,
            ("battery", "compare"): self._compare,
            ("battery", "keep"): self._keep_battery,
            ("axes", "level"): partial(self._pose, "level", -1),
            ("axes", "nose_up"): partial(self._pose, "nose_up", 1),
            ("axes", "right_down"): partial(self._pose, "right_down", -1),
            ("gyro", "rest"): self._rest,
            ("pressure", "air"): self._measure_air,
            ("pressure", "bucket"): self._measure_bucket,
            ("pressure", "keep"): self._keep_pressure,
            ("beacons", "dark"): self._measure_dark,
            ("beacons", "right"): partial(self._lamp, 0),
            ("beacons", "left"): partial(self._lamp, 1),
            ("beacons", "keep"): self._keep_beacons,
            ("leak", "wet"): partial(self._check_leak, True),
            ("leak", "dry"): partial(self._check_leak, False),
            ("store", "store"): self._store,
        }
        for fin in range(FIN_COUNT):
            self._do[f"fin_{fin}", "along"] = partial(self._point_along, fin)
            self._do[f"fin_{fin}", "down"] = partial(self._point_down, fin)
            self._do[f"motor_{fin}", "turn"] = partial(self._turn, fin)
            self._do[f"motor_{fin}", "seen"] = partial(self._see, fin)

    def perform(self, step: str, action: str, given: Given) -> None:
        """Perform an action with the person's answers. `SKIP` leaves the step out until its next action.

        Raise RefusedError where that is not possible or out of range, and BenchError.
        """
        if action == SKIP and step in self._results:
            self._skipped.add(step)
            return
        guide = _find(step, action)
        self._skipped.discard(step)
        self._do[step, action]({**given, **_read(guide, given)})

    def stop(self) -> None:
        """Stop the turning motor until a motor's button is pressed again. Raise BenchError.

        May be called while another thread performs an action.
        """
        with self._jogging:
            self._stopped = True
            self._bench.jog(0, 0)

    def results(self, step: str) -> list[Result]:
        """Return the findings of a step, the newest of each check."""
        return list(self._results[step].values())

    def state(self, step: str) -> StepState:
        """Return the state of a step: wrong where any of its newest findings is."""
        if any(result.verdict == "wrong" for result in self._results[step].values()):
            return "wrong"
        if self._is_done(step):
            return "done"
        return "skipped" if step in self._skipped else "open"

    def calibration(self) -> CalibrationValues:
        """Return the calibration measured until now; a step without a measurement is not done."""
        fins = len(self._encoders) == FIN_COUNT
        motors = fins and len(self._motors) == FIN_COUNT
        parts: dict[StepName, bool] = {
            "fins": fins,
            "motors": motors,
            "axes": self._axes is not None,
            "gyro": self._bias is not None,
            "pressure": self._offset is not None,
            "battery": self._factor is not None,
            "beacons": self._beacons is not None,
        }
        return CalibrationValues(
            done=tuple(name for name, done in parts.items() if done),
            fin_zeros=_of_fins(self._zeros, 0),
            encoders_reversed=_of_fins(self._encoders, False),
            motors_reversed=_of_fins(self._motors, False),
            axes=self._axes or ("x", "y", "z"),
            gyro_bias=self._bias or (0.0, 0.0, 0.0),
            pressure_offset=self._offset or 0,
            battery_factor=self._factor or 1.0,
            beacons_inverted=bool(self._beacons),
        )

    def _is_done(self, step: str) -> bool:
        name, _, number = step.partition("_")
        done: dict[str, bool] = {
            "devices": bool(self._results["devices"]),
            "sensors": bool(self._results["sensors"]),
            "battery": self._factor is not None,
            "axes": self._axes is not None,
            "gyro": self._bias is not None,
            "pressure": self._offset is not None,
            "beacons": self._beacons is not None,
            "leak": len(self._results["leak"]) == LEAK_CHECKS,
            "store": self._stored is not None and self._stored == self.calibration(),
        }
        if name == "fin":
            return int(number) in self._encoders
        if name == "motor":
            return int(number) in self._motors
        return done[step]

    def _note(self, step: str, *results: Result) -> None:
        for result in results:
            self._results[step][result.what] = result

    def _readings(self) -> list[Raw]:
        return self._bench.readings(_LOOK)

    def _scan(self, _: Given) -> None:
        self._results["devices"].clear()
        self._note("devices", *checks.check_devices(self._bench.scan()))

    def _look(self, _: Given) -> None:
        raw = self._readings()[-1]
        self._note("sensors", checks.check_identity(raw), *checks.check_fields(raw))

    def _compare(self, given: Given) -> None:
        result, self._factor = checks.check_battery(self._readings(), float(given["volts"]))
        self._note("battery", result)

    def _keep_battery(self, _: Given) -> None:
        self._factor = 1.0
        self._results["battery"] = {}
        self._note("battery", _unmeasured("battery voltage", "factor 1"))

    def _pose(self, pose: str, sign: int, _: Given) -> None:
        description = {"level": "level", "nose_up": "nose up", "right_down": "right side down"}[pose]
        result, axis = checks.check_pose(description, self._readings(), sign, pose == "level")
        self._note("axes", result)
        self._poses.pop(pose, None)
        if axis is not None:
            self._poses[pose] = axis
        self._axes = None
        self._results["axes"].pop("axes", None)
        if len(self._poses) == 3:
            self._conclude_axes()

    def _conclude_axes(self) -> None:
        axes = checks.complete_axes(self._poses["nose_up"], self._poses["level"])
        expected = "three axes at right angles"
        if axes is None or axes[1] != self._poses["right_down"]:
            measured = ", ".join(self._poses[pose] for pose in ("nose_up", "right_down", "level"))
            advice = "The three poses do not fit together: lay the hull down as in the pictures, one by one."
            self._note(
                "axes",
                Result(what="axes", expected=expected, measured=measured, verdict="wrong", advice=advice),
            )
            return
        self._axes = axes
        self._bias = None
        self._results["gyro"] = {}
        self._note("axes", Result(what="axes", expected=expected, measured=", ".join(axes)))

    def _rest(self, _: Given) -> None:
        if self._axes is None:
            raise RefusedError("First measure how the IMU lies: the offset belongs to the robot's axes.")
        self._bias = None
        result, rate = checks.check_rest(self._bench.readings(REST_SECONDS))
        self._note("gyro", result)
        if rate is not None:
            forward, right, down = (_along(axis, rate) for axis in self._axes)
            self._bias = forward, right, down

    def _measure_air(self, given: Given) -> None:
        readings = self._readings()
        barometer = float(given["barometer"]) * 100 if "barometer" in given else None
        result = checks.check_air(readings, barometer)
        self._note("pressure", result)
        self._air = mean_pressure(readings) or None
        self._offset = None
        if result.verdict == "good" and self._air is not None:
            self._offset = round(self._air - barometer) if barometer else 0

    def _measure_bucket(self, given: Given) -> None:
        if self._air is None:
            raise RefusedError("First measure the pressure in air.")
        self._note("pressure", checks.check_bucket(self._air, self._readings(), float(given["depth"]) / 100))

    def _keep_pressure(self, _: Given) -> None:
        self._offset = 0
        self._results["pressure"] = {}
        self._note("pressure", _unmeasured("pressure", "offset 0"))

    def _point_along(self, fin: int, _: Given) -> None:
        self._along[fin] = self._readings()[-1]
        self._encoders.pop(fin, None)
        self._results[f"fin_{fin}"] = {}

    def _point_down(self, fin: int, _: Given) -> None:
        along = self._along.get(fin)
        if along is None:
            raise RefusedError("First turn the fin along its mount, and press that button.")
        result, falls = checks.check_turn(fin, along, self._readings()[-1])
        self._note(f"fin_{fin}", result)
        self._encoders.pop(fin, None)
        if falls is not None:
            self._zeros[fin] = counts(along.encoders[fin])
            self._encoders[fin] = falls

    def _turn(self, fin: int, given: Given) -> None:
        if given.get("stop"):
            self._bench.jog(fin, 0)
            self._turned.setdefault(fin, []).extend(self._bench.since_mark())
            return
        held = given.get("on")
        with self._jogging:
            if self._stopped and held:
                raise RefusedError("STOP was pressed. Release the button, then press it again.")
            self._stopped = False
            if fin not in self._turned or not held:
                self._turned[fin] = []
                self._bench.mark()
            self._bench.jog(fin, JOG_DRIVE)

    def _see(self, fin: int, given: Given) -> None:
        raws = self._turned.get(fin)
        if not raws:
            raise RefusedError("First hold the button, and watch which fin turns.")
        seen = None if given["fin"] == NO_FIN else FINS.index(str(given["fin"]))
        result, falls = checks.check_jog(fin, raws, seen)
        self._motors.pop(fin, None)
        self._note(f"motor_{fin}", result)
        if falls is not None:
            self._motors[fin] = falls

    def _measure_dark(self, _: Given) -> None:
        self._dark = self._readings()[-1]
        self._inverted = {}
        self._beacons = None
        self._results["beacons"] = {}

    def _lamp(self, side: int, _: Given) -> None:
        if self._dark is None:
            raise RefusedError("First cover both detectors.")
        result, low = checks.check_lamp(side, self._dark, self._readings()[-1])
        self._note("beacons", result)
        self._inverted.pop(side, None)
        self._beacons = None
        self._results["beacons"].pop("polarity", None)
        if low is not None:
            self._inverted[side] = low
        if len(self._inverted) == 2:
            self._conclude_beacons()

    def _conclude_beacons(self) -> None:
        right, left = self._inverted[0], self._inverted[1]
        if right == left:
            self._beacons = right
            return
        self._note(
            "beacons",
            Result(
                what="polarity",
                expected="the same of both",
                measured="one goes high, one low",
                verdict="wrong",
                advice="Both detectors must be of one kind.",
            ),
        )

    def _keep_beacons(self, _: Given) -> None:
        self._beacons = False
        self._results["beacons"] = {}
        self._note("beacons", _unmeasured("polarity", "high in the light"))

    def _check_leak(self, wet: bool, _: Given) -> None:
        self._note("leak", checks.check_leak(self._readings(), wet=wet))

    def _store(self, _: Given) -> None:
        measured = self.calibration()
        answer = self._bench.store(measured.packet())
        same = answer.to_bytes() == measured.packet().to_bytes()
        missing = ", ".join(STEPS_IN_WORDS[name] for name in measured.missing)
        self._stored = measured if same else None
        self._note(
            "store",
            Result(
                what="calibration",
                expected="kept as it was measured",
                measured="kept" if same else "not kept",
                verdict="wrong" if not same else "note" if missing else "good",
                advice="The EEPROM does not keep what is written: the chip is worn or its supply too low."
                if not same
                else f"Still missing: {missing}. The robot does not arm before that is done."
                if missing
                else "",
            ),
        )


def _of_fins(known: Mapping[int, V], default: V) -> tuple[V, V, V, V]:
    front_right, back_right, back_left, front_left = (known.get(fin, default) for fin in range(FIN_COUNT))
    return front_right, back_right, back_left, front_left


def _unmeasured(what: str, default: str) -> Result:
    return Result(
        what=what, expected="measured", measured=f"kept: {default}", verdict="note", advice="Not measured."
    )


def _along(axis: Axis, rate: tuple[float, float, float]) -> float:
    value = rate["xyz".index(axis[-1])]
    return -value if axis.startswith("-") else value


def _find(step: str, action: str) -> Action:
    for candidate in STEPS:
        for known in candidate.actions:
            if (candidate.name, known.name) == (step, action):
                return known
    raise RefusedError(f"The bring-up has no step {step!r} with the action {action!r}.")


def _read(action: Action, given: Mapping[str, Any]) -> dict[str, float | str]:
    read: dict[str, float | str] = {}
    for question in action.inputs:
        value = given.get(question.name)
        if value is None and question.optional:
            continue
        read[question.name] = (
            _read_choice(question, value) if question.choices else _read_number(question, value)
        )
    return read


def _read_choice(question: Question, value: object) -> str:
    if value not in question.choices:
        raise RefusedError(f"{question.label} must be one of {', '.join(question.choices)}.")
    return str(value)


def _read_number(question: Question, value: object) -> float:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not question.minimum <= value <= question.maximum:  # type: ignore[operator]
        raise RefusedError(
            f"{question.label} must be between {question.minimum:g} and {question.maximum:g} {question.unit}."
        )
    return float(value)  # type: ignore[arg-type]
