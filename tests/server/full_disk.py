"""`python -m tests.server.full_disk FOLDER ACT`: record on a disk that fills up and is freed again.

FOLDER is on a disk of its own. ACT is "record"; or "film": then a film is recorded beside; or "purge": then
room comes from a session that is removed.
Tells in JSON what came of it.
"""

import asyncio
import json
import os
import random
import sqlite3
import sys
from collections.abc import Awaitable, Callable
from contextlib import closing, suppress
from io import BytesIO
from math import inf
from pathlib import Path
from time import time
from typing import Any

from sqlalchemy import update

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.experiments.scenario.library import shipped_scenarios
from robot_runtime.transport.blocks import Block, row
from robot_runtime.vision.film import open_coder
from server.features.backup.command import back_up
from server.features.comm_tests.runs import CommTestStore
from server.features.scenarios.library import keep_scenario
from server.library.catalogue import Catalogue
from server.library.content import Recording
from server.library.film import film_from, write_mp4
from server.library.listing import Listing
from server.library.retention import RetentionWorker
from server.platform.disk_reserve import DiskReserve
from server.platform.disk_space import FileWriteError
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, SetupError, make_folders
from server.platform.store import Store, StoreError
from server.recording.recorder import BACKLOG_BYTES, PERIOD, Recorder
from server.recording.session import find_row, new_row
from tests.film import HEIGHT, RATE, WIDTH, code_numbers, read_film
from tests.server.blocks import depth_block, depth_record, film_block
from tests.server.features.comm_tests.stored_runs import LOST, begin

DEPTHS = 50
"""Samples a second."""
FILLER = b"\0\0\1\x0c" + 40_000 * b"\xff"
"""A unit of H.264 that decoders pass over."""
LEFT_BYTES = 400_000
"""Room for the database when recording begins."""
COUNT = 1000
FULL_TIMES = 5
LONG = {**LOST.values, "explanation": "why " * 50_000}
"""A cell that does not fit into what room is left in the database's own files."""


def noisy_block(first: int, chance: random.Random) -> Block:
    """Rows that compression cannot shrink."""
    size = len(depth_record(0).to_bytes())
    rows = b"".join(row(first + position, chance.randbytes(size)) for position in range(COUNT))
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
    fill(ballast, LEFT_BYTES)
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
        keep_scenario(data.scenarios, shipped_scenarios()["figure_14"].replace('"figure_14"', '"mine"', 1))

    async def copy() -> None:
        back_up(data, data.config, data.path / "copy.db")

    return [lambda: runs.add(run, 1, LONG), keep, copy]


async def refusal(work: Callable[[], Awaitable[object]]) -> str:
    """Return the text of the refusal; "" without one."""
    try:
        await work()
    except (StoreError, FileWriteError, SetupError) as problem:
        return str(problem)
    return ""


async def film(data: DataFolder, config: Path) -> dict[str, Any]:
    """Record a dive with its film; the disk is full for longer than memory holds the film."""
    settings, clock = Settings(data=data, config=config), SimulatedClock()
    store, notices = Store(data.database), list[str]()
    sender = Notices(clock, lambda block: notices.append(block.payload.decode()))
    recorder = Recorder(store, clock, sender, lambda: None)
    storing = asyncio.create_task(recorder.run())
    session = await recorder.start(new_row(settings, clock, "full", "", "null"))
    recording = Recording(store, find_row(store, session.id))
    ballast = data.path / "ballast"
    fill(ballast, 6 * LEFT_BYTES)
    coder, seconds = open_coder(RATE, "medium", (WIDTH, HEIGHT)), 0

    def add_second() -> None:
        nonlocal seconds
        first = seconds * round(RATE)
        recorder.add(depth_block(seconds * DEPTHS, DEPTHS, start=float(seconds)))
        pictures = code_numbers(coder, range(first, first + round(RATE)), float(seconds))
        for number, (taken, picture) in enumerate(pictures, first):
            recorder.add(film_block(number, taken, picture + FILLER))
        seconds += 1

    while store.failing is None:
        add_second()
        # The recorder stores by itself, and says that it cannot.
        await asyncio.sleep(PERIOD)
    full, refused = recording.counts()["film"], seconds
    while (seconds - refused) * RATE * len(FILLER) < 1.5 * BACKLOG_BYTES:
        add_second()
        with suppress(StoreError):
            await recorder.flush()
    ballast.unlink()
    add_second()
    done = await recorder.stop(session.id)
    storing.cancel()
    shown = BytesIO()
    write_mp4(film_from(recording, -inf, inf), shown)
    report = {
        "told": [text for text in notices if "Nothing can be stored" in text],
        "state": done.state,
        "full": full,
        "sent": {"depth": seconds * DEPTHS, "film": seconds * round(RATE)},
        "stored": recording.counts(),
        "shown": [number for _, number in read_film(shown.getvalue())],
        "missed": Listing(store).detail(session.id).model_dump(include={"gaps"})["gaps"],
    }
    store.close()
    return report


