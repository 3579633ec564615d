"""Speed of the recorder, and size of its samples in SQLite."""

import asyncio
import tempfile
import time
from pathlib import Path

from bench.dive import Dive
from bench.hour import CONFIG, STARTED_STEADY
from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from server.recording.recorder import PERIOD, Recorder
from server.recording.session import new_row

SECONDS = 300.0


def measure() -> dict[str, float]:
    """Record everything that the robot sends in five minutes at full rate, as fast as possible."""
    dive = Dive(STARTED_STEADY, SECONDS, 1)
    steps = round(SECONDS / PERIOD)
    batches = [list(dive.until(STARTED_STEADY + (step + 1) * PERIOD)) for step in range(steps)]
    samples = sum(block.count for batch in batches for block in batch)
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(data=DataFolder(Path(folder)), config=CONFIG)
        make_folders(settings.data)
        prepare(settings.data)
        store = Store(settings.data.database)
        took = asyncio.run(_record(store, settings, batches))
        store.close()
        size = settings.data.database.stat().st_size
    return {
        "store.ingest_rows_per_s": samples / took,
        "store.ingest_ratio": samples / took / (samples / SECONDS),
        "store.bytes_per_sample": size / samples,
    }


async def _record(store: Store, settings: Settings, batches: list[list[Block]]) -> float:
    clock = SimulatedClock(STARTED_STEADY)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    session = await recorder.start(new_row(settings, clock, "bench", "", "{}"))
    began = time.perf_counter()
    for batch in batches:
        clock.forward(PERIOD)
        for block in batch:
            recorder.add(block)
        await recorder.flush()
    took = time.perf_counter() - began
    await recorder.stop(session.id)
    return took
