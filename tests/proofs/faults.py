"""Injects each fault repeatedly: time until the alarm, and until the fins stop.

The compiled firmware on the emulated chip, the whole runtime and the water, in simulated time: times are what
a real robot's would be, whatever the computer does. `tests.proofs.outages` has the processes' faults.
"""

import random
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import acos, inf
from pathlib import Path

from robot_runtime.config import LinkConfig
from robot_runtime.contract.documents import Mode
from robot_runtime.control.fault_detector import TILT_MAX, TOO_DEEP
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.boards import BUILD
from robot_runtime.experiments.scenario.run import PRELUDE
from robot_runtime.simulation.boards.emulated_board import EmulatedBoard
from robot_runtime.simulation.boards.emulator_process import Water
from robot_runtime.simulation.boards.firmware import firmware_path
from robot_runtime.simulation.boards.stepped_board import PERIOD, SteppedBoard
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion
from robot_runtime.vision.camera import CameraError, CameraFrame
from tests.proofs.pool import processes
from tests.proofs.watching import WatchedMotions
from tests.runtime.control.flight import Flight

HEARTBEAT = 4.0
"""s, as the server has the runtime started."""
NEUTRAL, DISARMED = 0.5, 1.0
"""s after which the chip alone has brought the fins to rest, and disarmed."""
TICK = 0.015
"""s: the chip looks every 10 ms, and the fins are looked at every 5."""
SWIM_MIN, SWIM_MAX = 1.0, 2.0
"""s of swimming before the fault."""
LOWERING = 1.5
"""s at most for which the motors keep their power after a low battery, to turn the fins down."""
AFTER = 2.0
"""s for which it is watched afterwards; the chip needs less for anything."""
CALM = 60.0
"""s within which all is well again."""
SKETCH_FAILS_AFTER = 2.0
"""s after arming at which `tests/firmware/hang` hangs, and `tests/firmware/full` has filled its memory."""
_TRIM = {"forward": 0.0, "right": 0.0}
_SOUND = _TRIM | {"buoyancy": 1.003, "above": 0.01}
_HEAVY = _TRIM | {"buoyancy": 0.99, "above": 0.01}
_TOP_HEAVY = _TRIM | {"buoyancy": 1.003, "above": -0.03}


class FaultySwim(Flight):
    """A flight on the emulated board; the fins are read every 5 ms."""

    def __init__(self, elf: str = "robot", more: str = "") -> None:
        self.moved = self.powered = self.switched_on = -inf
        """s; when the fins moved last, when the motors had power last, and when they got it."""
        self._readings = 0
        self._motion = WatchedMotions()
        path = firmware_path(BUILD, LinkConfig().baud, ".elf").with_name(f"{elf}.elf")
        super().__init__(partial(self._make, path), more)
        self.supervisor._heartbeat = HEARTBEAT

    def reported_at(self, fault: str, since: float) -> float | None:
        """Time of this fault's first alarm since then, s; None without one."""
        for event in self.events:
            if event.kind == fault and event.time >= since:
                time: float = event.time
                return time
        return None

    def tilt(self) -> float:
        """Tilt of the simulated hull, rad."""
        _, x, y, _ = self.stage.simulator.truth().attitude
        return acos(max(1 - 2 * (x * x + y * y), -1.0))

    def calm(self, mode: Mode) -> None:
        """Wait until all is well, then arm."""
        self.supervisor.stop("The next one.")
        self.until(lambda: not any(alarm.active for alarm in self.supervisor.alarms), CALM)
        self.supervisor.acknowledge()
        self.until(lambda: not self.supervisor.refusals(), CALM)
        self.sticks = [0.5, 0.0, 0.0, 0.0, 0.0, 0.5] if mode == "manual" else None
        self.run(0.2)
        self.arm(mode)

    def _make(self, path: Path, water: Water) -> SteppedBoard:
        def feel(fins: FinMotion) -> Reading:
            self._readings += 1
            now = self._readings * PERIOD - PRELUDE
            if self._motion.see(now, fins):
                self.moved = now
            if fins.powered:
                if now - self.powered > 2 * PERIOD:
                    self.switched_on = now
                self.powered = now
            return water(fins)

        return EmulatedBoard(BUILD / "board", path, feel)


Wrong = Generator[float, None, None]
"""Does something wrong, yields since when it is (s), and mends it."""


def _broken(sensor: str, kind: str, **more: float) -> Callable[[FaultySwim], Wrong]:
    def wrong(swim: FaultySwim) -> Wrong:
        swim.break_(sensor, kind, **more)
        yield swim.now
        swim.break_(sensor, "none")

    return wrong


