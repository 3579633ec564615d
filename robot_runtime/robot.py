"""The one place where the runtime is assembled: connection, control, vision, and the way to the others."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from robot_runtime.bus import Bus
from robot_runtime.clock import Clock, SteadyClock
from robot_runtime.config import Config
from robot_runtime.control.controllers import Controller
from robot_runtime.control.node import ControlNode
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.link.connection import Connection
from robot_runtime.link.dissection import dissect
from robot_runtime.link.pace import periods
from robot_runtime.link.session import Message
from robot_runtime.messages import Messages
from robot_runtime.outbox import Outbox
from robot_runtime.packets import Beacon, Debug, Depth, Imu, Motor, Navigation, Status
from robot_runtime.samples import ControllerChoice, DebugLine, Detection, Event, Gain, Pace, Severity, State
from robot_runtime.topics import TOPICS, Kind
from robot_runtime.vision.node import Vision

log = logging.getLogger(__name__)

_ROW_OF = {
    Imu.type: "imu",
    Depth.type: "depth",
    Beacon.type: "beacon",
    Motor.type: "motor",
    Status.type: "status",
}
_PUBLISH = 0.1
"""s between two looks for what the board's own messages have not already taken along."""
_STATE_EVERY = 1.0
_STATISTICS_EVERY = 1.0


