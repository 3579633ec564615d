"""Resets of either end at random moments: the firmware on the emulated board, and the host's session.

Time is the board's. Telemetry flows all the while, the host says START and NAVIGATION, and the board
answers each START with a line of text: that it armed, or why not. One START in each session is meant for
this boot, the others are refused. So the order of the answers is that of the STARTs, and an answer too many
would be a START or a line that came twice. Half of the cases have a noisy line, and half of the sessions
may be armed. Now and then a second reset comes before the first is over.

It counts as back when the host hears a STATUS of this session and this boot, which comes ten times a second.
"""

import random
import statistics
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal, NamedTuple, Self

from robot_runtime.contract.board_events import describe_event
from robot_runtime.contract.packets import BoardEvent, Hello, Navigation, Packet, Start, Status, StatusFlag
from robot_runtime.link.session import BoardMessage, LinkSession, SessionStage
from robot_runtime.simulation.boards.emulator_process import LineDirection, LineFault
from tests.board.host import BAUD, start
from tests.board.rig import ROOT, build
from tests.proofs.pool import processes

Reset = Literal["host", "reset pin", "power", "watchdog"]
RESETS: tuple[Reset, ...] = ("host", "reset pin", "power", "watchdog")
STEP = 0.005
"""s between two looks of the host at its port."""
COMMAND = 0.1
"""s between two NAVIGATIONs."""
STEADY = 0.6
"""s of traffic after which the board lets itself be armed."""
ASKING = 0.5
"""s between two attempts to arm."""
PATIENCE = 20.0
"""Emulated s after which something counts as not coming any more."""
_DIRECTIONS: tuple[LineDirection, ...] = ("to_board", "from_board")
_NOISE: tuple[tuple[LineFault, float], ...] = (
    ("bit_errors", 3e-4),
    ("drop", 1e-3),
    ("double", 1e-3),
    ("insert", 1e-3),
)
_BURST = (2e-5, 64)
_REFUSED = "START refused: "
_OTHER_BOOT = _REFUSED + "epoch of another boot"
_NO_SUCH_BOOT = 20_000
"""The first of the epochs that no board here will have."""
_SWIM = Navigation(x=0.5, y=0.0, z=0.5, roll=0.0, pitch=0.0, yaw=0.0)


class Return(NamedTuple):
    """A recovered session: the reset, the line, and the duration (emulated s)."""

    reset: Reset
    noisy: bool
    seconds: float


@dataclass
class ResetReport:
    """Result of many resets; `problems` are counted by kind and described in `words`."""

    resets: Counter[Reset] = field(default_factory=Counter)
    returns: list[Return] = field(default_factory=list)
    answers: int = 0
    armed: int = 0
    dropped: int = 0
    emulated: float = 0.0
    problems: Counter[str] = field(default_factory=Counter)
    words: list[str] = field(default_factory=list)

    def __add__(self, other: Self) -> "ResetReport":
        return ResetReport(
            self.resets + other.resets,
            self.returns + other.returns,
            self.answers + other.answers,
            self.armed + other.armed,
            self.dropped + other.dropped,
            self.emulated + other.emulated,
            self.problems + other.problems,
            self.words + other.words,
        )

    def seconds(self, reset: Reset, noisy: bool) -> list[float]:
        """Durations of each recovery of that kind."""
        return [
            recovery.seconds
            for recovery in self.returns
            if (recovery.reset, recovery.noisy) == (reset, noisy)
        ]

    def table(self) -> str:
        """Describe the result for a person."""
        lines = [f"{'':<24}{'returns':>8}{'median s':>10}{'longest s':>10}"]
        for reset in RESETS:
            for noisy in (False, True):
                if took := self.seconds(reset, noisy):
                    name = f"{reset}{', noisy line' if noisy else ''}"
                    lines.append(
                        f"{name:<24}{len(took):>8}{statistics.median(took):>10.3f}{max(took):>10.3f}"
                    )
        lines.append(
            f"{self.resets.total()} resets, {self.armed} of an armed board, in {self.emulated:.0f} s"
        )
        lines.append(f"{self.answers} STARTs answered in order; {self.dropped} lines found no room")
        lines.append(f"problems: {dict(self.problems) or 'none'}")
        return "\n".join([*lines, *self.words])


