"""The control node: depth, attitude, beacons and vision in, navigation commands out, once a tick."""

import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import nan
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import (
    Control,
    Detection,
    Event,
    Mode,
    Severity,
    Steering,
    Turning,
)
from robot_runtime.contract.limits import SET_POINT, Range
from robot_runtime.contract.packets import Beacon, Countdown, Depth, Imu, Navigation
from robot_runtime.contract.topics import BEACON, CONTROL, DEPTH, DETECTION, EVENT, IMU, NAVIGATION, TURNING
from robot_runtime.control.attitude import euler_angles, heave_acceleration
from robot_runtime.control.battery import BatteryGauge
from robot_runtime.control.dead_reckoning import DeadReckoning
from robot_runtime.control.faults import CHECK_PERIOD, ROBOT_FAULTS
from robot_runtime.control.loop import ControlLoop
from robot_runtime.control.pilot import AXES, NEUTRAL, Pilot
from robot_runtime.control.steering import STEERINGS, BeaconSteering
from robot_runtime.errors import RefusedError
from robot_runtime.transport.bus import Bus

BEACON_STALE = 0.5
"""s after which a reading of the beacon detectors is too old to use."""
VISION_STALE = ROBOT_FAULTS["vision_stale"].limit - CHECK_PERIOD
"""s after which, at a tick, a detection is too old to use."""
STICK_MIDDLE = 0.05
"""Share of its travel within which a stick counts as centred."""


@dataclass(frozen=True, slots=True)
class Course:
    """A course that overrides the chosen steering until a time (s): surge and yaw, or to the light.

    It overrides an active heading hold, too. Once it has expired the robot stays where it is. A `still` one
    keeps every loop from steering, the depth's too: the fins rest until another course replaces it. Until
    then the LED shows the `countdown`, s, if there is one.
    """

    until: float
    x: float = 0.0
    yaw: float = 0.0
    by: Steering = "none"
    still: bool = False
    countdown: float | None = None


_DEPTHS_MAX, _IMUS_MAX = 50, 100
"""As many as arrive in a second, the longest time between two ticks."""


