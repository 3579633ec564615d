"""The robot's core: link, control, vision and publication, as steps that never block.

`robot.Robot` runs them in threads and real time, `experiments.scenario.run` one after the other in simulated
time.
"""

import logging
import threading
from collections.abc import Callable
from dataclasses import asdict, replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Any

from robot_runtime.calibration.calibrator import Calibrator
from robot_runtime.clock import Clock
from robot_runtime.config import Config
from robot_runtime.contract.documents import (
    ControllerChoice,
    DebugLine,
    Detection,
    Event,
    Experiment,
    Gain,
    Loop,
    Mode,
    Pace,
    Parameters,
    Severity,
    State,
    VisionInForce,
)
from robot_runtime.contract.packets import (
    Calibration,
    Debug,
    Depth,
    Hello,
    Imu,
    Motor,
    Parameter,
    Status,
)
from robot_runtime.contract.topics import (
    CALIBRATION,
    DEBUG,
    DETECTION,
    EVENT,
    EXPERIMENT,
    IMU,
    LINK,
    MISSION,
    MOTOR,
    PARAMETERS,
    STATE,
    TELEMETRY,
    THUMBNAIL,
    TOPICS,
    VISION,
    Kind,
)
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.control.controllers.base import Controller
from robot_runtime.control.experiments import Experiments
from robot_runtime.control.hil_feed import HilFeed
from robot_runtime.control.loop import ControlLoop
from robot_runtime.control.node import ControlNode
from robot_runtime.control.pilot import PILOT_LOOK
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.link.dissection import dissect
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.link.session import BoardMessage
from robot_runtime.link.timing import periods
from robot_runtime.missions.node import MissionRunner
from robot_runtime.missions.senses import MissionSenses
from robot_runtime.parameters.board import BoardParameters
from robot_runtime.parameters.providers import runtime_entries
from robot_runtime.parameters.registry import Registry
from robot_runtime.transport.bus import Bus
from robot_runtime.transport.outbox import Outbox
from robot_runtime.vision.interface import Vision, VisionOutputs
from robot_runtime.vision.node import VisionNode

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

    `open_vision` replaces the vision node in this process. `hil` feeds a board without sensors. With
    `heartbeat` (s) a server that is silent for longer is a fault.

    `line` calls `take_messages` and `link_changed`. Threads of their own may run: `line`, `take_pilot`,
    `publish_tick`, `vision`, and `control_tick` together with `pilot_tick`.
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
        open_vision: Callable[[VisionOutputs], Vision] | None = None,
        hil: HilFeed | None = None,
        heartbeat: float | None = None,
    ) -> None:
        self.config = config
        self.clock = clock
        self.bus = Bus()
        self.outbox = outbox
        self._run = run
        self._state_changed = threading.Event()
        self._piloted = False
        self._flushed = -inf
        """s; when the messages of the board took everything queued along."""
        self.line = line
        self._paces = [
            Pace(topic=TELEMETRY[packet.type].name, period=period)
            for packet, period in periods(config.link.baud).items()
        ]
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
        )
        self.control = ControlNode(self.bus, clock, line.send, self.supervisor.pilot)
        self.experiments = Experiments(clock, self._publish_experiment)
        outputs = VisionOutputs(
            detection=self._take_detection,
            event=self.publish_event,
            picture=outbox.send_picture,
            thumbnail=partial(outbox.add_picture, THUMBNAIL),
            watched=lambda topic: watched(topic.name),
        )
        self.vision = (open_vision or self._open_vision)(outputs)
        self._every: list[tuple[float, Callable[[], None]]] = [
            (_STATE_EVERY, self.announce),
            (_STATISTICS_EVERY, self._publish_statistics),
            (_VISION_EVERY, self._publish_vision),
            (_CALIBRATION_EVERY, self.calibrator.publish),
        ]
        self._due = [clock.now()] * len(self._every)
        self._configure()
        self.parameters = Registry(
            [*runtime_entries(self.control, self.vision, self.set_vision), *self.board_parameters.entries()],
            armed=lambda: self.supervisor.armed,
            tick_lock=self.control.tick_lock,
        )
        self.missions = MissionRunner(
            clock,
            config.missions,
            MissionSenses(self.bus, clock, self.control, self.supervisor.detector, self.vision),
            self.parameters,
            self.supervisor.stop,
            partial(self.bus.publish_document, MISSION),
            self.publish_event,
        )
        self._parameters_published: Parameters | None = None
        self._join()

    def _open_vision(self, outputs: VisionOutputs) -> Vision:
        return VisionNode(self.config.vision, self.clock, outputs)

    def publish_event(self, event: Event) -> None:
        """Publishes an event and the changed state."""
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
        """Requests publication of the state."""
        self._state_changed.set()

    def announce_all(self) -> None:
        """Requests publication of everything that is published periodically."""
        self._due = [self.clock.now()] * len(self._every)

    def control_tick(self) -> None:
        """Runs one control tick; call it at the control rate."""
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

    def take_pilot(self, payload: bytes) -> None:
        """Sends the pilot's input at once, without waiting for the next tick."""
        if self.supervisor.pilot.take(payload):
            self._drive()

    def pilot_tick(self) -> float:
        """Stops the fins when the pilot falls silent; returns when to check again (s, steady clock)."""
        pilot, now = self.supervisor.pilot, self.clock.now()
        if self.supervisor.mode != "manual":
            return inf
        if pilot.quiet:
            if self._piloted:
                self._drive()
            self._piloted = False
            return now + PILOT_LOOK
        self._piloted = True
        return min(now + PILOT_LOOK, pilot.until)

    def check_faults(self) -> None:
        """Checks for faults; call it every `PUBLISH_EVERY` at least."""
        try:
            self.supervisor.tick()
        except Exception:
            log.exception("the check for faults failed")
            self.supervisor.fail("control_failed")

    def publish_tick(self) -> None:
        """Publishes what is due; call it every `PUBLISH_EVERY`.

        Where the board is silent it also checks for faults and sends what is queued. Otherwise the board's
        messages do both, some thirty times a second: one message more would wake the server once more.
        """
        now = self.clock.now()
        heard = now - self._flushed < PUBLISH_EVERY
        if not heard:
            self.check_faults()
            self.board_parameters.tick()
            self.calibrator.board.tick()
        for index, (seconds, action) in enumerate(self._every):
            if now >= self._due[index]:
                self._due[index] = now + seconds
                action()
        if self._state_changed.is_set():
            self._state_changed.clear()
            self.bus.publish_document(STATE, self.state())
            self._publish_parameters()
        if not heard:
            self.outbox.flush()

    def state(self) -> State:
        """Returns the state of the robot."""
        board = self.line.board
        return State(
            time=self.clock.now(),
            run=self._run,
            mode=self.supervisor.mode,
            armed=self.supervisor.armed,
            armed_since=self.supervisor.armed_since,
            alarms=self.supervisor.alarms,
            refusals=self.supervisor.refusals(),
            connected=self.line.connected,
            connection=self.line.text,
            port=Path(self.line.path).name,
            baud=self.line.baud,
            paces=self._paces,
            epoch=board.epoch if board and self.line.connected else None,
            set_point_default=self.control.set_point_default,
            set_point_detected=self.control.set_point_detected,
            steering=self.control.steering,
            control_rate=self.config.control.rate,
            profile="lean" if self.config.robot.profile == "lean" else "full",
            vision_rate=self.vision.settings.rate,
            vision_colour=self.control.colour,
            colours=list(self.vision.settings.colours),
            card=self.vision.card,
            cards=self.vision.cards,
            camera=self.vision.text,
            loops=[_describe(loop) for loop in self.control.loops.values()],
            pilot_dropped=self.supervisor.pilot.dropped.total(),
        )

    def set_vision(self, settings: VisionSettings) -> None:
        """Applies vision settings from the next picture on, and publishes them."""
        self.vision.settings = settings
        self.control.colour = settings.colour
        self._publish_vision()

    def store_settings(self) -> None:
        """Stores the settings that commands have changed. Not for the control loop: a card may be slow."""

    def vision_settings(self) -> dict[str, Any]:
        """Returns the vision settings in force and the configured ones, as a JSON object."""
        now, configured = self.vision.settings, self.config.vision.settings
        return {"settings": now.table(), "configured": configured.table()}

    def list_parameters(self) -> Parameters:
        """Returns all tunable parameters with their values."""
        return Parameters(time=self.clock.now(), parameters=self.parameters.listed())

    def frames(self) -> dict[str, Any]:
        """Returns the last frames on the serial line, now and at the last failure, as a JSON object."""
        fault = self.line.fault
        return {
            "time": self.clock.now(),
            "frames": [asdict(dissect(frame)) for frame in self.line.frames()],
            "fault": fault
            and {
                "time": fault.time,
                "text": fault.text,
                "frames": [asdict(dissect(frame)) for frame in fault.frames],
            },
        }

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
        self.control.set_points(settings.set_point, settings.set_point_detected)
        self.control.colour = self.config.vision.colour

    def _join(self) -> None:
        detector = self.supervisor.detector
        self._sensed: dict[int, Callable[[bytes], None]] = {
            Depth.type: lambda payload: detector.see_depth(Depth.from_bytes(payload)),
            Imu.type: lambda payload: detector.see_imu(Imu.from_bytes(payload)),
        }
        self._handlers: dict[int, Callable[[float, bytes], None]] = {
            Status.type: lambda _, payload: self.supervisor.see_status(Status.from_bytes(payload)),
            Hello.type: self._see_greeting,
            Parameter.type: self._see_parameter,
            Calibration.type: lambda _, payload: self.calibrator.board.see(Calibration.from_bytes(payload)),
            Debug.type: self._see_debug,
        }
        self.bus.on_row(MOTOR, self._check_motor)
        self.bus.on_row(IMU, self.calibrator.see_imu)
        for topic in TOPICS:
            if topic.kind is Kind.ROWS:
                self.bus.on_row(topic, partial(self.outbox.add_row, topic))
            elif topic.kind is Kind.DOCUMENTS:
                self.bus.on_document(topic, partial(self.outbox.add_document, topic))

    def _check_motor(self, _time: float, record: bytes) -> None:
        if self.supervisor.mode == "test":
            self.supervisor.fin_check.see(Motor.from_bytes(record))

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
        """Handles and publishes the board's messages."""
        self.supervisor.detector.see_messages()
        newest: dict[int, bytes] = {}
        for message in messages:
            type_, time, payload = message.type, message.time, message.payload
            if (topic := TELEMETRY.get(type_)) is not None:
                self.bus.publish_row(topic, time, payload)
            if type_ in self._sensed:
                newest[type_] = payload
            elif (handle := self._handlers.get(type_)) is not None:
                handle(time, payload)
        # Only the newest of a batch, since decoding a hundred a second costs a Pi CPU time.
        for type_, payload in newest.items():
            self._sensed[type_](payload)
        self.board_parameters.tick()
        self.calibrator.board.tick()
        self.check_faults()
        self.outbox.flush()
        self._flushed = self.clock.now()

    def _see_greeting(self, _time: float, _payload: bytes) -> None:
        self.board_parameters.forget_confirmations()
        self.calibrator.board.forget()

    def _see_parameter(self, _time: float, payload: bytes) -> None:
        if self.board_parameters.confirm(Parameter.from_bytes(payload)):
            self.announce()

    def _see_debug(self, time: float, payload: bytes) -> None:
        debug = Debug.from_bytes(payload)
        self.bus.publish_document(DEBUG, DebugLine(time=time, level=debug.level, text=debug.text))

    def link_changed(self) -> None:
        """Publishes that the connection was established or lost, and soon the link's counters."""
        text = self.line.text
        severity: Severity = "info" if self.line.connected else "caution"
        self.publish_event(
            Event(time=self.clock.now(), kind="link", severity=severity, text=f"Link: {text}.")
        )
        self.announce_all()

    def _take_detection(self, detection: Detection) -> None:
        self.supervisor.detector.see_picture(detection.taken)
        self.bus.publish_document(DETECTION, replace(detection, latency=self.control.picture_age))


def _describe(loop: ControlLoop) -> Loop:
    return Loop(
        name=loop.name,
        on=loop.on,
        set_point=loop.set_point_in_force,
        controller=loop.controller.name,
        controllers=[_choice(one) for one in loop.controllers.values()],
    )


def _choice(controller: Controller) -> ControllerChoice:
    gains = [
        Gain(
            name=name,
            value=controller.gains[name],
            minimum=limits.minimum,
            maximum=limits.maximum,
            unit=limits.unit,
            meaning=limits.meaning,
        )
        for name, limits in controller.limits.items()
    ]
    return ControllerChoice(name=controller.name, title=controller.title, gains=gains)
