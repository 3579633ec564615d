"""Recorded sessions of given blocks, for tests of everything that reads sessions."""

import asyncio

from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import new_row

STARTED_STEADY = 99.5


def record(
    store: Store, settings: Settings, *batches: list[Block], name: str = "Dive no. 1: Öresund/../x"
) -> int:
    """Record these batches, where no event loop runs. Return the session's number."""
    return asyncio.run(record_batches(store, settings, *batches, name=name))


async def record_batches(
    store: Store, settings: Settings, *batches: list[Block], name: str = "Dive no. 1: Öresund/../x"
) -> int:
    """Record these batches, each in a commit of its own. Return the session's number."""
    clock = SimulatedClock(STARTED_STEADY)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    session = await recorder.start(new_row(settings, clock, name, "calm", '{"mode": "disarmed"}'))
    for batch in batches:
        for block in batch:
            recorder.add(block)
        await recorder.flush()
    await recorder.stop(session.id)
    return session.id
