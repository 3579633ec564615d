"""Kills or stops processes of an armed or disarmed robot: the fins must stop, and all must recover.

The whole robot as a person starts it, in real time; the fins are watched from outside, at the board.
"""

import os
import random
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

import httpx
import psutil

from robot_runtime.transport.lifetime import HEARTBEAT
from robot_runtime.transport.zenoh_transport import join
from server.platform.settings import DataFolder
from server.processes.supervisor import HEARTBEAT_SECONDS
from tests.proofs.pool import processes
from tests.proofs.watching import FinWatch, Viewer, find_silence
from tests.stack import Stack
from tests.waiting import wait_for

Blow = Literal["kill", "stop", "hang"]
"""Ended; stopped for a while; stopped until somebody ends it."""

NEUTRAL, DISARMED = 0.5, 1.015
"""s of silence after which the chip alone has brought the fins to rest, and taken their power: it looks every
10 ms, and is looked at every 4."""
SERVER_SILENT = 5.0
"""s after which a robot whose server is silent is stopped."""
AGAIN = 2.0
"""s within which all is well again after something was killed. Each that is later is counted, and
`make faults` fails for it; `make test` does not, since other tests run on the same processors meanwhile."""
ALWAYS = ("state", "depth", "truth")
STEADY = 1.0
"""s for which at most the next blow is waited for."""
STARVED = 0.4
"""s without a processor after which a robot may have had to stop: a depth half a second old is too old."""


@dataclass(frozen=True, slots=True)
class Outage:
    """The process and its fault, the alarm, and the limits in s for the fins to rest and lose power.

    Of the runtime they count from its last byte at the chip, which a busy computer passes on late.

    Where these are None the robot goes on, armed if it was.
    """

    victim: str
    blow: Blow
    alarm: str | None
    rest: float | None = None
    off: float | None = None
    lasts: float = 0.0
    """s for which it is stopped before it goes on."""

    @property
    def name(self) -> str:
        """The outage as one word."""
        text = {"kill": "killed", "stop": "hung", "hang": "hung_for_good"}
        return f"{self.victim}_{text[self.blow]}"


OUTAGES = (
    Outage("runtime", "kill", "runtime_down", NEUTRAL, DISARMED),
    Outage("runtime", "stop", "runtime_silent", NEUTRAL, DISARMED, lasts=3.0),
    Outage("runtime", "hang", "runtime_silent", NEUTRAL, DISARMED),
    Outage("vision", "kill", None),
    Outage("server", "kill", "server_restarted"),
    Outage("server", "stop", "server_silent", SERVER_SILENT, SERVER_SILENT, lasts=5.5),
    Outage("simulator", "kill", "simulator_down", 1.0, 1.0),
    Outage("simulator", "stop", "simulator_silent", 1.0, 1.0, lasts=3.0),
    Outage("scene", "kill", "scene_down"),
    Outage("board", "kill", "board_down", 0.1, 0.1),
)


@dataclass
class OutageOutcome:
    """Result of one outage: s after the fault, and problems."""

    outage: Outage
    armed: bool
    reported: float = 0.0
    """Until the page showed the alarm."""
    rest: float = 0.0
    off: float = 0.0
    unheard: float = 0.0
    """The longest time between two heartbeats of a server, as somebody else hears them."""
    starved: float = 0.0
    """For which the one of the processes that swim that waited longest had work, and no processor."""
    again: float = 0.0
    """Until everything was well again; after what was stopped went on, from then."""
    problems: list[str] = field(default_factory=list)

    @property
    def is_slow(self) -> bool:
        """True if the recovery took too long. `make faults` fails for it.

        It is not among the `problems`, for which `make test` fails: other robots run on the same cores
        there, and most of a recovery is CPU time.
        """
        return self.again > AGAIN


