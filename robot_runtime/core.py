"""The robot's core: link, control, vision and publication, as steps that never block.

`robot.RobotRuntime` runs them in threads and real time, `experiments.scenario.run` one after the other in
simulated time.
"""

import logging
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import inf
from typing import Any

from robot_runtime.board_messages import BoardMessages
from robot_runtime.calibration.calibrator import Calibrator
from robot_runtime.clock import Clock
from robot_runtime.config import Config
from robot_runtime.contract.documents import (
    Detection,
    Event,
    Experiment,
    Mode,
    Parameters,
    Severity,
    State,
    VisionInForce,
)
from robot_runtime.contract.topics import (
    CALIBRATION,
    DETECTION,
    EVENT,
    EXPERIMENT,
    LINK,
    PARAMETERS,
    SNAPSHOT,
    STATE,
    THUMBNAIL,
    TOPICS,
    VISION,
    Kind,
)
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.control.experiments import Experiments
from robot_runtime.control.hil_feed import HilFeed
from robot_runtime.control.node import ControlNode
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.link.session import BoardMessage
from robot_runtime.missions.node import make_runner
from robot_runtime.parameters.board import BoardParameters
from robot_runtime.parameters.providers import make_registry
from robot_runtime.state_report import StateReport
from robot_runtime.transport.bus import Bus
from robot_runtime.transport.outbox import Outbox
from robot_runtime.vision.interface import Vision, VisionOutputs

log = logging.getLogger(__name__)

PUBLISH_EVERY = 0.1
"""s between two publications when no message of the board triggers one."""
_STATE_EVERY = 1.0
_STATISTICS_EVERY = 1.0
_VISION_EVERY = 10.0
_PARAMETERS_EVERY = 10.0
_CALIBRATION_EVERY = 10.0


