"""Cycle through all faults while the robot records: `python -m tests.proofs.chaos 3600`; status 1 for losses.

Noise and cuts on the serial line, processes killed and stopped, pages that read slowly or not at all, a disk
that fills up, a wall clock that jumps, one after the other at random. Afterwards what was counted must be
what was done: each kill an alarm in the session, each restart a gap of its kind, no other gap or hole, and as
many rows that a slow page missed as it was told of. In the second half nobody is killed, and memory must not
grow once what is held of the last minutes is full.

The disk is a small one in a mount namespace of its own, as anybody may have it; where the system forbids
that, it is not filled. The clock jumps for the robot's processes alone (`wall_clock.c`).
"""

import json
import os
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from statistics import linear_regression, quantiles
from tempfile import TemporaryDirectory

import httpx
import psutil

from robot_runtime.contract.chunks import decode_documents
from robot_runtime.simulation.boards.emulator_process import BoardError, EmulatorClient
from server.stream.hub import HISTORY_SECONDS
from tests.proofs.counting import count
from tests.proofs.kills import row_times
from tests.proofs.outages import OutageTrial
from tests.proofs.scales import anonymous
from tests.proofs.slow_page import SlowPage
from tests.stack import ROOT, Stack
from tests.waiting import wait_for

DISK = "400m"
PAUSE = (0.5, 4.0)
"""s between two misfortunes."""
JUMPS = (-86_400, -3600, 3600, 86_400, 10 * 365 * 86_400)
"""s by which the wall clock is wrong, from now on."""
SAMPLE = 1.0
"""s between two looks at the memory."""
PARTS = ("runtime", "board", "simulator", "scene")
VICTIMS = (*PARTS, "server", "vision")
WARM_UP = HISTORY_SECONDS + 60.0
"""s without a kill in which memory may still grow; what is shorter does not show whether it does."""
GROWTH = (3.0, 6.0)
"""MB by which memory may rise after that: what faults under way take for a while, and as much an hour."""
LINE_SECONDS = (20.0, 600.0)
"""s of simulated swimming on a line that damages single frames, at most."""


@dataclass
class ChaosReport:
    """Injected faults, their effects, and the problems found."""

    seconds: float = 0.0
    done: Counter[str] = field(default_factory=Counter)
    alarms: Counter[str] = field(default_factory=Counter)
    """Recorded notices, by kind."""
    gaps: Counter[str] = field(default_factory=Counter)
    """Recorded gaps, by "kind topic"."""
    holes: Counter[str] = field(default_factory=Counter)
    """Missing numbers, by topic."""
    frames: dict[str, list[int]] = field(default_factory=dict)
    """Damaged frames and those that were counted, by direction."""
    pages: dict[str, list[int]] = field(default_factory=dict)
    """Rows that slow pages missed and those that they were told of."""
    memory: dict[str, list[float]] = field(default_factory=dict)
    """MB at the end, and MB an hour by which it grew, by process."""
    jitter: dict[str, float] = field(default_factory=dict)
    """ms between two control ticks more or less than their period."""
    samples: int = 0
    integrity: str = ""
    problems: list[str] = field(default_factory=list)


