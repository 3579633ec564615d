"""The messages of the board: published, and handed to the parts that they are for."""

from collections import defaultdict
from collections.abc import Callable, Sequence
from math import inf

from robot_runtime.calibration.calibrator import Calibrator
from robot_runtime.contract.board_events import describe_event
from robot_runtime.contract.documents import DebugLine
from robot_runtime.contract.packets import (
    BoardEvent,
    Calibration,
    Debug,
    Depth,
    Hello,
    Imu,
    Motor,
    Parameter,
    Status,
)
from robot_runtime.contract.topics import DEBUG, IMU, MOTOR, TELEMETRY
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.link.session import BoardMessage
from robot_runtime.parameters.board import BoardParameters
from robot_runtime.transport.bus import Bus

DECODE_EVERY = {Depth.type: 1, Imu.type: 3}
"""Of a batch's samples the newest and every so many before it are decoded for the checks for faults: decoding
all costs a Pi CPU time."""


class BoardMessages:
    """Handles batches of messages; `announce` is called when a parameter is confirmed."""

    def __init__(
        self,
        bus: Bus,
        line: LinkDriver,
        supervisor: Supervisor,
        calibrator: Calibrator,
        parameters: BoardParameters,
        announce: Callable[[], None],
    ) -> None:
        self._bus = bus
        self._line = line
        self._supervisor = supervisor
        self._calibrator = calibrator
        self._parameters = parameters
        self._announce = announce
        detector = supervisor.detector
        self._sensed: dict[int, Callable[[bytes, float], None]] = {
            Depth.type: lambda payload, age: detector.see_depth(Depth.from_bytes(payload), age),
            Imu.type: lambda payload, age: detector.see_imu(Imu.from_bytes(payload), age),
        }
        self._handlers: dict[int, Callable[[float, bytes], None]] = {
            Status.type: self._see_status,
            Hello.type: self._see_greeting,
            Parameter.type: self._see_parameter,
            Calibration.type: lambda _, payload: calibrator.board.see(Calibration.from_bytes(payload)),
            Debug.type: self._see_debug,
            BoardEvent.type: self._see_event,
        }
        bus.on_row(MOTOR, self._check_motor)
        bus.on_row(IMU, calibrator.see_imu)

    def handle(self, messages: Sequence[BoardMessage]) -> None:
        """Publish the messages, and pass each on."""
        self._supervisor.detector.see_messages()
        samples: defaultdict[int, list[tuple[float, bytes]]] = defaultdict(list)
        newest = -inf
        for message in messages:
            type_, time, payload = message.type, message.time, message.payload
            if (topic := TELEMETRY.get(type_)) is not None:
                self._bus.publish_row(topic, time, payload)
                newest = max(newest, time)
            if type_ in self._sensed:
                samples[type_].append((time, payload))
            elif (handle := self._handlers.get(type_)) is not None:
                handle(time, payload)
        for type_, batch in samples.items():
            for time, payload in reversed(batch[:: -DECODE_EVERY[type_]]):
                self._sensed[type_](payload, newest - time)

    def _check_motor(self, _time: float, record: bytes) -> None:
        if self._supervisor.mode == "test":
            self._supervisor.fin_check.see(Motor.from_bytes(record))

    def _see_status(self, _time: float, payload: bytes) -> None:
        status = Status.from_bytes(payload)
        self._line.see_faults(status.faults)
        self._supervisor.see_status(status)

    def _see_greeting(self, _time: float, _payload: bytes) -> None:
        self._parameters.forget_confirmations()
        self._calibrator.board.forget()

    def _see_parameter(self, _time: float, payload: bytes) -> None:
        if self._parameters.confirm(Parameter.from_bytes(payload)):
            self._announce()

    def _see_debug(self, time: float, payload: bytes) -> None:
        debug = Debug.from_bytes(payload)
        self._bus.publish_document(DEBUG, DebugLine(time=time, level=debug.level, text=debug.text))

    def _see_event(self, time: float, payload: bytes) -> None:
        level, text = describe_event(BoardEvent.from_bytes(payload))
        self._bus.publish_document(DEBUG, DebugLine(time=time, level=level, text=text))
