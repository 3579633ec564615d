"""A board with the bring-up's sketch in emulated time, and a person who does what each step asks."""

from collections.abc import Callable
from pathlib import Path

from robot_runtime.contract.packets import Calibration, Jog, Raw, RequestScan, Scan
from robot_runtime.control.fin_check import FINS
from robot_runtime.experiments.bring_up.bench import addresses
from robot_runtime.experiments.bring_up.guide import NO_FIN, STEPS
from robot_runtime.experiments.bring_up.procedure import BringUp
from robot_runtime.simulation.boards.mistakes import FINS as WRITTEN
from robot_runtime.simulation.boards.workbench import (
    ALONG,
    BAROMETER,
    BATTERY,
    TIP_DOWN,
    Lamp,
    Pose,
    Workbench,
)
from tests.board.host import BAUD, EmulatedHost, P, start
from tests.board.rig import BoardRig

POSES: tuple[Pose, ...] = ("level", "nose_up", "right_down")
NAMED = [
    ("strap-wrong:back-right", "devices", "answers at 0x62 instead"),
    ("strap-shared:front-right,back-left", "devices", "two bridges with the same straps"),
    ("imu-strap", "devices", "its strap AD0 must lie at its supply"),
    ("missing:imu", "devices", "Check the IMU's supply"),
    ("missing:pressure", "devices", "Check the pressure sensor's supply"),
    *((f"missing:bridge-{fin}", "devices", "Check this bridge's supply and straps") for fin in WRITTEN),
    ("imu-clone:0x55", "sensors", "Another chip answers there"),
    *((f"missing:encoder-{fin}", "sensors", "No encoder answers") for fin in WRITTEN),
    ("divider-wrong:3", "battery", "two equal resistors"),
    ("missing:battery", "battery", "two equal resistors"),
    ("encoders-swapped:front-right,back-left", "fin_0", "select lines of the front right and the back left"),
    ("encoders-swapped:front-right,back-left", "fin_2", "select lines of the back left and the front right"),
    ("encoders-swapped:front-right,back-left", "motor_0", "have swapped select lines"),
    (
        "motors-swapped:front-right,back-left",
        "motor_0",
        "motors of the front right and the back left fin are",
    ),
    ("strap-shared:front-right,back-left", "motor_2", "have the same straps"),
    ("missing:motor-front-left", "motor_3", "the motor at its bridge"),
    ("stiction:24", "motor_0", "loosen its shaft's seal"),
    ("beacons-swapped", "beacons", "The detectors are swapped"),
    ("missing:beacon-right", "beacons", "Does the lamp blink"),
]
"""Mistakes, a step that finds each, and words of its advice. A mistake's first step finds it first."""
SETTLE = 0.2
"""s that a person takes from a change to the press of a button, at least."""
HOLD = 0.1
"""s between two posts of a button that is held."""


class EmulatedBench:
    """The bench of `BringUp`, in emulated time."""

    def __init__(self, rig: BoardRig) -> None:
        self.host = EmulatedHost(rig, BAUD)
        self._marked = 0
        self.host.until(lambda: bool(self._all(Raw)), 3.0)

    def newest(self) -> Raw | None:
        return self._all(Raw)[-1]

    def readings(self, seconds: float) -> list[Raw]:
        self.mark()
        self.host.run(seconds)
        return self.since_mark()

    def mark(self) -> None:
        self._marked = len(self._all(Raw))

    def since_mark(self) -> list[Raw]:
        return self._all(Raw)[self._marked :]

    def scan(self) -> set[int]:
        before = len(self._all(Scan))
        self.host.say(RequestScan())
        self.host.until(lambda: len(self._all(Scan)) > before, 3.0)
        return addresses(self._all(Scan)[-1])

    def jog(self, fin: int, drive: int) -> None:
        self.host.say(Jog(fin=fin, drive=drive))

    def store(self, calibration: Calibration) -> Calibration:
        before = len(self._all(Calibration))
        self.host.say(calibration)
        self.host.until(lambda: len(self._all(Calibration)) > before, 3.0)
        return self._all(Calibration)[-1]

    def _all(self, kind: type[P]) -> list[P]:
        return [packet for _, packet in self.host.heard if isinstance(packet, kind)]