class Storm:
    """A running robot under faults."""

    def __init__(self, stack: Stack, clock: Path, seed: int, *, small_disk: bool) -> None:
        self.report = ChaosReport()
        self._chance = random.Random(seed)
        self._clock = clock
        self._world = OutageTrial(stack, self._chance)
        self._stack = stack
        self._pages = [SlowPage(self._stack, stalled=stalled) for stalled in (False, False, True, True)]
        self._memory: dict[int, tuple[str, list[tuple[float, float]]]] = {}
        self._disk_low: list[float] = []
        self._sampled = 0.0
        self._gentle: list[Callable[[], str]] = [self._noise, self._cut, self._stop, self._jump]
        if small_disk:
            self._gentle.append(self._fill_disk)

    def close(self) -> None:
        """End pages and observation."""
        for page in self._pages:
            page.close()
        self._world.close()

    def rage(self, seconds: float) -> None:
        """Inject faults for this time, the second half without kills, and count the losses."""
        session = self._stack.api.post("/sessions", json={"name": "chaos"}).json()["id"]
        began = time.monotonic()
        for gentle in (False, True):
            self._memory.clear()
            while time.monotonic() < began + seconds * (1.0 if gentle else 0.5):
                self._swim()
                self._rest(self._chance.uniform(*PAUSE))
                kinds = self._gentle if gentle else [*self._gentle, *[self._kill] * len(self._gentle)]
                what = self._chance.choice(kinds)()
                self._world.wait_well()
                self._rest(0.0)
                print(f"{time.monotonic() - began:7.1f} s {what}", file=sys.stderr, flush=True)
                self._require_recording(session)
                if what.removesuffix(" killed") in PARTS:
                    # Before the server is killed next, it must have stored the alarm, and something of a new
                    # runtime, without which the session rightly ends. Its own restart it stores at once.
                    self._wait_stored(session)
        self._world.calm()
        for page in self._pages:
            page.close()
        answer = self._ask(lambda: self._stack.api.post(f"/sessions/{session}/stop"))
        answer.raise_for_status()
        self.report.seconds = time.monotonic() - began
        self._count(session)

    def _require_recording(self, session: int) -> None:
        """Check that no fault has ended a session."""
        result = self._ask(lambda: self._stack.api.get(f"/sessions/{session}"))
        if result.is_error or result.json()["state"] != "recording":
            output = self._stack.log.read_text()[-2000:]
            raise AssertionError(f"the session does not record any more: {result.text}\n{output}")

    def _wait_stored(self, session: int) -> None:
        def stored() -> int:
            samples: int = self._ask(lambda: self._stack.api.get(f"/sessions/{session}")).json()["samples"]
            return samples

        before = stored()
        wait_for(lambda: stored() > before, "what came since to be stored")

    # Faults; each returns its name

    def _kill(self) -> str:
        name = self._chance.choice(VICTIMS)
        self.report.done[f"{name} killed"] += 1
        victim = self._world.find(name)
        victim.kill()
        wait_for(lambda: self._world.is_replaced(name, victim.pid), f"a new {name}")
        return f"{name} killed"

    def _stop(self) -> str:
        name = self._chance.choice(("server", "runtime", "simulator"))
        self.report.done["stopped"] += 1
        victim = self._world.find(name)
        victim.suspend()
        time.sleep(self._chance.uniform(0.2, 1.2))
        victim.resume()
        return f"{name} stopped"

    def _noise(self) -> str:
        self.report.done["noise"] += 1
        kind, rate = self._chance.choice((("bit_errors", 1e-4), ("drop", 1e-3), ("insert", 1e-3)))
        way = self._chance.choice(("to_board", "from_board"))
        self._line(f"line {way} {kind} {rate}", self._chance.uniform(0.5, 3.0), f"line {way} clean")
        return f"{kind} {way}"

    def _cut(self) -> str:
        self.report.done["cut"] += 1
        way = self._chance.choice(("to_board", "from_board"))
        self._line(f"line {way} cut on", self._chance.uniform(0.1, 1.5), f"line {way} cut off")
        return f"cut {way}"

    def _line(self, wrong: str, seconds: float, right: str) -> None:
        with suppress(BoardError), EmulatorClient(self._world.folder.board_socket) as board:
            board.command(wrong)
            time.sleep(seconds)
            board.command(right)

    def _jump(self) -> str:
        self.report.done["clock jumped"] += 1
        jump = self._chance.choice(JUMPS)
        self._clock.write_bytes(struct.pack("<q", jump))
        return f"clock wrong by {jump} s"

    def _fill_disk(self) -> str:
        self.report.done["disk full"] += 1
        ballast = self._world.folder.path / "ballast"
        with ballast.open("wb", buffering=0) as file:
            # Half of what is free each time: a step that finds no room gives all of it back, and would end
            # the alarm that it raised.
            size = 0
            while room := shutil.disk_usage(ballast.parent).free // 2:
                with suppress(OSError):
                    os.posix_fallocate(file.fileno(), size, room)
                    size += room
        # Storing may go on for a while, in the room that the write-ahead log has on the disk already: so
        # `store_failing` need not come. That it comes where the database refuses is in test_alarms.py, and
        # what a full disk does to a recording in test_full_disk.py.
        wait_for(lambda: self._is_reported("disk_low"), "the alarm of the full disk")
        time.sleep(self._chance.uniform(0.0, 4.0))
        ballast.unlink()
        wait_for(lambda: not self._is_reported("disk_low"), "room on the disk")
        wait_for(lambda: not self._is_reported("store_failing"), "the database to store again")
        return "disk full"

    def _is_reported(self, fault: str) -> bool:
        return any(alarm["fault"] == fault and alarm["active"] for alarm in self._world.viewer.alarms)

    # In between

    def _swim(self) -> None:
        """Arm again where the robot was stopped; a refusal is not tested here."""
        with suppress(httpx.TransportError):
            self._stack.api.post("/robot/commands/acknowledge")
            self._stack.api.post("/robot/commands/arm", json={"unwatched": 0})

    def _rest(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while True:
            if time.monotonic() > self._sampled + SAMPLE:
                self._sampled = time.monotonic()
                self._weigh()
            if time.monotonic() >= end:
                return
            time.sleep(min(0.1, max(end - time.monotonic(), 0.0)))

    def _weigh(self) -> None:
        for name in ("server", "runner", "runtime"):
            with suppress(psutil.Error, LookupError, OSError):
                process = self._world.find(name)
                weight = anonymous(process.pid) / 1e6
                _, weights = self._memory.setdefault(process.pid, (name, []))
                weights.append((time.monotonic(), weight))

    def _ask(self, question: Callable[[], httpx.Response]) -> httpx.Response:
        while True:
            with suppress(httpx.TransportError):
                return question()

    # Afterwards

    def _count(self, session: int) -> None:
        report, done = self.report, self.report.done
        for page, name in zip(self._pages, ("slow 1", "slow 2"), strict=False):
            missing, reports = page.missing.total(), page.received.total()
            report.pages[name] = [missing, reports]
            self._insist(missing == reports, f"{name}: {missing} rows missing, {reports} told")
        for name, weights in self._memory.values():
            self._judge_memory(name, [weight for weight in weights if weight[0] > weights[0][0] + WARM_UP])
        self._examine(session)
        for name in PARTS:
            self._expect(f"{name}_down", report.alarms[f"{name}_down"], done[f"{name} killed"])
        self._expect("server_restarted", report.alarms["server_restarted"], done["server killed"])
        self._expect("disk_low", report.alarms["disk_low"], done["disk full"])
        if report.alarms["disk_low"] != done["disk full"]:
            times = [f"{time:.1f}" for time in self._disk_low]
            self.report.problems.append(f"disk_low came at {', '.join(times)} s")
        self._expect("restarted state", report.gaps.pop("restarted state", 0), done["runtime killed"])
        self._expect("restarted truth", report.gaps.pop("restarted truth", 0), done["simulator killed"])
        others = {name: count for name, count in report.gaps.items() if not name.startswith("restarted ")}
        self._insist(not others, f"gaps: {others}")
        self._insist(not report.holes, f"holes: {dict(report.holes)}")
        self._insist(report.integrity == "ok", f"the database is damaged: {report.integrity}")

    def _judge_memory(self, name: str, weights: list[tuple[float, float]]) -> None:
        """MB by time (s) of a process that is warm."""
        if len(weights) < 2:
            return
        slope, took = linear_regression(*zip(*weights, strict=True)).slope, weights[-1][0] - weights[0][0]
        self.report.memory[name] = [round(weights[-1][1], 1), round(3600 * slope, 1)]
        noise, rate = GROWTH
        most = noise + rate * took / 3600
        grown = f"{name}: memory rose by {slope * took:.1f} MB in {took / 60:.0f} minutes"
        self._insist(slope * took <= most, f"{grown}; the limit is {most:.1f} MB")

    def _expect(self, what: str, counted: int, injected: int) -> None:
        self._insist(counted == injected, f"{what}: {counted} counted, {injected} injected")

    def _insist(self, holds: bool, problem: str) -> None:
        if not holds:
            self.report.problems.append(problem)

    def _examine(self, session: int) -> None:
        report, ends, ticks = self.report, dict[str, int](), list[float]()
        with closing(sqlite3.connect(self._world.folder.database)) as database:
            (report.integrity,) = database.execute("PRAGMA integrity_check").fetchone()
            query = "SELECT state, started_steady FROM session WHERE id = ?"
            state, started = database.execute(query, (session,)).fetchone()
            self._insist(state == "complete", f"the session is {state}")
            gaps = database.execute("SELECT kind, topic FROM gap WHERE session_id = ?", (session,))
            report.gaps = Counter(f"{kind} {topic}" for kind, topic in gaps)
            chunks = database.execute(
                "SELECT topic, first, count, data FROM chunk WHERE session_id = ? ORDER BY topic, number",
                (session,),
            )
            for topic, first, number, data in chunks:
                # Below what is expected its sender has begun to count anew.
                if first > ends.get(topic, first):
                    report.holes[topic] += first - ends[topic]
                ends[topic] = first + number
                report.samples += number
                if topic == "control":
                    ticks += row_times(topic, data)
                elif topic == "notice":
                    notices = list(decode_documents(data))
                    report.alarms.update(notice["kind"] for notice in notices)
                    self._disk_low += [
                        notice["time"] - started for notice in notices if notice["kind"] == "disk_low"
                    ]
        late = [1000 * abs(after - before - 0.1) for before, after in pairwise(ticks)]
        cuts = quantiles(late, n=1000)
        report.jitter = {"p50": round(cuts[499], 2), "p99": round(cuts[989], 2), "max": round(max(late), 1)}


def storm(folder: Path, seconds: float, seed: int, *, small_disk: bool) -> ChaosReport:
    """Run all faults in this folder; `small_disk`: it is a small disk of its own."""
    library, clock = folder / "wall_clock.so", folder / "wall_clock"
    clock.write_bytes(struct.pack("<q", 0))
    source = Path(__file__).with_name("wall_clock.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-o", str(library), str(source), "-ldl"], check=True)
    os.environ |= {"LD_PRELOAD": str(library), "MUCAT_WALL_CLOCK": str(clock)}
    with Stack(folder / "data") as stack:
        item = Storm(stack, clock, seed, small_disk=small_disk)
        try:
            item.rage(seconds)
        finally:
            item.close()
    del os.environ["LD_PRELOAD"]
    to_host, to_board = count(min(max(seconds / 6, LINE_SECONDS[0]), LINE_SECONDS[1]), seed)
    report = item.report
    report.frames = {
        "to host": [to_host.damaged, to_host.invalid],
        "unreliable to host": [to_host.unreliable, to_host.missed],
        "to board": [to_board.damaged, to_board.invalid],
    }
    for way, (damaged, counted) in report.frames.items():
        if damaged != counted or not damaged:
            report.problems.append(f"frames {way}: {damaged} damaged, {counted} counted")
    return report