class Core:
    """The robot without its threads. `run` is this run's identifier, 16 hexadecimal digits.

    `open_vision` makes the vision node, or what stands for it in this process. `hil` feeds a board without
    sensors. With `heartbeat` (s) a server that is silent for longer is a fault.

    `line` calls `take_messages` and `link_changed`. Threads of their own may run: `line`, `take_pilot`,
    `publish_tick`, `vision`, and `control_tick` together with `pilot_tick`. `step` stands for `control_tick`
    where the board is heard, controlled and published in one.
    """

    def __init__(
        self,
        config: Config,
        clock: Clock,
        run: str,
        line: LinkDriver,
        outbox: Outbox,
        *,
        watched: Callable[[str], bool],
        open_vision: Callable[[VisionOutputs], Vision],
        hil: HilFeed | None = None,
        heartbeat: float | None = None,
    ) -> None:
        self.config = config
        self.clock = clock
        self.bus = Bus()
        self.outbox = outbox
        self._state_changed = threading.Event()
        self._piloted = False
        self._flushed = -inf
        """s; when the messages of the board took everything queued along."""
        self._stepping = False
        """The step sends what is queued at its end."""
        self.line = line
        self.board_parameters = BoardParameters(clock, line.send, config.link.baud)
        self.calibrator = Calibrator(
            clock,
            line.send,
            config.link.baud,
            armed=lambda: self.supervisor.armed or self.supervisor.board_armed,
            tell=self._tell_calibration,
            publish=partial(self.bus.publish_document, CALIBRATION),
        )
        self.supervisor = Supervisor(
            clock,
            self.line,
            self.publish_event,
            hil,
            heartbeat,
            on_mode=self._change_mode,
            arming_obstacles=self._arming_obstacles,
            deepest=config.control.deepest,
            unwatched=config.control.unwatched,
        )
        self.control = ControlNode(self.bus, clock, line.send, self.supervisor.pilot, config.control.deepest)
        self.experiments = Experiments(clock, self._publish_experiment)
        outputs = VisionOutputs(
            detection=self._take_detection,
            event=self.publish_event,
            picture=outbox.send_picture,
            thumbnail=partial(outbox.add_picture, THUMBNAIL),
            snapshot=partial(outbox.add_picture, SNAPSHOT),
            film=outbox.add_film,
            watched=lambda topic: watched(topic.name),
        )
        self.vision = open_vision(outputs)
        self._every: list[tuple[float, Callable[[], None]]] = [
            (_STATE_EVERY, self.announce),
            (_STATISTICS_EVERY, self._publish_statistics),
            (_VISION_EVERY, self._publish_vision),
            (_CALIBRATION_EVERY, self.calibrator.publish),
        ]
        self._due = [clock.now()] * len(self._every)
        self._configure()
        self._report = StateReport(config, clock, run, line, self.supervisor, self.control, self.vision)
        self._board = BoardMessages(
            self.bus, line, self.supervisor, self.calibrator, self.board_parameters, self.announce
        )
        self.parameters = make_registry(
            self.control, self.vision, self.set_vision, self.board_parameters, lambda: self.supervisor.armed
        )
        self.missions = make_runner(
            self.bus,
            clock,
            config.mission_limits,
            self.control,
            self.supervisor,
            self.vision,
            self.parameters,
            self.publish_event,
        )
        self._parameters_published: Parameters | None = None
        self._join()

    def publish_event(self, event: Event) -> None:
        """Publish an event and the changed state."""
        self.bus.publish_document(EVENT, event)
        self._state_changed.set()

    def _change_mode(self, mode: Mode) -> None:
        self.control.change_mode(mode)
        self.missions.change_mode(mode)

    def _publish_experiment(self, experiment: Experiment) -> None:
        # The state first: a receiver of the end then has the restored loop already.
        self.bus.publish_document(STATE, self.state())
        self.bus.publish_document(EXPERIMENT, experiment)

    def _tell_calibration(self, text: str, severity: Severity) -> None:
        event = Event(time=self.clock.now(), kind="calibration", severity=severity, text=text)
        self.publish_event(event)

    def announce(self) -> None:
        """Request publication of the state."""
        self._state_changed.set()

    def announce_all(self) -> None:
        """Request publication of everything that is published periodically."""
        self._due = [self.clock.now()] * len(self._every)

    def control_tick(self) -> None:
        """Run one control tick; call it at the control rate."""
        with self.control.tick_lock:
            self._control_tick()

    def _control_tick(self) -> None:
        self.check_faults()
        try:
            if self.control.depth.on and (reasons := self.supervisor.detector.depth_refusals()):
                self.control.release(self.control.depth, reasons[0])
            self.missions.tick(self.supervisor.mode)
            self.experiments.tick(self.supervisor.mode)
            self.control.tick()
            if self.supervisor.mode == "test":
                self._check_fins()
        except Exception:
            log.exception("a control tick failed")
            self.supervisor.fail("control_failed")

    def step(self, take_newest: Callable[[], None]) -> None:
        """Take what the board has sent, run a control tick, and send all of it in one message."""
        self._stepping = True
        take_newest()
        self.control_tick()
        self._send_requests()
        self._publish_due()
        self._stepping = False
        self._flush()

    def take_pilot(self, payload: bytes) -> None:
        """Send the pilot's input at once, without waiting for the next tick."""
        if self.supervisor.pilot.take(payload):
            self._drive()

    def pilot_tick(self) -> float:
        """Stop the fins when the pilot falls silent; return when to check again (s, steady clock)."""
        pilot = self.supervisor.pilot
        if self.supervisor.mode != "manual":
            return inf
        if pilot.quiet:
            if self._piloted:
                self._drive()
            self._piloted = False
        else:
            self._piloted = True
        return pilot.next_check

    def check_faults(self) -> None:
        """Check for faults; call it every `PUBLISH_EVERY` at least."""
        try:
            self.supervisor.tick()
        except Exception:
            log.exception("the check for faults failed")
            self.supervisor.fail("control_failed")

    def publish_tick(self) -> None:
        """Publish what is due; call it every `PUBLISH_EVERY`.

        Where the board is silent it also checks for faults and sends what is queued. Otherwise the board's
        messages do both, some thirty times a second: one message more would wake the server once more.
        """
        heard = self.clock.now() - self._flushed < PUBLISH_EVERY
        if not heard:
            self.check_faults()
            self._send_requests()
        self._publish_due()
        if not heard:
            self.outbox.flush()

    def _send_requests(self) -> None:
        self.board_parameters.tick()
        self.calibrator.board.tick()

    def _flush(self) -> None:
        self.outbox.flush()
        self._flushed = self.clock.now()

    def _publish_due(self) -> None:
        now = self.clock.now()
        for index, (seconds, action) in enumerate(self._every):
            if now >= self._due[index]:
                self._due[index] = now + seconds
                action()
        if self._state_changed.is_set():
            self._state_changed.clear()
            self.bus.publish_document(STATE, self.state())
            self._publish_parameters()

    def state(self) -> State:
        """Return the state of the robot."""
        return self._report.state()

    def set_vision(self, settings: VisionSettings) -> None:
        """Apply vision settings from the next picture on, and publish them."""
        self.vision.settings = settings
        self.control.colour = settings.colour
        self._publish_vision()

    def store_settings(self) -> None:
        """Store the settings that commands have changed. Not for the control loop: an SD card may be slow."""

    def vision_settings(self) -> dict[str, Any]:
        """Return the vision settings in force and the configured ones, as a JSON object."""
        now, configured = self.vision.settings, self.config.vision.settings
        return {"settings": now.table(), "configured": configured.table()}

    def list_parameters(self) -> Parameters:
        """Return all tunable parameters with their values."""
        return Parameters(time=self.clock.now(), parameters=self.parameters.listed())

    def _drive(self) -> None:
        try:
            self.control.drive()
        except Exception:
            log.exception("the pilot's input could not be sent")
            self.supervisor.fail("control_failed")

    def _configure(self) -> None:
        settings = self.config.control
        for name, gains in settings.gains.items():
            self.control.set_loop("depth", controller=name, gains=gains)
        self.control.set_loop("depth", controller=settings.controller)
        self.control.steer(settings.steering)
        # Not refused where they are too deep: arming is, which says so.
        self.control.set_point_default = settings.set_point
        self.control.set_point_detected = settings.set_point_detected
        self.control.colour = self.config.vision.colour
        self.control.battery.capacity = self.config.battery_capacity
        self.control.battery.alarm = partial(self.board_parameters.requested, "battery.alarm")

    def _join(self) -> None:
        for topic in TOPICS:
            if topic.kind is Kind.ROWS:
                self.bus.on_row(topic, partial(self.outbox.add_row, topic))
            elif topic.kind is Kind.DOCUMENTS:
                self.bus.on_document(topic, partial(self.outbox.add_document, topic))

    def _publish_parameters(self) -> None:
        now, published = self.list_parameters(), self._parameters_published
        if (
            published is None
            or now.parameters != published.parameters
            or now.time - published.time >= _PARAMETERS_EVERY
        ):
            self._parameters_published = now
            self.bus.publish_document(PARAMETERS, now)

    def _arming_obstacles(self) -> list[str]:
        return [
            *self.calibrator.board.refusals(),
            *self.board_parameters.refusals(),
            *self.vision.refusals(),
            *self._deep_set_points(),
        ]

    def _deep_set_points(self) -> list[str]:
        deepest, control = self.control.deepest, self.control
        depths = {
            "The set point": control.set_point_default,
            "The set point while the colour is seen": control.set_point_detected,
            **{f"The set point for {seen}": depth for seen, depth in self.vision.settings.actions.items()},
        }
        return [
            f"{what} is {depth:g} m, and the greatest depth {deepest:g} m ([control] deepest). "
            "Choose one that is less deep."
            for what, depth in depths.items()
            if depth > deepest
        ]

    def _publish_statistics(self) -> None:
        self.bus.publish_row(LINK, self.clock.now(), self.line.statistics().to_bytes())

    def _publish_vision(self) -> None:
        now = self.clock.now()
        self.bus.publish_document(VISION, VisionInForce(time=now, settings=self.vision.settings))

    def _check_fins(self) -> None:
        command = self.supervisor.fin_check.step()
        if command is None:
            self.supervisor.end_fin_check()
        else:
            self.control.command(command)

    def take_messages(self, messages: list[BoardMessage]) -> None:
        """Handle and publish the board's messages."""
        self._board.handle(messages)
        if self._stepping:
            return
        self._send_requests()
        self.check_faults()
        self._flush()

    def link_changed(self) -> None:
        """Publish that the connection was established or lost, and soon the link's counters."""
        text = self.line.text
        severity: Severity = "info" if self.line.connected else "caution"
        self.publish_event(
            Event(time=self.clock.now(), kind="link", severity=severity, text=f"Link: {text}.")
        )
        self.announce_all()

    def _take_detection(self, detection: Detection) -> None:
        self.supervisor.detector.see_picture(detection.taken)
        self.bus.publish_document(DETECTION, replace(detection, latency=self.control.picture_age))
