"""An emulated robot on a workbench, out of the water: a person's hands at it, and instruments beside it."""

import logging
import threading
from math import pi
from pathlib import Path
from random import Random
from types import TracebackType
from typing import Literal, Self

from robot_runtime.simulation.boards.emulator_process import STILL_WATER, BoardError, EmulatorClient
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion

log = logging.getLogger(__name__)

Pose = Literal["level", "nose_up", "right_down"]
Lamp = Literal["none", "right", "left"]

_GRAVITY = 9.80665
_FORCES: dict[Pose, tuple[float, float, float]] = {
    "level": (0.0, 0.0, -_GRAVITY),
    "nose_up": (_GRAVITY, 0.0, 0.0),
    "right_down": (0.0, -_GRAVITY, 0.0),
}
"""Specific force in body axes, m/s²: at rest it points up."""
_PRESSURE_PER_METRE = 9_810
"""Pa, of fresh water."""
_NOISE = 0.0006
"""rad/s, of an MPU-6050 behind its filter."""
PERIOD = 0.04
"""s between two changes of the IMU's noise; the bring-up's sketch reads it every 50 ms."""
FREE_SECONDS = 5.0
"""s within which the simulated water has let go of the board."""
BATTERY = 7.6
"""V at the battery's plug, as a multimeter shows it."""
BAROMETER = STILL_WATER.pressure
"""Pa, as a barometer beside the robot shows it."""
ALONG, TIP_DOWN = 0.0, pi / 2
"""Angles of a fin, rad: along its mount, and a quarter on, its tip down."""


class Workbench:
    """The surroundings of a robot on a workbench: how its hull lies, a bucket of water, and a lamp."""

    def __init__(self) -> None:
        self.pose: Pose = "level"
        self.depth = 0.0
        """m of water above the pressure sensor."""
        self.lamp: Lamp = "none"
        self.leak = False
        """True while the ends of the leak sensor are in water."""
        self._chance = Random(7)

    def read(self) -> Reading:
        """Return the surroundings of the robot's sensors now."""
        p, q, r = (self._chance.gauss(0, _NOISE) for _ in range(3))
        return STILL_WATER._replace(
            pressure=BAROMETER + self.depth * _PRESSURE_PER_METRE,
            force=_FORCES[self.pose],
            rate=(p, q, r),
            beacon_right=self.lamp == "right",
            beacon_left=self.lamp == "left",
            battery=BATTERY,
        )


class Hands:
    """A person's hands at an emulated board that runs in real time, and eyes on its fins.

    Entering takes the board out of the simulated water; it raises BoardError while the water has the board.
    The other methods may be called from any thread, and raise BoardError once it has ended.
    """

    def __init__(self, socket: Path) -> None:
        self.bench = Workbench()
        self._socket = socket
        self._lock = threading.Lock()
        self._fins = FinMotion.of([0.0] * 13)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="hands", daemon=True)

    def __enter__(self) -> Self:
        self._board = EmulatorClient(self._socket)
        for _ in range(round(FREE_SECONDS / PERIOD)):
            try:
                self._board.sense(self.bench.read())
                break
            except BoardError:
                self._over.wait(PERIOD)
        else:
            self._board.close()
            raise BoardError("the simulated water has not let go of the emulated board")
        self._fins = self._board.fins()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()
        self._board.close()

    @property
    def fins(self) -> FinMotion:
        """The motion of the fins."""
        return self._fins

    def turn(self, fin: int, angle: float) -> None:
        """Turn a fin to this angle (rad)."""
        with self._lock:
            self._board.turn(fin, angle)

    def wet(self, wet: bool) -> None:
        """Put the ends of the leak sensor into water, or dry them."""
        with self._lock:
            self._board.fault("leak", "wet" if wet else "none")
            self.bench.leak = wet

    def mend(self) -> None:
        """Mend every mistake of the board's wiring and its parts."""
        with self._lock:
            self._board.mistake("none")

    def _work(self) -> None:
        try:
            while not self._over.wait(PERIOD):
                with self._lock:
                    self._board.sense(self.bench.read())
                    self._fins = self._board.fins()
        except BoardError as problem:
            log.warning("nobody holds the emulated board any more: %s", problem)
