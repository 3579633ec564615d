"""A board with the bring-up's sketch in emulated time, and a person who does what each step asks."""

from collections.abc import Callable
from math import pi
from pathlib import Path
from random import Random
from typing import Any

from robot_runtime.contract.packets import Calibration, Jog, Raw, RequestScan, Scan
from robot_runtime.control.fin_check import FINS
from robot_runtime.experiments.bring_up.bench import addresses
from robot_runtime.experiments.bring_up.guide import NO_FIN, STEPS
from robot_runtime.experiments.bring_up.procedure import BringUp
from robot_runtime.simulation.boards.emulator_process import STILL_WATER
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion
from tests.board.host import BAUD, Host, P, start
from tests.board.rig import Rig

GRAVITY = 9.80665
NOISE = 0.0006
"""rad/s, of an MPU-6050 behind its filter."""
POSES = {
    "level": (0.0, 0.0, -GRAVITY),
    "nose_up": (GRAVITY, 0.0, 0.0),
    "right_down": (0.0, -GRAVITY, 0.0),
}
SETTLE = 0.2
"""s that a person takes from a change to the press of a button, at least."""
HOLD = 0.1
"""s between two posts of a button that is held."""


class EmulatedBench:
    """The bench of `BringUp`, in emulated time."""

    def __init__(self, rig: Rig) -> None:
        self.host = Host(rig, BAUD)
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
        self._water = STILL_WATER._replace(battery=7.6, beacon_right=False, beacon_left=False)
        self._chance = Random(7)
        self.rig.board.attach(0.01, self._give)
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
            "battery": lambda _: self.press("battery", "compare", volts=7.6),
            "axes": lambda _: self.lay_down(),
            "gyro": lambda _: self.press("gyro", "rest"),
            "pressure": lambda _: self.press_deep(),
            "fin": self.turn_by_hand,
            "motor": self.hold,
            "beacons": lambda _: self.shine(),
            "store": lambda _: self.press("store", "store"),
        }
        steps[name](int(number or 0))

    def press(self, step: str, action: str, **given: float | str) -> None:
        self.work.perform(step, action, given)

    def change(self, **surroundings: Any) -> None:
        """Change what surrounds the board, and wait until it is so."""
        self._water = self._water._replace(**surroundings)
        self.bench.host.run(SETTLE)

    def lay_down(self) -> None:
        for pose, force in POSES.items():
            self.change(force=force)
            self.press("axes", pose)
        self.change(force=POSES["level"])

    def press_deep(self) -> None:
        air = self._water.pressure
        self.press("pressure", "air", barometer=air / 100)
        self.change(pressure=air + 0.3 * 9810)
        self.press("pressure", "bucket", depth=30)
        self.change(pressure=air)

    def turn_by_hand(self, fin: int) -> None:
        self.rig.board.turn(fin, 0.0)
        self.press(f"fin_{fin}", "along")
        self.rig.board.turn(fin, pi / 2)
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
        self.change(beacon_right=True)
        self.press("beacons", "right")
        self.change(beacon_right=False, beacon_left=True)
        self.press("beacons", "left")
        self.change(beacon_left=False)

    def advice(self, step: str) -> str:
        """All advice of a step."""
        return " ".join(result.advice for result in self.work.results(step))

    def _give(self, _: FinMotion) -> Reading:
        x, y, z = (self._chance.gauss(0, NOISE) for _ in range(3))
        return self._water._replace(rate=(x, y, z))
