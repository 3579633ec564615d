"""The readings that missions use: depth, attitude, way, light, battery and camera."""

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Detection
from robot_runtime.contract.packets import Beacon
from robot_runtime.contract.topics import BEACON, DETECTION
from robot_runtime.control.battery import MEASURED
from robot_runtime.control.fault_detector import FaultDetector
from robot_runtime.control.node import BEACON_STALE, VISION_STALE, ControlNode
from robot_runtime.missions.sights import LIGHT, find_sight_problem
from robot_runtime.transport.bus import Bus
from robot_runtime.vision.interface import Vision


class MissionSenses:
    """The newest readings. The bus fills it from any thread."""

    def __init__(
        self, bus: Bus, clock: Clock, control: ControlNode, detector: FaultDetector, vision: Vision
    ) -> None:
        self.control = control
        self._clock = clock
        self._detector = detector
        self._vision = vision
        self._detection: Detection | None = None
        self._light = (float("-inf"), False)
        bus.on_row(BEACON, self._take_beacon)
        bus.on_document(DETECTION, self._take_detection)

    @property
    def depth(self) -> float:
        """The depth, m."""
        return self.control.depth.measured or 0.0

    @property
    def heading(self) -> float:
        """The heading, rad."""
        return self.control.heading.measured or 0.0

    @property
    def way(self) -> tuple[float, float]:
        """The way since arming by dead reckoning, m along headings 0 and 90°."""
        return self.control.dead_reckoning.way

    @property
    def battery(self) -> float | None:
        """The battery's voltage, V; None where it is not measured."""
        status = self._detector.status
        return status.battery if status is not None and status.battery >= MEASURED else None

    @property
    def battery_left(self) -> float | None:
        """The time until the low-battery alarm, s; None where it cannot be estimated."""
        return self.control.battery.left

    @property
    def light(self) -> bool:
        """True while a detector sees the light."""
        time, seen = self._light
        return seen and self._clock.now() - time <= BEACON_STALE

    def sees(self, what: str) -> bool:
        """Return True if a fresh picture confirms this colour or marker, or a detector sees the light."""
        if what == LIGHT:
            return self.light
        seen = self._detection
        if seen is None or self._clock.now() - seen.taken > VISION_STALE:
            return False
        return what in seen.confirmed

    def check_sight(self, what: str) -> str:
        """Return the reason why this cannot be seen; empty if it can."""
        return find_sight_problem(what, self._vision.settings)

    def _take_beacon(self, time: float, record: bytes) -> None:
        seen = Beacon.from_bytes(record)
        self._light = time, bool(seen.right or seen.left)

    def _take_detection(self, detection: Detection) -> None:
        self._detection = detection