class Person:
    """Does what the steps ask, on a board with these mistakes, and says what can be seen."""

    def __init__(self, folder: Path, *mistakes: str) -> None:
        options = [word for mistake in mistakes for word in ("--mistake", mistake)]
        self.rig = start("bring_up", folder, "--uncalibrated", *options)
        self._table = Workbench()
        self.rig.board.attach(0.01, lambda _: self._table.read())
        self.bench = EmulatedBench(self.rig)
        self.work = BringUp(self.bench)

    def close(self) -> None:
        self.rig.__exit__()

    def everything(self) -> None:
        """All steps, in their order."""
        for step in STEPS:
            self.do(step.name)

    def do(self, step: str) -> None:
        """One step with all its actions, but for those that keep a default."""
        name, _, number = step.partition("_")
        steps: dict[str, Callable[[int], None]] = {
            "devices": lambda _: self.press("devices", "scan"),
            "sensors": lambda _: self.press("sensors", "look"),
            "battery": lambda _: self.press("battery", "compare", volts=BATTERY),
            "axes": lambda _: self.lay_down(),
            "gyro": lambda _: self.press("gyro", "rest"),
            "pressure": lambda _: self.press_deep(),
            "fin": self.turn_by_hand,
            "motor": self.hold,
            "beacons": lambda _: self.shine(),
            "leak": lambda _: self.wet(),
            "store": lambda _: self.press("store", "store"),
        }
        steps[name](int(number or 0))

    def press(self, step: str, action: str, **given: float | str) -> None:
        self.work.perform(step, action, given)

    def change(self, pose: Pose = "level", depth: float = 0.0, lamp: Lamp = "none") -> None:
        """Change what surrounds the board, and wait until it is so."""
        self._table.pose, self._table.depth, self._table.lamp = pose, depth, lamp
        self.bench.host.run(SETTLE)

    def lay_down(self) -> None:
        for pose in POSES:
            self.change(pose=pose)
            self.press("axes", pose)
        self.change()

    def press_deep(self) -> None:
        self.press("pressure", "air", barometer=BAROMETER / 100)
        self.change(depth=0.3)
        self.press("pressure", "bucket", depth=30)
        self.change()

    def turn_by_hand(self, fin: int) -> None:
        self.rig.board.turn(fin, ALONG)
        self.press(f"fin_{fin}", "along")
        self.rig.board.turn(fin, TIP_DOWN)
        self.press(f"fin_{fin}", "down")

    def hold(self, fin: int) -> None:
        before = self.rig.board.fins().angles
        for _ in range(3):
            self.press(f"motor_{fin}", "turn", on=1)
            self.bench.host.run(HOLD)
        turned = [abs(after - then) for then, after in zip(before, self.rig.board.fins().angles, strict=True)]
        self.press(f"motor_{fin}", "turn", stop=1)
        seen = FINS[turned.index(max(turned))] if max(turned) > 0.1 else NO_FIN
        self.press(f"motor_{fin}", "seen", fin=seen)
        self.bench.host.run(0.5)

    def shine(self) -> None:
        self.press("beacons", "dark")
        self.change(lamp="right")
        self.press("beacons", "right")
        self.change(lamp="left")
        self.press("beacons", "left")
        self.change()

    def wet(self) -> None:
        self.rig.board.fault("leak", "wet")
        self.bench.host.run(SETTLE)
        self.press("leak", "wet")
        self.rig.board.fault("leak", "none")
        self.bench.host.run(SETTLE)
        self.press("leak", "dry")

    def advice(self, step: str) -> str:
        """Return all advice of a step."""
        return " ".join(result.advice for result in self.work.results(step))
