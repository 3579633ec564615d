"""Hours of a dive at the robot's full rate, stored by the server's own recorder.

`python -m bench.hour DATA [--seconds S] [--sessions N]` puts it where `mucat run --data DATA` shows it.
"""

import argparse
import asyncio
import fcntl
import os
import shutil
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from bench.dive import Dive
from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from server.recording.recorder import PERIOD, Recorder
from server.recording.session import new_row

SECONDS = 3600.0
STARTED_STEADY = 5000.0
CONFIG = Path(__file__).parents[1] / "robot.toml"
SHARED = "MUCAT_BENCH_HOURS"
"""Variable with the folder in which all parts of a measurement find the recorded hours."""
_RECORDED = (1, 3)


def measure() -> dict[str, float]:
    """Return s of a processor that making and recording an hour takes; the other parts read these hours."""
    began = time.process_time()
    _provide_hours()
    return {"store.hour_s": (time.process_time() - began) / _RECORDED[-1]}


def copy_hours(data: Path, sessions: int = 1) -> list[int]:
    """Copy one or three recorded hours into a new data folder. Return the sessions' numbers."""
    shared = _provide_hours()
    shutil.copytree(shared / f"{sessions}", data, dirs_exist_ok=True)
    return list(range(1, sessions + 1))


def _provide_hours() -> Path:
    """Return the folder of the hours; the first caller records them."""
    shared = Path(os.environ[SHARED])
    with (shared / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (shared / f"{_RECORDED[-1]}").exists():
            _record_shared(shared)
    return shared


def _record_shared(shared: Path) -> None:
    growing = shared / "growing"
    for seed in range(1, _RECORDED[-1] + 1):
        if record_hour(growing, seed=seed, name=f"dive {seed}") != seed:
            raise RuntimeError("the recorded hours have other numbers")
        if seed in _RECORDED:
            shutil.copytree(growing, shared / f"{seed}")


def record_hour(
    data: Path,
    seconds: float = SECONDS,
    seed: int = 1,
    name: str = "an hour",
    more: Callable[[float], Iterable[Block]] = lambda _: (),
) -> int:
    """Record `seconds` of a dive into a data folder that no server uses. Return the session's number.

    Chunks are as long as in real time. The same seed gives the same samples. `more` gives further blocks that
    are due by a time (s since the start).
    """
    settings = Settings(data=DataFolder(data.absolute()), config=CONFIG)
    make_folders(settings.data)
    prepare(settings.data)
    store = Store(settings.data.database)
    try:
        return asyncio.run(_record(store, settings, seconds, seed, name, more))
    finally:
        store.close()


async def _record(
    store: Store,
    settings: Settings,
    seconds: float,
    seed: int,
    name: str,
    more: Callable[[float], Iterable[Block]],
) -> int:
    clock = SimulatedClock(STARTED_STEADY)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    dive = Dive(STARTED_STEADY, seconds, seed)
    session = await recorder.start(new_row(settings, clock, name, "made for measurements", "{}"))
    while clock.now() < STARTED_STEADY + seconds:
        clock.forward(min(PERIOD, STARTED_STEADY + seconds - clock.now()))
        for block in (*dive.until(clock.now()), *more(clock.now() - STARTED_STEADY)):
            recorder.add(block)
        await recorder.flush()
    await recorder.stop(session.id)
    return session.id


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench.hour", description=__doc__)
    parser.add_argument("data", type=Path, help="data folder; it is made where there is none")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="length of each session")
    parser.add_argument("--sessions", type=int, default=1, help="how many, each with noise of its own")
    arguments = parser.parse_args()
    for seed in range(1, arguments.sessions + 1):
        number = record_hour(arguments.data, arguments.seconds, seed, f"dive {seed}")
        print(f"session {number}")


if __name__ == "__main__":
    main()