def run(seconds: float, seed: int, folder: Path) -> str:
    """Run in another process, on a small disk where the system permits; return its report as JSON."""
    command = [sys.executable, "-m", "tests.proofs.chaos", str(seconds), str(seed), str(folder)]
    mount = f'mount -t tmpfs -o size={DISK} tmpfs "{folder}" && exec "$@"'
    namespace = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount, "sh"]
    try:
        can = subprocess.run([*namespace, "true"], capture_output=True).returncode == 0
    except FileNotFoundError:
        can = False
    command = [*namespace, *command, "small"] if can else command
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        try:
            return process.communicate()[0]
        except KeyboardInterrupt:
            # It was interrupted as well, and ends its robot.
            process.wait()
            raise


def main() -> int:
    """Exit status."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 3600.0
    if len(sys.argv) > 3:
        seed, folder = int(sys.argv[2]), Path(sys.argv[3])
        small = sys.argv[4:] == ["small"]
        report = storm(folder, seconds, seed, small_disk=small)
        print(json.dumps(vars(report), indent=2))
        return 1 if report.problems else 0
    with TemporaryDirectory(prefix="mucat-") as name:
        text = run(seconds, int(time.time()), Path(name))
    print(text)
    return 0 if text and not json.loads(text)["problems"] else 1


if __name__ == "__main__":
    sys.exit(main())
