"""The whole firmware on a board in memory, in simulated time."""

import ctypes
from typing import TYPE_CHECKING, Self, TypeVar

from robot_runtime.contract.board_events import describe_event
from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    BoardEvent,
    Debug,
    Heartbeat,
    Hello,
    Navigation,
    Packet,
    ResetCause,
    Start,
    Status,
    decode,
)
from tests.firmware.devices import BridgeDevice, ImuDevice, MotorDevice, PressureSensor, encoder_word
from tests.firmware.library import I2C_BUS
from tests.line_end import LineEnd

if TYPE_CHECKING:
    Bytes = ctypes._Pointer[ctypes.c_uint8]

P = TypeVar("P", bound=Packet)

IMU, PRESSURE = 0x69, 0x76
BRIDGES = (0x64, 0x60, 0x61, 0x63)
SURFACE = 101325.0
TICK = 10

BATTERY_FULL = 818


def hello(definitions: int = DEFINITIONS_HASH, epoch: int = 7) -> Hello:
    return Hello(definitions=definitions, epoch=epoch, credit=255)


def navigation(
    x: float = 0, y: float = 0, z: float = 0, roll: float = 0, pitch: float = 0, yaw: float = 0
) -> Navigation:
    return Navigation(x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw)


def read_line(packet: Packet) -> Debug | None:
    """Return an event of the board, or a sketch's line, as the console shows it; None for other packets."""
    if isinstance(packet, BoardEvent):
        level, text = describe_event(packet)
        return Debug(time=packet.time, level=level, text=text)
    return packet if isinstance(packet, Debug) else None


class CompiledRobot:
    """A robot that is switched on at its creation; leaving the context ends it."""

    def __init__(self, firmware: ctypes.CDLL) -> None:
        self.firmware = firmware
        self.imu = ImuDevice()
        self.pressure = PressureSensor(now_us=firmware.board_now_us)
        self.bridges = [BridgeDevice() for _ in BRIDGES]
        zeros, signs = (188, 161, 726, 356), (1, 1, -1, -1)
        self.motors = [MotorDevice(zero, sign) for zero, sign in zip(zeros, signs, strict=True)]
        self.absent: set[int] = set()
        self.blind: set[int] = set()
        self.yellow: set[int] = set()
        self.frames = 0
        self.received: list[Packet] = []
        self.lines: list[Debug] = []
        self._bus = I2C_BUS(self._transfer)
        firmware.board_power_up()
        firmware.board_set_i2c(self._bus)
        firmware.board_set_battery(BATTERY_FULL)
        self.pressure.show(SURFACE)
        self._boot(ResetCause.POWER_ON)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.firmware.robot_destroy(self._robot)

    def reset(self, cause: ResetCause) -> None:
        """Restart, as the chip does after a reset."""
        self.firmware.robot_destroy(self._robot)
        self._boot(cause)

    def _boot(self, cause: ResetCause) -> None:
        self._end = LineEnd(is_host=True)
        self._show_encoders()
        self._robot = self.firmware.robot_start(cause)

    def _transfer(self, address: int, out: "Bytes", out_size: int, into: "Bytes", in_size: int) -> int:
        if address in self.absent:
            return 0
        device: ImuDevice | PressureSensor | BridgeDevice
        if address == IMU:
            device = self.imu
        elif address == PRESSURE:
            device = self.pressure
        else:
            device = self.bridges[BRIDGES.index(address)]
        answer = device.transfer(bytes(out[:out_size]), in_size)
        for i, byte in enumerate(answer):
            into[i] = byte
        return 1

    def _show_encoders(self) -> None:
        for fin, motor in enumerate(self.motors):
            yellow = int(fin in self.yellow)
            word = encoder_word(motor.counts, increase=yellow, decrease=yellow)
            word = 0xFFFF if fin in self.blind else word
            self.firmware.board_set_encoder(fin, word)

    @property
    def now(self) -> int:
        """ms since the board's creation."""
        return int(self.firmware.board_now_us()) // 1000

    @property
    def power(self) -> bool:
        """True if the motors have power."""
        return bool(self.firmware.board_motor_power())

    def say(self, *packets: Packet) -> None:
        """Send these packets to the board; they arrive when time advances."""
        self.send(self._end.say(packets, self.now / 1000))

    def send(self, data: bytes) -> None:
        self.firmware.board_receive(data, len(data))

    def run(self, milliseconds: int) -> list[Packet]:
        """Run for this time; return the packets that the board sent."""
        heard: list[Packet] = []
        while milliseconds > 0:
            part = min(milliseconds, TICK - self.now % TICK)
            self.firmware.robot_run(self._robot, part)
            milliseconds -= part
            for motor, bridge in zip(self.motors, self.bridges, strict=True):
                motor.turn(bridge.drive if self.power else 0, part / 1000)
            self._show_encoders()
        room = ctypes.create_string_buffer(1 << 16)
        while size := self.firmware.board_take(room, len(room)):
            before = self._end.frames
            messages = self._end.hear(room.raw[:size], self.now / 1000)
            heard += [decode(type_, payload) for type_, payload in messages]
            self.frames += self._end.frames - before
        assert self._end.invalid == 0
        self.received += heard
        self.lines += [line for packet in heard if (line := read_line(packet))]
        return heard

    def last(self, kind: type[P]) -> P:
        """Return the newest packet of this type."""
        return next(packet for packet in reversed(self.received) if isinstance(packet, kind))

    def status(self) -> Status:
        """Return the board's state, from its next status."""
        while not any(isinstance(packet, Status) for packet in self.run(TICK)):
            pass
        return self.last(Status)

    @property
    def epoch(self) -> int:
        """The board's epoch, from its newest greeting."""
        return self.last(Hello).epoch

    @property
    def texts(self) -> list[str]:
        """The board's events and lines, in words."""
        return [line.text for line in self.lines]

    def beat(self, milliseconds: int, every: int = 100) -> None:
        """Run for this time with a heartbeat at its start and periodically."""
        for _ in range(milliseconds // every):
            self.say(Heartbeat(time=self.now))
            self.run(every)

    def greet(self) -> None:
        """Greet the board, and send 600 ms of steady traffic."""
        self.say(hello())
        self.run(50)
        self.beat(600, every=50)

    def arm(self) -> None:
        """Greet and arm."""
        self.greet()
        self.say(Start(epoch=self.epoch))
        self.run(2 * TICK)
        assert self.texts[-1] == "armed"

    def swim(self, milliseconds: int, command: Navigation) -> None:
        """Run for this time with a command at its start and every 50 ms."""
        while milliseconds > 0:
            self.say(command)
            self.run(min(50, milliseconds))
            milliseconds -= 50
