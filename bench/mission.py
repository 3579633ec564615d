"""Missions: a tick of 30 steps, memory and time of the first load, and a trial of 20 seeds.

Ticks are those of the mission node, with its limits and reports. Times are of the processor, so that other
work does not count.
"""

import gc
import json
import resource
import subprocess
import sys
import time
import tracemalloc
from dataclasses import asdict
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import Config
from robot_runtime.contract.missions import NO_LIMITS
from robot_runtime.core import Core
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.missions.library import shipped_missions
from robot_runtime.missions.node import MissionRunner
from robot_runtime.transport.outbox import Outbox
from robot_runtime.vision.node import VisionNode

STEPS = 30
TICK = 0.1
"""s between two ticks of the control loop."""
TICKS, ROUNDS = 500, 5
SEEDS = 20
TRIED = "two_depths"
_CONDITIONS = ", ".join(["{ do = 'is', above = 9 }"] * (STEPS - 3))
TEXT = (
    "format = 1\nname = 'bench'\n[limits]\ndepth = 3\n[mission]\ndo = 'sequence'\nsteps = ["
    f"{{ do = 'while_true', steps = [{_CONDITIONS}, {{ do = 'hold', seconds = 3000, within = 10 }}] }}]\n"
)
"""All of its steps are ticked each time, which is the most that they can take."""


def measure() -> dict[str, float]:
    """Return µs of a tick, kB of a running mission, ms and MB of the first load, processor s of a trial."""
    first = _ask("load")
    return {
        "mission.tick_us": _tick(),
        "mission.memory_kb": _ask("memory")["kilobytes"],
        "mission.load_ms": 1000 * first["seconds"],
        "mission.load_mb": first["megabytes"],
        "mission.try_s": _try(),
    }


class _Swimming:
    """A robot without a board, and its mission."""

    def __init__(self) -> None:
        self.clock, config = SimulatedClock(), Config()
        line = LinkDriver("", config.link.baud, self.clock, 1, lambda _: None, lambda: None)
        outbox = Outbox(lambda *_: None, lambda _: False)
        open_vision = partial(VisionNode, config.vision, self.clock)
        self.runner: MissionRunner = Core(
            config, self.clock, "", line, outbox, watched=lambda _: False, open_vision=open_vision
        ).missions

    def begin(self) -> None:
        """Load and begin the mission."""
        self.runner.prepare(self.runner.load(TEXT, {}))
        self.tick(20)

    def tick(self, count: int) -> None:
        """Run so many ticks in automatic."""
        for _ in range(count):
            self.runner.tick("automatic")
            self.clock.forward(TICK)


def _tick() -> float:
    swimming = _Swimming()
    swimming.begin()
    durations = []
    for _ in range(ROUNDS):
        began = time.process_time()
        swimming.tick(TICKS)
        durations.append((time.process_time() - began) / TICKS * 1e6)
    assert swimming.runner.active
    assert swimming.runner._run is not None
    assert len(list(swimming.runner._run.document.root.walk())) == STEPS
    return median(durations)


def _try() -> float:
    asked = {"text": shipped_missions()[TRIED], "library": {}, "limits": asdict(NO_LIMITS)}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "robot_runtime.experiments.mission_trial", "--seeds", str(SEEDS)]
    done = subprocess.run(command, input=json.dumps(asked), capture_output=True, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    results = [json.loads(line) for line in done.stdout.splitlines()]
    assert [result["phase"] for result in results] == ["succeeded"] * SEEDS
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _ask(what: str) -> dict[str, Any]:
    """Measure the first load in a process of its own, which has loaded nothing yet."""
    done = subprocess.run(
        [sys.executable, "-m", "bench.mission", what], capture_output=True, text=True, check=True
    )
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def _load() -> dict[str, float]:
    swimming = _Swimming()
    before, began = _resident(), time.process_time()
    swimming.runner.load(TEXT, {})
    return {"seconds": time.process_time() - began, "megabytes": (_resident() - before) / 1e6}


def _memory() -> dict[str, float]:
    """Return the memory of a second mission, since the first one loads the library."""
    _Swimming().begin()
    swimming = _Swimming()
    gc.collect()
    tracemalloc.start()
    swimming.begin()
    gc.collect()
    return {"kilobytes": tracemalloc.get_traced_memory()[0] / 1e3}


def _resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


if __name__ == "__main__":
    print(json.dumps({"load": _load, "memory": _memory}[sys.argv[1]]()))