class OutageTrial:
    """Observers of a running robot, and its outages."""

    def __init__(self, stack: Stack, chance: random.Random) -> None:
        self.stack = stack
        self.folder = DataFolder(stack.data)
        self._chance = chance
        self.fins = FinWatch(self.folder.board_socket)
        self.viewer = Viewer(self.stack)

    def close(self) -> None:
        """End the observation."""
        self.viewer.close()
        self.fins.close()

    def inject(self, outage: Outage, armed: bool) -> OutageOutcome:
        """Wait until all is well, arm if `armed`, cause the outage, and measure its effects."""
        self.calm()
        if armed:
            self.arm()
        outcome = OutageOutcome(outage, armed)
        with self._hearing() as heard, self._starving(outcome):
            time.sleep(self._chance.uniform(0, STEADY))
            outcome.again = self._strike(outcome)
        outcome.unheard = max((after - before for before, after in pairwise(heard)), default=0.0)
        self._judge(outcome)
        return outcome

    @contextmanager
    def _hearing(self) -> Iterator[list[float]]:
        """Note when the server's heartbeats come by (s, steady clock)."""
        heard: list[float] = []
        runtime = f"unixsock-stream/{self.folder.runtime_socket}"
        with join("turtle", [runtime]) as messages:
            messages.subscribe(HEARTBEAT, lambda *_: heard.append(time.monotonic()))
            wait_for(lambda: heard, "a heartbeat")
            yield heard

    @contextmanager
    def _starving(self, outcome: OutageOutcome) -> Iterator[None]:
        """Note how long runtime, simulator and board have waited for a processor, as the kernel counts it."""
        swimmers = [self.find(name) for name in ("runtime", "simulator", "board")]
        before = [_waited_for_processor(process.pid) for process in swimmers]
        yield
        outcome.starved = max(
            _waited_for_processor(process.pid) - waited
            for process, waited in zip(swimmers, before, strict=True)
        )

    def _strike(self, outcome: OutageOutcome) -> float:
        """Cause the outage; return s until all is well again."""
        outage = outcome.outage
        victim = self.find(outage.victim)
        since = time.monotonic()
        if outage.blow == "kill":
            victim.kill()
            self._see(outcome, since)
            since_up = wait_for(lambda: self.is_replaced(outage.victim, victim.pid), f"a new {outage.victim}")
        elif outage.blow == "hang":
            victim.suspend()
            self._see(outcome, since)
            since_up = since = wait_for(
                lambda: self.is_replaced(outage.victim, victim.pid), f"a new {outage.victim}"
            )
        else:
            victim.suspend()
            self._see(outcome, since)
            while time.monotonic() < since + outage.lasts:
                time.sleep(0.01)
            since_up = since = time.monotonic()
            os.kill(victim.pid, signal.SIGCONT)
        topics = (*ALWAYS, "detection") if outage.victim == "vision" else ALWAYS
        return wait_for(lambda: self.well(since_up, topics), f"all to be well after {outage.name}") - since

    def _see(self, outcome: OutageOutcome, since: float) -> None:
        outage = outcome.outage
        alarm = outage.alarm
        if alarm is not None and not (outage.victim == "server" and outage.blow == "stop"):
            outcome.reported = wait_for(lambda: self.viewer.tells(alarm), f"the alarm {alarm}") - since
        if outcome.armed and outage.off is not None:
            wait_for(lambda: self.fins.seen[-1].time > since and not self.fins.seen[-1].powered, "no power")
            begun = find_silence(self.fins.seen, since) if outage.victim == "runtime" else since
            outcome.rest, outcome.off = self.fins.moved_for(begun), self.fins.powered_for(begun)

    def _judge(self, outcome: OutageOutcome) -> None:
        outage, problems = outcome.outage, outcome.problems
        armed = bool(self.viewer.state["armed"])
        if armed and not (outcome.armed and outage.off is None):
            problems.append("it came up armed")
        # A server that comes up late is slow; a robot that had to stop meanwhile has done right. So has one
        # that other work keeps from its processor.
        right = outcome.starved >= STARVED or (
            outage.victim == "server" and outcome.unheard >= HEARTBEAT_SECONDS
        )
        if not armed and outcome.armed and outage.off is None and not right:
            alarms = "; ".join(
                f"{alarm['fault']} since {alarm['since']:.1f} s ({alarm['what']})"
                for alarm in self.viewer.alarms
            )
            problems.append(f"it was stopped, with the alarms {alarms}")
        if outage.rest is not None and outcome.rest > outage.rest:
            problems.append(f"the fins moved for {outcome.rest:.2f} s")
        if outage.off is not None and outcome.off > outage.off:
            problems.append(f"the motors had power for {outcome.off:.2f} s")

    def calm(self) -> None:
        """Disarm, acknowledge, and wait until all is well."""
        self.wait_well()
        # Refused where the runtime does not answer in time, on a busy computer.
        wait_for(lambda: self.stack.api.post("/robot/stop").is_success, "the robot to be stopped")
        wait_for(self._is_calm, "no alarm")

    def _is_calm(self) -> bool:
        """Acknowledge what there is; on a busy computer another alarm may come after the last one."""
        acknowledged = self.stack.api.post("/robot/commands/acknowledge").is_success
        return acknowledged and not self.viewer.alarms and not self.viewer.state["armed"]

    def wait_well(self) -> None:
        """Wait until all is well, by data from now on."""
        since = time.monotonic()
        wait_for(lambda: self.well(since), "all to be well")

    def arm(self) -> None:
        """Arm, and wait for power and moving fins."""
        wait_for(
            lambda: self.stack.api.post("/robot/commands/arm", json={"unwatched": 0}).status_code == 204,
            "the robot to arm",
        )
        try:
            wait_for(lambda: self.fins.seen[-1].powered and self.fins.seen[-1].moving, "the fins to move")
        except AssertionError as problem:
            raise AssertionError(f"{problem}: {self.viewer.state}; {self.fins.seen[-1]}") from problem

    def find(self, name: str) -> psutil.Process:
        """Return the process of this name."""
        if name == "server":
            return self.stack.server
        if name == "runner":
            return self.stack.process
        return self.stack.part(name)

    def is_replaced(self, name: str, pid: int) -> bool:
        """Return True if a new process has this name."""
        try:
            return self.find(name).pid != pid
        except (LookupError, psutil.Error):
            return False

    def well(self, since: float, topics: tuple[str, ...] = ALWAYS) -> bool:
        """Return True if all parts are well, by data of these topics since then."""
        if not self.viewer.fresh(topics, since) or not self.viewer.state["connected"]:
            return False
        try:
            health = self.stack.api.get("/health", timeout=1.0).json()
        except (httpx.TransportError, ValueError):
            return False
        return bool(health["status"] == "ok")