class ResetTrial:
    """The board with a program, its host, and the invariants of both."""

    def __init__(self, folder: Path, program: str, seed: int) -> None:
        self.report = ResetReport()
        self.now = 0.0
        self.joined = False
        self._folder = folder
        self._program = program
        self._chance = random.Random(seed)
        self._host_epoch = self._chance.getrandbits(16)
        self._boot: int | None = None
        self._last_boot: int | None = None
        self._noisy = False
        self._may_be_armed = False
        self._no_such_boot = _NO_SUCH_BOOT
        self._commanded = 0.0
        self._switch_on()
        self._start_host()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.report.emulated = self.now
        self._rig.__exit__()

    def join(self) -> None:
        """Begin the first session."""
        if not self._until(lambda: self.joined, PATIENCE):
            raise LookupError("the board does not answer")

    def case(self, kinds: Sequence[Reset]) -> None:
        """Run a session, and reset at a random moment, once or several times in a row."""
        self._set_noise(self._chance.random() < 0.5)
        if self._chance.random() < 0.5:
            self._run(STEADY)
        self._converse()
        self._speak_on(self._chance.uniform(0.0, 0.5))
        kind = self._chance.choice(kinds)
        while True:
            self._reset(kind)
            since = self.now
            again = self._chance.random() < 0.15
            wait = self._chance.uniform(0.0, 0.3) if again else PATIENCE
            if self._until(lambda: self.joined, wait):
                self.report.returns.append(Return(kind, self._noisy, self.now - since))
                return
            if not again:
                self._problem("did not come back", f"after {kind}")
                raise LookupError(self.report.table())

    # Actions of the host

    def _converse(self) -> None:
        """Send three STARTs, one of which is for this boot; return the answers."""
        epochs = [self._wrong(), self._boot or 0, self._wrong()]
        self._chance.shuffle(epochs)
        for epoch in epochs:
            self._say_start(epoch)
            self._run(self._chance.uniform(0.0, 0.03))
        if not self._until(lambda: len(self._answers) + self._dropped >= len(self._asked), PATIENCE):
            self._problem("lost", f"{self._answers} to {self._asked}")
        self._run(0.1)
        self._check_answers()
        self.report.answers += len(self._answers)
        self.report.dropped += self._dropped

    def _speak_on(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self._say_start(self._wrong())
            self._run(min(self._chance.uniform(0.01, 0.1), end - self.now))
        self._check_answers()

    def _wrong(self) -> int:
        self._no_such_boot += 1
        return self._no_such_boot

    def _say_start(self, epoch: int) -> None:
        self._may_be_armed |= epoch == self._boot
        self._asked.append(epoch)
        self._say(Start(epoch=epoch))

    def _say(self, packet: Packet) -> None:
        self._rig.port.write(self._session.send([packet], self.now))

    # Resets

    def _reset(self, kind: Reset) -> None:
        self.report.resets[kind] += 1
        self.report.armed += self._rig.board.fins().powered
        self._last_boot = None if kind == "host" else self._boot
        if kind == "watchdog":
            self._await_watchdog()
        elif kind == "reset pin":
            self._rig.board.reset()
        elif kind == "power":
            self._rig.__exit__()
            self._switch_on()
        if kind == "host":
            self._start_host()
        else:
            self._may_be_armed = False
        self.joined = False

    def _switch_on(self) -> None:
        eeprom = ("--eeprom", str(self._folder / "eeprom"))
        # The session's time is measured, not the second in which a boot loader waits for an upload.
        self._rig = start(self._program, self._folder, *eeprom, boot_loader=False)
        self._set_noise(self._noisy)

    def _start_host(self) -> None:
        self._host_epoch = (self._host_epoch + 1) & 0xFFFF
        self._session = LinkSession(self._host_epoch, BAUD)
        self._forget()

    def _await_watchdog(self) -> None:
        """Run the program that hangs 2 s after arming; arm it where it is not armed yet."""
        before = self._rig.board.stats()["watchdog_resets"]
        answer = self.now - ASKING
        while self._rig.board.stats()["watchdog_resets"] == before:
            if not self._rig.board.fins().powered and self.now >= answer + ASKING:
                answer = self.now
                self._say_start(self._boot or 0)
            self._run(STEP)

    def _set_noise(self, noisy: bool) -> None:
        self._noisy = noisy
        board = self._rig.board
        board.seed_line(self._chance.getrandbits(31))
        for direction in _DIRECTIONS:
            board.clean_line(direction)
            if noisy:
                for kind, rate in _NOISE:
                    board.disturb_line(direction, kind, rate)
                board.burst_line(direction, *_BURST)

    # Time, and the received bytes

    def _until(self, condition: Callable[[], bool], patience: float) -> bool:
        end = self.now + patience
        while not condition():
            if self.now >= end:
                return False
            self._run(min(STEP, end - self.now))
        return True

    def _run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            if self.joined and self.now >= self._commanded + COMMAND:
                self._commanded = self.now
                self._say(_SWIM)
            data = self._session.poll(self.now)
            if data:
                self._rig.port.write(data)
            step = max(min(STEP, end - self.now), 1e-5)
            self._rig.board.run(step)
            self.now += step
            for message in self._session.receive(self._rig.port.read(), self.now):
                self._hear(message)
            if not self._may_be_armed and self._rig.board.fins().powered:
                self._problem("armed by itself", "motor power is on")

    def _hear(self, message: BoardMessage) -> None:
        if message.type == Hello.type:
            boot = Hello.from_bytes(message.payload).epoch
            if boot != self._boot:
                self._boot = boot
                self._forget()
        elif message.type == Status.type:
            self._see(Status.from_bytes(message.payload))
        elif message.type == BoardEvent.type:
            event = BoardEvent.from_bytes(message.payload)
            self._read(event.time, describe_event(event).text)

    def _see(self, status: Status) -> None:
        if status.epoch != self._boot:
            self._problem("stale", f"a STATUS of boot {status.epoch} and not {self._boot}")
        if (
            not self.joined
            and self._session.stage is SessionStage.ESTABLISHED
            and status.epoch != self._last_boot
        ):
            self.joined = True
            self._may_be_armed = False
            self._joined_at = status.time
            self._dropped_before = status.debug_lost
        self._dropped = status.debug_lost - self._dropped_before
        if status.flags & StatusFlag.ARMED and not self._may_be_armed:
            self._problem("armed by itself", f"STATUS says so: {status}")

    def _read(self, time: int, text: str) -> None:
        if (time, text) in self._lines:
            self._problem("twice", f"{text} at {time}")
        elif self._lines and time < self._lines[-1][0]:
            self._problem("out of order", f"{text} at {time}, after {self._lines[-1]}")
        self._lines.append((time, text))
        # Answers to requests of an earlier host may arrive at this one.
        if self.joined and time > self._joined_at and (text.startswith(_REFUSED) or text == "armed"):
            self._answers.append(text)

    def _forget(self) -> None:
        self._lines: list[tuple[int, str]] = []
        self._answers: list[str] = []
        self._asked: list[int] = []
        self._joined_at = 0
        self._dropped = self._dropped_before = 0

    def _check_answers(self) -> None:
        """Check that the answers match the requests in order; dropped lines are left out."""
        asked = iter(self._asked)
        for answer in self._answers:
            if not any((epoch >= _NO_SUCH_BOOT) == (answer == _OTHER_BOOT) for epoch in asked):
                self._problem("twice or out of order", f"{self._answers} to {self._asked}")
                return

    def _problem(self, kind: str, message: str) -> None:
        self.report.problems[kind] += 1
        if len(self.report.words) < 20:
            self.report.words.append(f"{self.now:.3f} s: {kind}: {message}")


def prepare() -> None:
    """Build the board and its programs."""
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware", "robot", "hang")


def measure(program: str, kinds: Sequence[Reset], resets: int, seed: int) -> ResetReport:
    """Run at least this many resets of these kinds; the same for the same seed."""
    with TemporaryDirectory() as folder, ResetTrial(Path(folder), program, seed) as world:
        world.join()
        while world.report.resets.total() < resets:
            world.case(kinds)
    return world.report


def measure_all(resets: int, seed: int = 0) -> ResetReport:
    """Run at least this many resets, in two processes."""
    prepare()
    hangs = resets // 8
    half = -(-(resets - hangs) // 2)
    others = RESETS[:-1]
    with processes(2) as pool:
        parts = [
            pool.submit(measure, "robot", others, half, 2 * seed),
            pool.submit(measure, "robot", others, half, 2 * seed + 1),
            pool.submit(measure, "robot_hang", ("watchdog",), hangs, seed),
        ]
        return sum((part.result() for part in parts), ResetReport())