def _cut(*ways: str) -> Callable[[FaultySwim], Wrong]:
    def wrong(swim: FaultySwim) -> Wrong:
        for way in ways:
            swim.board.line(f"line {way} cut on")
        yield swim.now
        for way in ways:
            swim.board.line(f"line {way} cut off")

    return wrong


def _no_pilot(swim: FaultySwim) -> Wrong:
    swim.sticks = None
    yield swim.supervisor.pilot.taken


def _no_server(swim: FaultySwim) -> Wrong:
    swim.server = False
    yield swim.now
    swim.server = True


def _nobody_watches(swim: FaultySwim) -> Wrong:
    swim.watched = False
    yield swim.now
    swim.watched = True


def _reset(swim: FaultySwim) -> Wrong:
    swim.board.reset()
    yield swim.now


def _leak(swim: FaultySwim) -> Wrong:
    swim.board.fault("leak", "wet")
    yield swim.now


def _faulty_sketch(swim: FaultySwim) -> Wrong:
    began = swim.switched_on + SKETCH_FAILS_AFTER
    swim.run(began - swim.now)
    yield began


def _capsize(swim: FaultySwim) -> Wrong:
    swim.water("trim", **_TOP_HEAVY)
    swim.until(lambda: swim.tilt() > TILT_MAX, CALM)
    yield swim.now
    swim.water("trim", **_SOUND)
    swim.until(lambda: swim.tilt() < 0.2, CALM)


def _held_down(swim: FaultySwim) -> Wrong:
    swim.run(8.0)
    swim.water("trim", **_HEAVY)
    swim.supervisor.stop("Stopped.")
    yield swim.now
    swim.water("trim", **_SOUND)


def _no_picture(swim: FaultySwim) -> Wrong:
    camera, taken = swim.stage._camera, swim.supervisor.detector._vision
    assert camera is not None
    assert taken is not None

    def fail() -> CameraFrame:
        raise CameraError("it was taken away")

    camera.read = fail  # type: ignore[method-assign]
    yield taken
    del camera.read


def _sinking(swim: FaultySwim) -> Wrong:
    # Of the readings alone: the water of this scene is not deep enough.
    swim.break_("pressure", "drift", speed=50_000.0)
    detector = swim.supervisor.detector
    swim.until(lambda: detector._depth > detector._deepest + TOO_DEEP, CALM)
    yield detector._shallow
    swim.break_("pressure", "none")


def _empty(swim: FaultySwim) -> Wrong:
    # The water reports the battery from time 0 on; before, it was full.
    yield 0.0
    assert swim.now < 2 * ROBOT_FAULTS["battery_low"].limit


@dataclass(frozen=True, kw_only=True)
class Row:
    """A fault with its limits in s: until the alarm, until the fins rest, until the motors lose power."""

    name: str
    wrong: Callable[[FaultySwim], Wrong]
    fault: str
    """The alarm by which it is told."""
    reported: float
    rest: float | None = None
    off: float | None = None
    mode: Mode = "automatic"
    elf: str = "robot"
    more: str = ""
    once: bool = False
    """True if it cannot be repaired: each injection then takes its own board."""


def _all_stop(
    fault: str, wrong: Callable[[FaultySwim], Wrong], later: float = 0.0, **more: bool | str
) -> Row:
    """Return the allowed delay (s) of the motors' loss of power after the alarm."""
    limit = ROBOT_FAULTS[fault].limit
    return Row(name=fault, wrong=wrong, fault=fault, reported=limit, off=limit + later, **more)  # type: ignore[arg-type]