class ControlNode:
    """The control loops: all of them in automatic, in manual those that hold an axis.

    In automatic the depth is always held: at the default set point, or at the one of what the camera detects.
    Meanwhile the robot may swim towards a light beacon.

    `send` takes the commands to the board. `tick` belongs to the control loop; the rest may be called from
    any thread. Changes under `tick_lock` take effect between two ticks. No set point is below `deepest`, m.
    """

    def __init__(
        self,
        bus: Bus,
        clock: Clock,
        send: Callable[[Navigation | Countdown], object],
        pilot: Pilot,
        deepest: float = SET_POINT.maximum,
    ) -> None:
        self.deepest = deepest
        self.dead_reckoning = DeadReckoning(bus, clock)
        self.battery = BatteryGauge(bus)
        self.depth, self.heading = ControlLoop("depth", "z"), ControlLoop("heading", "yaw")
        self.depth.limits = Range(SET_POINT.minimum, deepest)
        self.attitude_loops = (self.heading, ControlLoop("pitch", "pitch"), ControlLoop("roll", "roll"))
        self.loops: dict[str, ControlLoop] = {loop.name: loop for loop in (self.depth, *self.attitude_loops)}
        self.tick_lock = threading.RLock()
        self.mode: Mode = "disarmed"
        self.set_point_default = 0.5
        self.set_point_detected = 1.0
        self.steering: Steering = "none"
        self.colour = ""
        self.depth.set_point = self.set_point_default
        self._announced_set_point = self.set_point_default
        self._bus = bus
        self._clock = clock
        self._send = send
        self._pilot = pilot
        self._sending = threading.Lock()
        self._depths: deque[tuple[float, bytes]] = deque(maxlen=_DEPTHS_MAX)
        self._depth_taken: float | None = None
        self._imu: bytes | None = None
        self._imus: deque[bytes] = deque(maxlen=_IMUS_MAX)
        self._detection: Detection | None = None
        self._used_detection: Detection | None = None
        self.picture_age: float | None = None
        """s; age of the last picture at the first tick that used it."""
        self._ticked: float | None = None
        self._beacon_steering = BeaconSteering()
        self._course = (0.0, 0.0)
        self._course_override: Course | None = None
        self._beacons = (float("-inf"), False, False)
        bus.on_row(DEPTH, self._take_depth)
        bus.on_row(IMU, self._take_imu)
        bus.on_row(BEACON, self._take_beacon)
        bus.on_document(DETECTION, self._take_detection)

    @property
    def newest_depth(self) -> float | None:
        """The time at which the newest depth was taken, s; None before the first. The caller ticks."""
        return self._depths[-1][0] if self._depths else self._depth_taken

    def change_mode(self, mode: Mode) -> None:
        """Set the robot's mode. It never blocks, because a STOP takes this way, too."""
        was, self.mode = self.mode, mode
        self.dead_reckoning.change_mode(mode)
        for loop in self.loops.values():
            if "manual" in (was, mode):
                loop.on = False
            loop.override = None
        self._course_override = None

    def override_course(self, course: Course | None) -> None:
        """Steer this course in automatic until it expires or the mode changes; None: the chosen one."""
        was, self._course_override = self._course_override, course
        if course is not None and course.by == "beacons" and (was is None or was.by != "beacons"):
            self._beacon_steering.start()

    def set_loop(
        self,
        name: str,
        *,
        on: bool | None = None,
        set_point: float | None = None,
        controller: str | None = None,
        gains: Mapping[str, Any] | None = None,
    ) -> None:
        """Change a loop, or nothing if that raises RefusedError. `gains` are those of the named controller.

        A hold that is switched on in manual holds the measured value. While the depth is held in manual, its
        set point is that of the hold, otherwise the default one.
        """
        with self.tick_lock:
            loop = self._find(name)
            chosen = loop.controller if controller is None else loop.find(controller)
            try:
                chosen.check(gains or {})
            except ValueError as problem:
                raise RefusedError(str(problem)) from problem
            if set_point is not None:
                loop.check(set_point)
            if on:
                self._check_on(loop)
            chosen.tune(gains or {})
            if chosen is not loop.controller:
                loop.controller = chosen
                whose = "Controller" if loop is self.depth else f"{loop.title} controller"
                self._publish_event("controller", f"{whose}: {chosen.title}.")
            if on and not loop.on and self.mode == "manual":
                loop.follow()
            holds_depth = self.mode == "manual" and (loop.on if on is None else on)
            if set_point is not None and loop is self.depth and not holds_depth:
                self.set_points(set_point, self.set_point_detected)
            elif set_point is not None:
                loop.set_point = set_point
            if on is not None and on != loop.on:
                loop.on = on
                change = f"held at {loop.describe(loop.set_point)}" if on else "no longer held"
                self._publish_event("loop", f"{loop.title} {change}.")

    def release(self, loop: ControlLoop, reason: str) -> None:
        """Switch off the hold of a loop that cannot be controlled any more."""
        if loop.on:
            loop.on = False
            self._publish_event("loop", f"{loop.title} no longer held. {reason}", "caution")

    def set_points(self, default: float, detected: float) -> None:
        """Set both set points of the depth, m. Raise RefusedError for a new one below the greatest depth."""
        for depth, now in ((default, self.set_point_default), (detected, self.set_point_detected)):
            if depth != now:
                self.depth.check(depth)
        self.set_point_default, self.set_point_detected = default, detected

    def steer(self, by: str) -> None:
        """Choose the steering in automatic. Raise RefusedError if there is no such steering."""
        for steering in STEERINGS:
            if steering == by:
                self.steering = steering
                return
        raise RefusedError(f"there is no steering {by!r}; there are {', '.join(STEERINGS)}")

    def tick(self) -> None:
        """Step the loops and send the command if the robot is steered. The caller holds `tick_lock`."""
        now, mode = self._clock.now(), self.mode
        taken = self._measure()
        self.dead_reckoning.tick(mode)
        self._choose_set_point(now, mode)
        steered = mode == "manual" or (mode == "automatic" and taken is not None)
        if steered and self._ticked is None:
            self._beacon_steering.start()
        seconds = now - (self._ticked or now)
        self._ticked = now if steered else None
        self._step_loops(mode if steered else "disarmed", seconds)
        if steered:
            self._course = self._find_course(now, seconds)
            self._send_newest(mode)
            self._count_down(now)
        self._publish(now, taken)

    def drive(self) -> None:
        """Send the pilot's newest input with the outputs of the holds; the loops do not step."""
        if self.mode == "manual":
            self._send_newest("manual")

    def command(self, command: Navigation) -> None:
        """Send a command to the board and publish it."""
        self._send(command)
        self._bus.publish_row(NAVIGATION, self._clock.now(), command.to_bytes())

    def _send_newest(self, mode: Mode) -> None:
        # One at a time, so that no older input is sent after a newer one.
        with self._sending:
            self.command(Navigation(**self._axes(mode)))

    def _count_down(self, now: float) -> None:
        course = self._course_override
        if course is not None and course.countdown is not None and now <= course.until:
            self._send(Countdown(remaining=course.countdown))

    def _axes(self, mode: Mode) -> dict[str, float]:
        if mode == "automatic":
            axes = dict.fromkeys(AXES, 0.0)
            axes["x"], axes["yaw"] = self._course
        else:
            pilot = self._pilot.command()
            axes = {name: getattr(pilot, name) for name in AXES}
            if self._pilot.quiet:
                return axes
        for loop in self.loops.values():
            if loop.output is not None and (mode == "automatic" or abs(axes[loop.axis]) <= STICK_MIDDLE):
                axes[loop.axis] = loop.output
        return axes

    def _step_loops(self, mode: Mode, seconds: float) -> None:
        pilot = self._pilot.command() if mode == "manual" else NEUTRAL
        for loop in self.loops.values():
            pushed = loop.on and abs(getattr(pilot, loop.axis)) > STICK_MIDDLE
            if pushed:
                loop.follow()
            if loop.measured is not None and not pushed and self._steers(loop, mode):
                depth = self.depth.output
                loop.step(seconds, pilot.z if depth is None else depth)
            else:
                loop.rest()

    def _steers(self, loop: ControlLoop, mode: Mode) -> bool:
        if mode == "manual":
            return loop.on and not self._pilot.quiet
        if mode != "automatic":
            return False
        if self._course_override is not None and self._course_override.still:
            return False
        if loop is self.heading and self._steering_in_force == "beacons":
            return False
        if loop is self.heading and self._course_override is not None:
            # A mission holds a heading by overriding the loop; otherwise its course has the yaw.
            return loop.override is not None
        return loop is self.depth or loop.on or loop.override is not None

    def _check_on(self, loop: ControlLoop) -> None:
        if loop is self.depth and self.mode != "manual":
            raise RefusedError("Automatic always holds the depth. Only manual can switch its hold.")
        if self.mode == "manual" and loop.measured is None:
            raise RefusedError(f"The {loop.name} is not measured yet. Check the sensors.")

    def _find(self, name: str) -> ControlLoop:
        loop = self.loops.get(name)
        if loop is None:
            raise RefusedError(f"there is no loop {name!r}; there are {', '.join(self.loops)}")
        return loop

    def _measure(self) -> float | None:
        """Take the newest measurements; return the time of the newest depth, None without one."""
        if self._imu is not None:
            angles = euler_angles(Imu.from_bytes(self._imu).attitude)
            for loop, angle in zip(self.attitude_loops, angles, strict=True):
                loop.measured = angle
        self.depth.heave_acceleration = None
        if self.depth.controller_in_force.needs_heave_acceleration:
            self.depth.heave_acceleration = self._mean_heave_acceleration()
        else:
            self._imus.clear()
        depths = []
        while self._depths:
            self._depth_taken, record = self._depths.popleft()
            depths.append(Depth.from_bytes(record).depth)
        if depths:
            self.depth.measured = depths[-1]
        self.depth.mean = sum(depths) / len(depths) if depths else None
        return self._depth_taken

    def _mean_heave_acceleration(self) -> float | None:
        accelerations = []
        while self._imus:
            imu = Imu.from_bytes(self._imus.popleft())
            accelerations.append(heave_acceleration(imu.attitude, imu.force))
        return sum(accelerations) / len(accelerations) if accelerations else None

    def _publish(self, now: float, taken: float | None) -> None:
        depth = self.depth.measured
        if depth is not None and taken is not None:
            set_point = self.depth.set_point_in_force
            tick = Control(
                set_point=set_point,
                depth=depth,
                error=set_point - depth,
                output=self.depth.output or 0.0,
                latency=now - taken,
            )
            self._bus.publish_row(CONTROL, now, tick.to_bytes())
        if self._imu is not None:
            self._bus.publish_row(TURNING, now, self._turning().to_bytes())

    def _turning(self) -> Turning:
        set_point, measured, output = zip(
            *(
                (
                    nan if loop.output is None else loop.set_point_in_force,
                    nan if loop.measured is None else loop.measured,
                    nan if loop.output is None else loop.output,
                )
                for loop in self.attitude_loops
            ),
            strict=True,
        )
        return Turning(set_point=set_point, measured=measured, output=output)

    @property
    def _steering_in_force(self) -> Steering:
        return self.steering if self._course_override is None else self._course_override.by

    def _find_course(self, now: float, seconds: float) -> tuple[float, float]:
        course = self._course_override
        if course is not None and (course.by == "none" or now > course.until):
            return (course.x, course.yaw) if now <= course.until else (0.0, 0.0)
        if self._steering_in_force == "none":
            return 0.0, 0.0
        time, right, left = self._beacons
        fresh = now - time <= BEACON_STALE
        return self._beacon_steering.step(fresh and right, fresh and left, seconds)

    def _choose_set_point(self, now: float, mode: Mode) -> None:
        set_point, reason = self.set_point_default, ""
        detection = self._detection
        if detection is not None and now - detection.taken <= VISION_STALE:
            if detection.set_point is not None:
                set_point, reason = detection.set_point, f": {detection.target} is seen"
            elif detection.target == self.colour:
                set_point, reason = self.set_point_detected, f": {self.colour} is seen"
        if set_point > self.deepest:
            set_point, reason = self.deepest, f"{reason}; it is the greatest depth"
        if detection is not None and detection is not self._used_detection:
            self._used_detection, self.picture_age = detection, now - detection.taken
        if set_point != self._announced_set_point:
            self._announced_set_point = set_point
            self._publish_event("set_point", f"Set point {set_point:.2f} m{reason}.")
        if mode != "manual" or not self.depth.on:
            self.depth.set_point = set_point

    def _take_depth(self, time: float, record: bytes) -> None:
        self._depths.append((time, record))

    def _take_imu(self, _time: float, record: bytes) -> None:
        self._imu = record
        self._imus.append(record)

    def _take_beacon(self, time: float, record: bytes) -> None:
        seen = Beacon.from_bytes(record)
        self._beacons = (time, bool(seen.right), bool(seen.left))

    def _take_detection(self, detection: Detection) -> None:
        self._detection = detection

    def _publish_event(self, kind: str, text: str, severity: Severity = "info") -> None:
        event = Event(time=self._clock.now(), kind=kind, severity=severity, text=text)
        self._bus.publish_document(EVENT, event)
