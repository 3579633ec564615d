"""The control node: depth, beacons and vision in, navigation commands out, once a tick."""

from collections.abc import Callable

from robot_runtime.bus import Bus
from robot_runtime.clock import Clock
from robot_runtime.config import SET_POINT
from robot_runtime.control.controllers import CONTROLLERS, Controller
from robot_runtime.control.faults import BY_NAME, LOOK
from robot_runtime.control.steering import STEERINGS, BeaconSteering
from robot_runtime.errors import Refused
from robot_runtime.packets import Beacon, Depth, Navigation
from robot_runtime.samples import Control, Detection, Document, Event, Steering

BEACON_STALE = 0.5
"""s after which what the beacon detectors saw no longer counts."""
VISION_STALE = BY_NAME["vision_stale"].limit - LOOK
"""s after which, at a tick, what the vision node saw no longer counts."""


class ControlNode:
    """Holds the depth: the default set point, or another while something is seen that there is one for.

    Meanwhile it may steer towards a light beacon.

    `send` takes the command to the board. `tick` belongs to the control loop; the rest may be called from any
    thread, since each change is one assignment that the next tick picks up.
    """

    def __init__(self, bus: Bus, clock: Clock, send: Callable[[Navigation], None]) -> None:
        self.controllers = {cls.name: cls() for cls in CONTROLLERS}
        self.controller: Controller = self.controllers[CONTROLLERS[0].name]
        self.set_point_default = 0.5
        self.set_point_detected = 1.0
        self.steering: Steering = "none"
        self.colour = ""
        self.set_point = self.set_point_default
        self._bus = bus
        self._clock = clock
        self._send = send
        self._depth: tuple[float, float] | None = None
        self._sight: Detection | None = None
        self._used: Detection | None = None
        self.picture_age: float | None = None
        """s; of the last picture that a tick used, when it did first."""
        self._ticked: float | None = None
        self._towards_light = BeaconSteering()
        self._lights = (float("-inf"), False, False)
        bus.on_row("depth", self._take_depth)
        bus.on_row("beacon", self._take_beacon)
        bus.on_document("detection", self._take_detection)

    def choose(self, name: str, gains: dict[str, float] | None = None) -> None:
        """Take another controller, or other gains. Raises Refused where either is unknown or out of range."""
        controller = self.controllers.get(name)
        if controller is None:
            raise Refused(f"there is no controller {name!r}; there are {', '.join(self.controllers)}")
        try:
            controller.tune(gains or {})
        except ValueError as problem:
            raise Refused(str(problem)) from problem
        if controller is not self.controller:
            controller.start()
            self.controller = controller
            self._tell("controller", f"Controller: {controller.title}.")

    def set_points(self, default: float, detected: float) -> None:
        """Set both wanted depths, m. Raises Refused where one is not between 0 and 10."""
        low, high = SET_POINT.minimum, SET_POINT.maximum
        for depth in (default, detected):
            if not low <= depth <= high:
                raise Refused(f"a set point of {depth} m is not between {low:g} and {high:g} m")
        self.set_point_default, self.set_point_detected = default, detected

    def steer(self, by: str) -> None:
        """Stay, or swim towards a light beacon. Raises Refused where there is no such steering."""
        for one in STEERINGS:
            if one == by:
                self.steering = one
                return
        raise Refused(f"there is no steering {by!r}; there are {', '.join(STEERINGS)}")

    def tick(self, armed: bool) -> None:
        """Decide, and send the command where the robot is armed and steers itself."""
        now = self._clock.now()
        self._choose_set_point(now)
        if self._depth is None:
            return
        time, depth = self._depth
        if armed and self._ticked is None:
            self.controller.start()
            self._towards_light.start()
        seconds = now - (self._ticked or now)
        output = self.controller.step(self.set_point, depth, seconds) if armed else 0.0
        self._ticked = now if armed else None
        if armed:
            surge, yaw = self._course(now, seconds)
            self.command(Navigation(x=surge, y=0.0, z=output, roll=0.0, pitch=0.0, yaw=yaw))
        error = self.set_point - depth
        tick = Control(set_point=self.set_point, depth=depth, error=error, output=output, latency=now - time)
        self._bus.publish_row("control", now, tick.to_bytes())

    def command(self, command: Navigation) -> None:
        """Send a command to the board, and tell what it was."""
        self._send(command)
        self._bus.publish_row("navigation", self._clock.now(), command.to_bytes())

    def _course(self, now: float, seconds: float) -> tuple[float, float]:
        if self.steering == "none":
            return 0.0, 0.0
        time, right, left = self._lights
        fresh = now - time <= BEACON_STALE
        return self._towards_light.step(fresh and right, fresh and left, seconds)

    def _choose_set_point(self, now: float) -> None:
        wanted, because = self.set_point_default, ""
        sight = self._sight
        if sight is not None and now - sight.taken <= VISION_STALE:
            if sight.set_point is not None:
                wanted, because = sight.set_point, f": {sight.target} is seen"
            elif sight.colour == self.colour:
                wanted, because = self.set_point_detected, f": {self.colour} is seen"
        if sight is not None and sight is not self._used:
            self._used, self.picture_age = sight, now - sight.taken
        if wanted != self.set_point:
            self.set_point = wanted
            self._tell("set_point", f"Set point {wanted:.2f} m{because}.")

    def _take_depth(self, _: str, time: float, record: bytes) -> None:
        self._depth = (time, Depth.from_bytes(record).depth)

    def _take_beacon(self, _: str, time: float, record: bytes) -> None:
        seen = Beacon.from_bytes(record)
        self._lights = (time, bool(seen.right), bool(seen.left))

    def _take_detection(self, _: str, document: Document) -> None:
        if isinstance(document, Detection):
            self._sight = document

    def _tell(self, kind: str, text: str) -> None:
        event = Event(time=self._clock.now(), kind=kind, severity="info", text=text)
        self._bus.publish_document("event", event)