async def purge(data: DataFolder, config: Path) -> dict[str, Any]:
    """Record until not a byte is left, and remove the session."""
    settings, clock, chance = Settings(data=data, config=config), SimulatedClock(), random.Random(1)
    store = Store(data.database)
    notices = Notices(clock, lambda _: None)
    recorder, catalogue = Recorder(store, clock, notices, lambda: None), Catalogue(store)
    retention = RetentionWorker(store, settings, notices, clock)
    await retention.apply(time())
    reserved = data.reserve.stat().st_size
    sessions, first = [], 0
    for name in ("old", "new"):
        sessions.append((await recorder.start(new_row(settings, clock, name, "", "null"))).id)
        for _ in range(20 if name == "old" else 10_000):
            recorder.add(noisy_block(first, chance))
            first += COUNT
            try:
                await recorder.flush()
            except StoreError:
                break
        if name == "old":
            await recorder.stop(sessions[0])
    fill(data.path / "ballast", 0)
    refused = await refusal(lambda: store.execute(update(SessionRow).values(note="x" * 100_000)))
    await catalogue.delete(sessions[0])
    await catalogue.purge(sessions[0])
    await retention.apply(time())
    given_up = not data.reserve.exists()
    listed = [session.id for session in Listing(store).page().sessions]
    (data.path / "ballast").unlink()
    await recorder.stop(sessions[1])
    await catalogue.delete(sessions[1])
    await catalogue.purge(sessions[1])
    await retention.apply(time())
    store.close()
    DiskReserve(data.reserve).make()
    return {
        "reserved": reserved,
        "refused": refused,
        "given_up": given_up,
        "listed": [sessions.index(entry) for entry in listed],
        "reserved_again": data.reserve.exists() and data.reserve.stat().st_size,
    }


def fill(path: Path, remaining: int) -> None:
    """Write a file that leaves this many bytes of the disk."""
    free = os.statvfs(path.parent)
    with path.open("wb") as file:
        file.write(bytes(max(free.f_bavail * free.f_frsize - remaining, 0)))


def main() -> None:
    data = DataFolder(Path(sys.argv[1]) / "data")
    make_folders(data)
    prepare(data)
    config = data.path / "robot.toml"
    config.touch()
    report = asyncio.run({"record": record, "film": film, "purge": purge}[sys.argv[2]](data, config))
    with closing(sqlite3.connect(data.database)) as database:
        (report["integrity"],) = database.execute("PRAGMA integrity_check").fetchone()
        report["gaps"] = database.execute("SELECT kind FROM gap").fetchall()
        chunks = database.execute("SELECT first, count FROM chunk ORDER BY number").fetchall()
    ends = [0, *(first + count for first, count in chunks)]
    report["holes"] = sum(first != end for (first, _), end in zip(chunks, ends, strict=False))
    sys.stdout.write(json.dumps(report))


if __name__ == "__main__":
    main()
