"""The thread of the control loop: at the control rate, or in step with what the board sends."""

import threading
from collections.abc import Callable

from robot_runtime.control_step import ControlStep
from robot_runtime.core import Core
from robot_runtime.link.serial_link import SerialLink
from robot_runtime.periodic_task import SAME_TIME, PeriodicTask
from robot_runtime.service_manager import ServiceManager


class ControlThread:
    """The control loop of this robot; `on_end` is called when it has ended, also by an error."""

    def __init__(self, robot: Core, line: SerialLink, on_end: Callable[[], None]) -> None:
        self._robot = robot
        self._line = line
        self._on_end = on_end
        self._service = ServiceManager()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="control", daemon=True)

    def start(self) -> None:
        """Begin to control."""
        self._thread.start()

    def end(self) -> None:
        """Ask the loop to end."""
        self._ending.set()

    def join(self) -> None:
        """Wait until the loop has ended."""
        self._thread.join()

    def _run(self) -> None:
        try:
            self._service.ready()
            if self._line.in_step:
                self._run_in_step()
            else:
                self._run_at_rate()
        finally:
            # Without control there is no robot: its process ends, and is started again.
            self._on_end()

    def _run_at_rate(self) -> None:
        now, period = self._robot.clock.now, 1 / self._robot.config.control.rate
        ticks = PeriodicTask(now() + period, period, self._tick)
        while self._wait(ticks.due):
            ticks.run_if_due(now())

    def _tick(self) -> None:
        self._robot.control_tick()
        self._feed()

    def _run_in_step(self) -> None:
        step = ControlStep(self._robot, self._line.receive_waiting)
        while self._wait(step.due):
            if self._robot.clock.now() >= step.due - SAME_TIME:
                step.run()
                self._line.send_due()
                self._feed()

    def _wait(self, due: float) -> bool:
        """Wait until then, or until the pilot's silence must be noticed; return False at the end."""
        due = min(due, self._robot.pilot_tick())
        return not self._ending.wait(max(due - self._robot.clock.now(), 0.0))

    def _feed(self) -> None:
        # A control loop that hangs is ended and started again, disarmed.
        self._service.feed(self._robot.clock.now())