def _waited_for_processor(pid: int) -> float:
    """Return s for which the threads of a process were ready to run, and did not; 0 where it has ended."""
    tasks = Path(f"/proc/{pid}/task")
    try:
        counted = [int((task / "schedstat").read_text().split()[1]) for task in tasks.iterdir()]
    except OSError:
        return 0.0
    return sum(counted) / 1e9


def measure_all(times: int, seed: int, robots: int, tell: Callable[[str], None]) -> list[OutageOutcome]:
    """Run each outage so often altogether, on several robots at once; `tell` is a function of a module."""
    shares = [times // robots + (number < times % robots) for number in range(robots)]
    with processes(robots, get_context("spawn")) as pool:
        runs = [
            pool.submit(_measure_share, share, seed, number, tell)
            for number, share in enumerate(shares)
            if share
        ]
        return [outcome for run in runs for outcome in run.result()]


def _measure_share(times: int, seed: int, number: int, tell: Callable[[str], None]) -> list[OutageOutcome]:
    return measure(times, seed + number, lambda text: tell(f"robot {number + 1}: {text}"))


def measure(
    times: int, seed: int, tell: Callable[[str], None] = lambda _: None, outages: tuple[Outage, ...] = OUTAGES
) -> list[OutageOutcome]:
    """Run each outage repeatedly on a robot of its own."""
    with TemporaryDirectory(prefix="mucat-") as name, Stack(Path(name) / "data") as stack:
        return measure_on(stack, times, seed, tell, outages)


def measure_on(
    stack: Stack,
    times: int,
    seed: int,
    tell: Callable[[str], None] = lambda _: None,
    outages: tuple[Outage, ...] = OUTAGES,
) -> list[OutageOutcome]:
    """Run each outage repeatedly, in any order, every other one while the robot is armed."""
    chance = random.Random(seed)
    plan = [(outage, number % 2 == 0) for outage in outages for number in range(times)]
    chance.shuffle(plan)
    outcomes = []
    world = OutageTrial(stack, chance)
    try:
        for outage, armed in plan:
            outcome = world.inject(outage, armed)
            outcomes.append(outcome)
            tell(
                f"{len(outcomes):>5} of {len(plan)}: {outage.name:<18} {'armed' if armed else '':<6}"
                f"told {outcome.reported:5.2f}  rest {outcome.rest:5.2f}  off {outcome.off:5.2f}  "
                f"again {outcome.again:5.2f}  {'; '.join(outcome.problems)}"
            )
    finally:
        world.close()
    return outcomes


def table(outcomes: Sequence[OutageOutcome]) -> str:
    """Describe the longest times, in s, for a person."""
    lines = [
        f"{'outage':<18}{'n':>5}{'told':>7}{'at rest':>9}{'no power':>10}{'again':>7}{'median':>8}{'slow':>6}"
    ]
    for outage in dict.fromkeys(outcome.outage for outcome in outcomes):
        mine = [outcome for outcome in outcomes if outcome.outage == outage]
        again = sorted(outcome.again for outcome in mine)
        stopped = (
            f"{max(outcome.rest for outcome in mine):>9.2f}{max(outcome.off for outcome in mine):>10.2f}"
        )
        lines.append(
            f"{outage.name:<18}{len(mine):>5}{max(outcome.reported for outcome in mine):>7.2f}"
            f"{'' if outage.off is None else stopped:>19}{again[-1]:>7.2f}{again[len(again) // 2]:>8.2f}"
            f"{sum(outcome.is_slow for outcome in mine):>6}"
        )
    return "\n".join(
        [*lines, *(f"{outcome.outage.name}: {text}" for outcome in outcomes for text in outcome.problems)]
    )
