"""`python -m tests.proofs.power_work FOLDER LOG [SYNCHRONOUS PSOW]`: a few seconds of a server's writes.

The server's own parts, on a disk whose steps are written down: a database of an older version is upgraded;
sessions are recorded, marked, renamed, tagged, deleted and removed; a communication test, exports and a
scenario are kept. After each step the log says what has been acknowledged. Without the last two, the database
is written as the product writes it.
"""

import asyncio
import hashlib
import random
import sqlite3
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

from sqlalchemy import Engine
from sqlalchemy.pool import Pool

from robot_runtime.clock import SimulatedClock, SteadyClock
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.experiments.comm_test.document import read_document
from robot_runtime.experiments.scenario.library import shipped_scenarios
from robot_runtime.transport.blocks import Block, row
from server.cli import main
from server.features.comm_tests.runs import CommTestStore
from server.features.exports.jobs import Jobs
from server.features.exports.schemas import NewExport
from server.features.scenarios.library import keep_scenario
from server.library.bookmarks import Bookmarks
from server.library.catalogue import Catalogue
from server.library.retention import RetentionWorker
from server.platform import sqlite as sqlite_module
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from server.recording.recorder import PERIOD, Recorder
from server.recording.session import find_row, new_row
from tests.proofs.disk import note
from tests.proofs.facts import read_facts
from tests.server.blocks import debug_block, depth_record
from tests.server.older import make_session, upgrade_to

FLUSHES = 24
ROWS = 400
DOCUMENT = Path(__file__).parents[2] / "firmware/examples/comm_test/figure10.json"


class Work:
    """The server's parts, with the acknowledged part of their work."""

    def __init__(self, settings: Settings, log: Path) -> None:
        self.settings = settings
        self._log = log
        self._facts: dict[str, Any] = {}
        self._chance = random.Random(1)
        self._first = 0

    def acknowledged(self) -> None:
        """Record that all stored facts are acknowledged."""
        facts = read_facts(self.settings.data.database, "ro")
        changed: dict[str, list[Any] | None] = {
            name: [value] for name, value in facts.items() if self._facts.get(name) != value
        }
        changed |= {name: None for name in self._facts if name not in facts}
        note(self._log, changed)
        self._facts = facts

    def doubtful(self, prefix: str) -> None:
        """Record that facts with this prefix are about to change: old and new values are right."""
        note(self._log, {name: None for name in self._facts if name.startswith(prefix)})
        self._facts = {name: value for name, value in self._facts.items() if not name.startswith(prefix)}

    def file(self, path: Path, *older: str) -> str:
        """Record that a file is acknowledged; `older` are checksums of permitted older content."""
        checksum = hashlib.sha256(path.read_bytes()).hexdigest()
        note(self._log, {f"file/{path.relative_to(self.settings.data.path)}": [checksum, *older]})
        return checksum

    def noise(self) -> Block:
        """Rows that compression cannot shrink."""
        size = len(depth_record(0).to_bytes())
        rows = b"".join(
            row(100.0 + (self._first + position) * 0.002, self._chance.randbytes(size))
            for position in range(ROWS)
        )
        self._first += ROWS
        return Block.of(BY_NAME["depth"], ROWS, self._first - ROWS, rows)

    async def run(self) -> None:
        """Do all of the work."""
        store = Store(self.settings.data.database)
        clock = SimulatedClock(100.0)
        recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
        catalogue = Catalogue(store, recorder)
        sessions = [await self._record(recorder, catalogue, clock, name) for name in ("one", "two")]
        await self._test(CommTestStore(store))
        await self._export(store, sessions[0])
        await asyncio.to_thread(self._look_from_a_shell)
        self._keep()
        await self._remove(store, catalogue, sessions[0])
        await self._record(recorder, catalogue, clock, "three")
        await asyncio.to_thread(store.close)

    async def _record(
        self, recorder: Recorder, catalogue: Catalogue, clock: SimulatedClock, name: str
    ) -> int:
        session = (await recorder.start(new_row(self.settings, clock, name, "", "null"))).id
        self.acknowledged()
        markers = Bookmarks(recorder._store, clock, recorder)
        for flush in range(FLUSHES):
            clock.forward(PERIOD)
            recorder.add(self.noise())
            recorder.add(debug_block(flush, f"line {flush}"))
            if flush == FLUSHES // 2:
                recorder.add(self.noise())
                self.noise()  # a hole: of it a gap is stored
                await markers.add(session, None, f"half of {name}")
            await recorder.flush()
            self.acknowledged()
        self.doubtful(f"name/{session}")
        await catalogue.change(session, name=f"{name} of them", tags=["tested", name])
        self.acknowledged()
        self.doubtful(f"state/{session}")
        await recorder.stop(session)
        self.acknowledged()
        return session

    async def _test(self, runs: CommTestStore) -> None:
        (test, *_) = read_document(DOCUMENT.read_text(encoding="utf-8"))
        run = await runs.start(test, "emulated", "00c0ffee", {}, "here")
        self.acknowledged()
        for number, cell in enumerate(test.cells[:10]):
            figures = dict.fromkeys(COUNTS, number)
            await runs.add(
                run,
                number,
                figures
                | {"baud": cell.baud, "arduino_delay": 0.0, "pi_delay": 0.0, "rate": 1.0}
                | {"answered": True, "seconds": 1.0, "causes": "", "explanation": ""},
            )
            self.acknowledged()
        self.doubtful(f"run/{run}")
        await runs.end(run, "complete")
        self.acknowledged()

    async def _export(self, store: Store, session: int) -> None:
        jobs = Jobs(self.settings.data, store, SteadyClock())
        jobs.open()
        working = asyncio.create_task(jobs.run())
        result = find_row(store, session)
        job = await jobs.add(result, NewExport(session=session, format="archive"))
        while job.state in ("waiting", "running"):
            await asyncio.sleep(0.01)
            job = jobs.find(job.id)
        assert job.state == "done", job.problem
        assert self.file(jobs.path(job)) == job.sha256
        self.file(jobs._description(job))
        working.cancel()

    def _look_from_a_shell(self) -> None:
        where = ["--data", str(self.settings.data.path), "--config", str(self.settings.config)]
        for text in (["sessions", "list"], ["commtest", "list"], ["backup"]):
            assert main([*text, *where]) == 0
        (backup,) = self.settings.data.backups.glob("mucat-backup-*.db")
        self.file(backup)

    def _keep(self) -> None:
        text = shipped_scenarios()["figure_14"].replace('"figure_14"', '"mine"', 1)
        path = self.settings.data.scenarios / "mine.toml"
        keep_scenario(self.settings.data.scenarios, text)
        before = self.file(path)
        changed = text + "# changed\n"
        after = hashlib.sha256(changed.encode()).hexdigest()
        self.file(path, after)
        keep_scenario(self.settings.data.scenarios, changed)
        assert self.file(path) == after != before

    async def _remove(self, store: Store, catalogue: Catalogue, session: int) -> None:
        for kind in ("samples", "name", "state", "chunk", "marker", "tag", "gap"):
            self.doubtful(f"{kind}/{session}")
        await catalogue.delete(session)
        await catalogue.purge(session)
        retention = RetentionWorker(
            store, self.settings, Notices(clock := SimulatedClock(), lambda _: None), clock
        )
        await retention.apply(1e9)
        self.acknowledged()