class Robot:
    """The running robot. `run` returns after `close`."""

    def __init__(self, config: Config, port: str, messages: Messages, clock: Clock | None = None) -> None:
        self.config = config
        self.clock = clock or SteadyClock()
        self.bus = Bus()
        self.outbox = Outbox(messages.publish, messages.watched)
        self._messages = messages
        self._closing = False
        self._ending = threading.Event()
        self._state_wanted = threading.Event()
        # Any number will do that differs from the last run's.
        epoch = time.time_ns() // 1_000_000 & 0xFFFF
        self.connection = Connection(
            port, config.link.baud, self.clock, epoch, self._take_messages, self._link_changed
        )
        self._paces = [
            Pace(topic=_ROW_OF[packet.type], period=period)
            for packet, period in periods(config.link.baud).items()
        ]
        self.supervisor = Supervisor(self.clock, self.connection, self.tell)
        self.control = ControlNode(self.bus, self.clock, self._navigate)
        self.vision = Vision(
            config.vision,
            self.clock,
            self._take_detection,
            self._take_picture,
            self._picture_wanted,
            self.tell,
            on_thumbnail=self._take_thumbnail,
        )
        self._configure()
        self._join()

    def tell(self, event: Event) -> None:
        """Publish an event, and the state that it changed."""
        self.bus.publish_document("event", event)
        self._state_wanted.set()

    def announce(self) -> None:
        """Publish the state soon, since something of it changed."""
        self._state_wanted.set()

    def run(self) -> None:
        """Run until `close` is called; afterwards the board is disarmed and everything is closed."""
        self.connection.start()
        self.vision.start()
        control = threading.Thread(target=self._control_loop, name="control", daemon=True)
        control.start()
        try:
            self._publish_loop()
        finally:
            self._ending.set()
            self.supervisor.stop("The runtime ended.")
            control.join()
            self.vision.close()
            self.connection.close()
            self.outbox.flush()

    def close(self) -> None:
        """Ask `run` to return; may be called from a signal handler, which must take no lock."""
        self._closing = True

    def state(self) -> State:
        """The robot as a whole, now."""
        board = self.connection.board
        return State(
            time=self.clock.now(),
            mode=self.supervisor.mode,
            armed=self.supervisor.armed,
            armed_since=self.supervisor.armed_since,
            refusals=self.supervisor.refusals(),
            connected=self.connection.connected,
            connection=self.connection.text,
            port=Path(self.connection.path).name,
            baud=self.connection.baud,
            paces=self._paces,
            epoch=board.epoch if board and self.connection.connected else None,
            controller=self.control.controller.name,
            controllers=[_choice(one) for one in self.control.controllers.values()],
            set_point=self.control.set_point,
            set_point_default=self.control.set_point_default,
            set_point_detected=self.control.set_point_detected,
            control_rate=self.config.control.rate,
            vision_rate=self.vision.rate,
            vision_colour=self.control.colour,
            colours=list(self.vision.colours),
            card=self.vision.card,
            camera=self.vision.text,
        )

    def frames(self) -> dict[str, Any]:
        """The last frames on the serial line, now and at the last fault, in words; for a JSON object."""
        fault = self.connection.fault
        return {
            "time": self.clock.now(),
            "frames": [asdict(dissect(frame)) for frame in self.connection.frames()],
            "fault": fault
            and {
                "time": fault.time,
                "text": fault.text,
                "frames": [asdict(dissect(frame)) for frame in fault.frames],
            },
        }

    def _configure(self) -> None:
        settings = self.config.control
        for name, gains in settings.gains.items():
            self.control.choose(name, gains)
        self.control.choose(settings.controller)
        self.control.set_points(settings.set_point, settings.set_point_detected)
        self.control.colour = self.config.vision.colour

    def _join(self) -> None:
        for topic in TOPICS:
            if topic.kind is Kind.ROWS:
                self.bus.on_row(topic.name, self.outbox.add_row)
            elif topic.kind is Kind.DOCUMENTS:
                self.bus.on_document(topic.name, self.outbox.add_document)

    def _control_loop(self) -> None:
        period = 1 / self.config.control.rate
        due = self.clock.now() + period
        while not self._ending.wait(max(due - self.clock.now(), 0.0)):
            try:
                self.supervisor.tick()
                self.control.tick(self.supervisor.armed)
            except Exception:
                log.exception("a control tick failed")
                self.supervisor.stop("The control loop failed; the log says why.", "alarm")
            # A tick that came late is not made up for.
            due = max(due + period, self.clock.now())

    def _publish_loop(self) -> None:
        every: list[tuple[float, Callable[[], None]]] = [
            (_STATE_EVERY, self.announce),
            (_STATISTICS_EVERY, self._publish_statistics),
        ]
        due = [self.clock.now()] * len(every)
        while not self._closing:
            time.sleep(_PUBLISH)
            now = self.clock.now()
            for index, (seconds, action) in enumerate(every):
                if now >= due[index]:
                    due[index] = now + seconds
                    action()
            if self._state_wanted.is_set():
                self._state_wanted.clear()
                self.bus.publish_document("state", self.state())
            self.outbox.flush()

    def _publish_statistics(self) -> None:
        self.bus.publish_row("link", self.clock.now(), self.connection.statistics().to_bytes())

    def _navigate(self, command: Navigation) -> None:
        self.connection.send(command)

    def _take_messages(self, messages: list[Message]) -> None:
        for message in messages:
            topic = _ROW_OF.get(message.type)
            if topic is not None:
                self.bus.publish_row(topic, message.time, message.payload)
            if message.type == Depth.type:
                self.supervisor.see_depth()
            elif message.type == Status.type:
                self.supervisor.see_status(Status.from_bytes(message.payload))
            elif message.type == Debug.type:
                debug = Debug.from_bytes(message.payload)
                line = DebugLine(time=message.time, level=debug.level, text=debug.text)
                self.bus.publish_document("debug", line)
        self.outbox.flush()

    def _link_changed(self) -> None:
        text = self.connection.text
        severity: Severity = "info" if self.connection.connected else "caution"
        self.tell(Event(time=self.clock.now(), kind="link", severity=severity, text=f"Link: {text}."))

    def _take_detection(self, detection: Detection) -> None:
        self.bus.publish_document("detection", detection)

    def _take_picture(self, time: float, jpeg: bytes) -> None:
        self.outbox.send_picture(time, jpeg)

    def _take_thumbnail(self, time: float, jpeg: bytes) -> None:
        self.outbox.add_picture("thumbnail", time, jpeg)

    def _picture_wanted(self) -> bool:
        return self._messages.watched("picture")


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
