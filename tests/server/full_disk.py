"""`python -m tests.server.full_disk FOLDER`: record on a disk that fills up and is freed again.

FOLDER is on a disk of its own. Tells in JSON what came of it.
"""

import asyncio
import json
import os
import random
import sqlite3
import sys
from collections.abc import Awaitable, Callable
from contextlib import closing
from pathlib import Path
from typing import Any

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.errors import RefusedError
from robot_runtime.transport.blocks import Block, row
from server.features.backup.command import back_up
from server.features.comm_tests.runs import CommTestStore
from server.features.scenarios.library import _shipped, keep_scenario
from server.features.sessions.recorder import Recorder
from server.features.sessions.session import new_row
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, SetupError, make_folders
from server.platform.store import Store, StoreError
from tests.server.blocks import depth_record
from tests.server.features.comm_tests.stored_runs import LOST, begin

LEFT_BYTES = 400_000
"""Room for the database when recording begins."""
COUNT = 1000
FULL_TIMES = 5
LONG = {**LOST.values, "explanation": "why " * 50_000}
"""A cell that does not fit into what room is left in the database's own files."""


def noisy_block(first: int, chance: random.Random) -> Block:
    """Rows that compression cannot shrink."""
    size = len(depth_record(0).to_bytes())
    rows = b"".join(row(first + place, chance.randbytes(size)) for place in range(COUNT))
    return Block.of(BY_NAME["depth"], COUNT, first, rows)


async def record(data: DataFolder, config: Path) -> dict[str, Any]:
    """Record until the disk has been full for a while, free space, and record on."""
    settings, clock, chance = Settings(data=data, config=config), SimulatedClock(), random.Random(1)
    store = Store(data.database)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    runs = CommTestStore(store)
    run = await begin(runs)
    await runs.add(run, 0, LOST.values)
    session = await recorder.start(new_row(settings, clock, "full", "", "null"))
    ballast = data.path / "ballast"
    with ballast.open("wb") as file:
        free = os.statvfs(data.path)
        file.write(bytes(free.f_bavail * free.f_frsize - LEFT_BYTES))
    first = 0
    refusals: list[str] = []
    while len(refusals) < FULL_TIMES:
        recorder.add(noisy_block(first, chance))
        first += COUNT
        try:
            await recorder.flush()
        except StoreError as problem:
            refusals.append(str(problem))
    stored_when_full = recorder.session.samples if recorder.session else -1
    refused_beside = [await refusal(work) for work in beside(data, runs, run)]
    ballast.unlink()
    recorder.add(noisy_block(first, chance))
    done = await recorder.stop(session.id)
    for work in beside(data, runs, run):
        await work()
    cells = [cell.number for cell in runs.cells(run)]
    store.close()
    return {
        "refusals": sorted(set(refusals)),
        "sent": first + COUNT,
        "stored_when_full": stored_when_full,
        "stored": done.samples,
        "state": done.state,
        "refused_beside": refused_beside,
        "cells": cells,
    }


def beside(data: DataFolder, runs: CommTestStore, run: int) -> list[Callable[[], Awaitable[object]]]:
    """Other writes to the disk: a communication test's next cell, a scenario, a backup."""

    async def keep() -> None:
        keep_scenario(data.scenarios, _shipped()["figure_14"].replace('"figure_14"', '"mine"', 1))

    async def copy() -> None:
        back_up(data, data.path / "copy.db")

    return [lambda: runs.add(run, 1, LONG), keep, copy]


async def refusal(work: Callable[[], Awaitable[object]]) -> str:
    """The text of the refusal; "" without one."""
    try:
        await work()
    except (StoreError, RefusedError, SetupError) as problem:
        return str(problem)
    return ""


def main() -> None:
    data = DataFolder(Path(sys.argv[1]) / "data")
    make_folders(data)
    prepare(data)
    config = data.path / "robot.toml"
    config.touch()
    told = asyncio.run(record(data, config))
    with closing(sqlite3.connect(data.database)) as database:
        (told["integrity"],) = database.execute("PRAGMA integrity_check").fetchone()
        told["gaps"] = database.execute("SELECT kind FROM gap").fetchall()
        chunks = database.execute("SELECT first, count FROM chunk ORDER BY number").fetchall()
    ends = [0, *(first + count for first, count in chunks)]
    told["holes"] = sum(first != end for (first, _), end in zip(chunks, ends, strict=False))
    sys.stdout.write(json.dumps(told))


if __name__ == "__main__":
    main()