COUNTS = (
    "right",
    "out_of_sequence",
    "checksum_errors",
    "framing_errors",
    "ring_full",
    "bytes_read",
    "bytes_lost",
    "line_errors",
    "uart_overruns",
    "repeated",
)


def weaken(synchronous: str, overwrite: str) -> None:
    """Weaken the durability of the database, which the proof must detect."""
    make_durable, engine = sqlite_module.make_durable, sqlite_module.connect_to

    def make_weaker(connection: sqlite3.Connection, record: object) -> None:
        make_durable(connection, record)
        connection.execute(f"PRAGMA synchronous = {synchronous}")

    def engine_weaker(database: Path, options: str, kind: type[Pool]) -> Engine:
        return engine(database, options.replace("psow=0", f"psow={overwrite}"), kind)

    vars(sqlite_module).update(make_durable=make_weaker, connect_to=engine_weaker)


def work() -> None:
    """Run in an empty folder, with this log."""
    folder, log = Path(sys.argv[1]), Path(sys.argv[2])
    if len(sys.argv) > 3:
        weaken(*sys.argv[3:])
    data = DataFolder(folder / "data")
    make_folders(data)
    config = folder / "robot.toml"
    config.touch()
    settings = Settings(data=data, config=config)
    upgrade_to(settings, "0003")
    with closing(sqlite3.connect(data.database)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA synchronous = FULL")
        make_session(database)
    stored = Work(settings, log)
    stored.acknowledged()
    prepare(data)
    stored.acknowledged()
    asyncio.run(stored.run())


if __name__ == "__main__":
    work()