ROWS = (
    Row(name="pilot_quiet", wrong=_no_pilot, fault="pilot_quiet", reported=0.5, rest=0.5, mode="manual"),
    _all_stop("pilot_lost", _no_pilot, mode="manual"),
    _all_stop("server_silent", _no_server),
    Row(
        name="pi_silent",
        wrong=_cut("to_board"),
        fault="board_disarmed",
        reported=1.2,
        rest=NEUTRAL,
        off=DISARMED + TICK,
    ),
    Row(
        name="line_cut",
        wrong=_cut("to_board", "from_board"),
        fault="board_silent",
        reported=1.0,
        rest=NEUTRAL,
        off=DISARMED + TICK,
    ),
    _all_stop("unwatched", _nobody_watches),
    _all_stop("board_silent", _cut("from_board")),
    Row(
        name="loop_hung",
        wrong=_faulty_sketch,
        fault="board_restarted",
        reported=1.0,
        off=0.5,
        elf="robot_hang",
    ),
    Row(name="board_restarted", wrong=_reset, fault="board_restarted", reported=1.0, off=TICK),
    _all_stop("depth_stale", _broken("pressure", "bus")),
    _all_stop("depth_frozen", _broken("pressure", "stuck")),
    _all_stop("depth_range", _broken("pressure", "spike", share=1.0, size=300_000.0)),
    _all_stop("too_deep", _sinking),
    _all_stop("imu_stale", _broken("gyroscope", "bus")),
    _all_stop("imu_frozen", _broken("gyroscope", "stuck")),
    _all_stop("capsized", _capsize),
    Row(
        name="vision_stale",
        wrong=_no_picture,
        fault="vision_stale",
        reported=1.0,
        more='[vision]\ncamera = "card"\nrate = 4.0',
    ),
    Row(name="not_rising", wrong=_held_down, fault="not_rising", reported=20.0),
    _all_stop("battery_low", _empty, LOWERING, once=True, more="[robot]\nbattery_full = 6.19"),
    Row(name="leak", wrong=_leak, fault="leak", reported=0.5, off=0.3, once=True),
    _all_stop("memory_low", _faulty_sketch, once=True, elf="robot_full"),
    Row(name="fin_failing", wrong=_broken("encoder2", "bus"), fault="fin_failing", reported=0.5),
)
BY_ROW = {row.name: row for row in ROWS}


@dataclass
class Measured:
    """The times of each injection of a fault, in s after it, and the problems."""

    reported: list[float] = field(default_factory=list)
    rest: list[float] = field(default_factory=list)
    off: list[float] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def measure(row: Row, times: int, seed: int) -> Measured:
    """Inject the fault repeatedly, each time at a random moment of swimming."""
    chance = random.Random(f"{row.name} {seed}")
    measured = Measured()
    while len(measured.reported) < times:
        with FaultySwim(row.elf, row.more) as swim:
            swim._performance._has_camera = "camera" in row.more
            for _ in range(1 if row.once else times):
                _inject(swim, row, chance, measured)
    return measured


def measure_all(times: int, seed: int, rows: Sequence[Row] = ROWS, workers: int = 2) -> dict[str, Measured]:
    """Measure all faults, some in parallel."""
    with processes(workers) as pool:
        parts = {row.name: pool.submit(measure_named, row.name, times, seed) for row in rows}
        return {name: part.result() for name, part in parts.items()}


def measure_named(name: str, times: int, seed: int) -> Measured:
    """Measure the fault of this name."""
    return measure(BY_ROW[name], times, seed)


def table(measured: dict[str, Measured]) -> str:
    """Describe the times in ms, for a person."""
    lines = [
        f"{'fault':<18}{'n':>5}{'told':>9}{'limit':>7}{'at rest':>9}{'limit':>7}{'no power':>10}{'limit':>7}"
    ]
    for name, outcome in measured.items():
        row = BY_ROW[name]
        lines.append(
            f"{name:<18}{len(outcome.reported):>5}{_ms(max(outcome.reported)):>9}{_ms(row.reported):>7}"
            f"{_longest(outcome.rest):>9}{_ms(row.rest):>7}{_longest(outcome.off):>10}{_ms(row.off):>7}"
        )
    return "\n".join([*lines, *(problem for outcome in measured.values() for problem in outcome.problems)])


def _inject(swim: FaultySwim, row: Row, chance: random.Random, measured: Measured) -> None:
    swim.calm(row.mode)
    swim.run(round(chance.uniform(SWIM_MIN, SWIM_MAX), 3))
    wrong = row.wrong(swim)
    since = next(wrong)
    swim.until(lambda: swim.reported_at(row.fault, since) is not None, row.reported + AFTER)
    swim.run(AFTER)
    report = swim.reported_at(row.fault, since)
    assert report is not None
    measured.reported.append(report - since)
    _judge(measured, row, "told", report - since, row.reported)
    if row.rest is not None:
        measured.rest.append(swim.moved - since)
        _judge(measured, row, "rest", swim.moved - since, row.rest)
    if row.off is not None:
        measured.off.append(swim.powered - since)
        _judge(measured, row, "off", swim.powered - since, row.off)
        try:
            swim.supervisor.begin_arming(row.mode)
        except RefusedError:
            pass
        else:
            measured.problems.append(f"{row.name}: it could be armed before anybody acknowledged")
    next(wrong, None)


def _judge(measured: Measured, row: Row, what: str, took: float, limit: float) -> None:
    if took > limit + 1e-9:
        measured.problems.append(f"{row.name}: {what} after {took:.3f} s, of which {limit:g} are allowed")


def _longest(times: list[float]) -> str:
    return _ms(max(times)) if times else ""


def _ms(seconds: float | None) -> str:
    return "" if seconds is None else f"{1000 * seconds:.0f}"
