"""Goodput of the link with the chip's own end, both ways at once, in emulated time."""

import subprocess
import tempfile
from pathlib import Path

from robot_runtime.contract.packets import DEFINITIONS_HASH, Debug, Heartbeat, Hello, Status, encode
from robot_runtime.link.channel import Channel
from robot_runtime.link.framing import Decoder, build
from robot_runtime.link.session import session_key
from robot_runtime.simulation.boards.emulator_process import LineDirection
from tests.board.rig import ROOT, BoardRig

_BAUDS = (1200, 9600, 115_200, 250_000)
_NOISY_BAUD = 115_200
_HEAD_BYTES = 6
_PAYLOADS = (6, 18)
_DIRECTIONS: tuple[LineDirection, ...] = ("to_board", "from_board")
_HOST_EPOCH = 77
_CREDIT = 4096
_BITS_PER_BYTE = 10
_BACKLOG = 40
_START = 0.1
_STEP_BYTES = 4
_FRAMES = 150
_SECONDS = 5.0
_NOISY_SECONDS = 30.0
"""With 1 bit in 1000 wrong, draws of 5 s differ by 0.009 (standard deviation of 12, about 0.412)."""
_DRAIN = 60.0
"""Longest frames' airtime."""


def measure() -> dict[str, float]:
    """Return the slower direction's payload bytes as a share of baud/10, without loss, doubling or disorder.

    `bench/link_speed` on the emulated board has the firmware's link, with a queue of 228 bytes (the robot's
    has 114: its events are few) and room for 158 of frames out of order, and does nothing else; the host's
    end is the product's `Channel`. Both always have something to say: lines of text whose payload, with time,
    level and length, is 6 or 18 bytes. The host looks at its port every four characters.

    Bit errors are those of the wire, start and stop bits too. Where 1 in 1000 is wrong, 53 % of the longest
    frames survive, which would make 0.44, and 77 % of those with one line of 18 bytes, which would make 0.53,
    or 0.49 where the acknowledgement of held frames travels with each.
    """
    figures = {
        f"link.goodput_chip.{baud}.{size}": goodput(baud, size) for baud in _BAUDS for size in _PAYLOADS
    }
    figures["link.goodput_chip_ber_1e-4"] = goodput(_NOISY_BAUD, 18, 1e-4, _NOISY_SECONDS)
    figures["link.goodput_chip_ber_1e-3"] = goodput(_NOISY_BAUD, 18, 1e-3, _NOISY_SECONDS)
    return figures


def build_for(baud: int, name: str) -> Path:
    """Return a program of the firmware's for this baud.

    Raise CalledProcessError where it does not compile.
    """
    folder = ROOT / f"build/bench/{name}_{baud}"
    target, queue = {"robot": ("robot", 2), "link_speed": ("speed", 4)}[name]
    variables = [f"BAUD={baud}", f"QUEUE={queue}", f"BUILD={folder}"]
    command = ["make", "-s", "-C", str(ROOT / "firmware"), target, *variables]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder / f"{name}.elf"


def goodput(baud: int, size: int, bit_errors: float = 0.0, seconds: float = _SECONDS) -> float:
    """Return the share of baud/10 that the slower direction carries, in at least so many s and 150 frames."""
    elf = build_for(baud, "link_speed")
    with tempfile.TemporaryDirectory() as folder, BoardRig(elf, Path(folder), baud=baud) as rig:
        host = _Host(rig, baud, size)
        host.greet()
        for direction in _DIRECTIONS:
            rig.board.disturb_line(direction, "bit_errors", bit_errors)
        airtime = _FRAMES * 64 * _BITS_PER_BYTE / baud
        began = host.now
        heard, acknowledged = host.heard, host.delivered
        host.talk(max(airtime, seconds))
        passed = host.now - began
        heard, acknowledged = host.heard - heard, host.delivered - acknowledged
        for direction in _DIRECTIONS:
            rig.board.clean_line(direction)
        host.check()
    return min(heard, acknowledged) * size / (passed * baud / _BITS_PER_BYTE)


class _Host:
    """The host's end, which counts sent and received messages."""

    def __init__(self, rig: BoardRig, baud: int, size: int) -> None:
        self.now = rig.board.stats()["time"]
        self.heard = 0
        self._rig = rig
        self._baud = baud
        self._byte_time = _BITS_PER_BYTE / baud
        self._text = "a" * (size - _HEAD_BYTES)
        self._decoder = Decoder()
        self._channel = Channel(baud, 64)
        self._report: Status | None = None
        self._sent = 0
        self._wrong = 0
        self._line_free = 0.0

    @property
    def delivered(self) -> int:
        """The number of lines that the board has acknowledged."""
        return self._sent - len(self._channel.pending())

    def greet(self) -> None:
        """Open a session, and let the board begin to talk as well."""
        hello = Hello(definitions=DEFINITIONS_HASH, epoch=_HOST_EPOCH, credit=_CREDIT)
        self._rig.board.run(_START)
        answer = self._rig.exchange(build([hello], 0, 0), _START + 2 * 64 * self._byte_time)
        *_, frame = Decoder().feed(answer)
        board = Hello.from_bytes(frame.messages[0][1])
        self._decoder.key = session_key(_HOST_EPOCH, board.epoch)
        self._channel = Channel(self._baud, board.credit, self._decoder.key)
        self.now = self._rig.board.stats()["time"]
        self.talk(_START + 10 * 64 * self._byte_time)

    def talk(self, seconds: float) -> None:
        """Pass time with more to send than the line carries."""
        end = self.now + seconds
        while self.now < end:
            self._top_up()
            self._pass()

    def check(self) -> None:
        """Wait until everything has arrived. Raise RuntimeError if lines are missing or not in order."""
        end = self.now + _DRAIN * 64 * self._byte_time + 1.0
        while self._channel.pending() and self.now < end:
            self._pass()
        self._channel.offer(encode(Heartbeat(time=0)), self.now)
        end = self.now + _DRAIN * 64 * self._byte_time
        while self._report is None and self.now < end:
            self._pass()
        report = self._report
        if report is None:
            raise RuntimeError("the board does not tell what has come")
        if (report.time, report.missed_ticks, self._wrong) != (self._sent & 0xFFFFFFFF, 0, 0):
            raise RuntimeError(
                f"of {self._sent} lines the board has {report.time}, {report.missed_ticks} out of order,"
                f" and {self._wrong} of its own were"
            )

    def _top_up(self) -> None:
        for _ in range(len(self._channel.pending()), _BACKLOG):
            line = Debug(time=self._sent, level=self._sent & 255, text=self._text)
            self._channel.queue(encode(line))
            self._sent += 1

    def _pass(self) -> None:
        step = _STEP_BYTES * self._byte_time
        at, data = max(self._line_free, self.now), b""
        while at < self.now + step and (sent := self._channel.poll(at)):
            at += len(sent) * self._byte_time
            data += sent
        self._line_free = at
        if data:
            self._rig.port.write(data)
        self.now = self._rig.board.run(step)
        for frame in self._decoder.feed(self._rig.port.read()):
            if not frame.open:
                for type_, payload in self._channel.receive(frame, self.now):
                    self._take(type_, payload)

    def _take(self, type_: int, payload: bytes) -> None:
        if type_ == Status.type:
            self._report = Status.from_bytes(payload)
        elif type_ == Debug.type:
            self._wrong += Debug.from_bytes(payload).level != self.heard & 255
            self.heard += 1
