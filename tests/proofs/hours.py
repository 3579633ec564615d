"""Hours of a dive at the robot's full rate, recorded in simulated time: `python -m tests.proofs.hours 8`.

Meanwhile retention removes an older session. Afterwards everything is read again: every sample by its
checksum, the stretch at the end as a replay, an export and a comparison give it, the archive in another
database, and the database's size. Status 1 where anything differs.
"""

import asyncio
import csv
import io
import json
import sys
import tempfile
import time
import zipfile
import zlib
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from sqlmodel import col, func, select

from bench.dive import RATES, Dive
from bench.hour import CONFIG, STARTED_STEADY
from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import BY_NAME, TIME, Kind
from robot_runtime.transport.blocks import Block, read_blocks
from server.analysis.comparer import Comparer
from server.analysis.schemas import LinesQuery, TimeRange
from server.features.exports.archive import write_archive
from server.features.exports.imports import Imports
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.features.exports.tables import write_tables
from server.library.config import SessionsConfig
from server.library.content import Recording
from server.library.replay import read_blocks_between
from server.library.retention import RetentionWorker
from server.platform.models import Chunk, Gap, SessionRow
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from server.platform.wall_clock import DAY
from server.recording.recorder import PERIOD, STANDING_SECONDS, Recorder
from server.recording.session import find_row, new_row

OLD_SECONDS = 0.1
"""Length of the older session, as a share of the dive."""
HOUR_BYTES_MAX = 45_000_000
"""Of the database, for an hour: 39 MB are measured, so a card of 16 GB has room for some 300 hours."""
CHUNK_SECONDS_MAX = 3 * PERIOD
STRETCH = 61.3
"""s at the end that replay, export and comparison read; it begins within a chunk."""


@dataclass
class RecordingReport:
    """Figures of a recording, and what was wrong with it."""

    hours: float
    samples: int = 0
    chunks: int = 0
    megabytes: float = 0.0
    megabytes_per_hour: float = 0.0
    processor_s: dict[str, float] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)

    def insist(self, holds: bool, problem: str) -> None:
        """Note a problem where something does not hold."""
        if not holds:
            self.problems.append(problem)


class Checksums:
    """Number and checksum of the samples of each topic, in order."""

    def __init__(self) -> None:
        self.counts: dict[str, int] = {}
        self.sums: dict[str, int] = {}

    def add(self, topic: str, count: int, data: bytes) -> None:
        """The next samples of a topic."""
        self.counts[topic] = self.counts.get(topic, 0) + count
        self.sums[topic] = zlib.crc32(data, self.sums.get(topic, 0))

    def add_documents(self, topic: str, documents: Iterable[object]) -> None:
        """The next documents of a topic."""
        for document in documents:
            self.add(topic, 1, json.dumps(document, sort_keys=True).encode())

    def add_block(self, block: Block) -> None:
        """A block as the robot sends it."""
        if block.topic.kind is Kind.DOCUMENTS:
            self.add_documents(block.topic.name, json.loads(block.payload))
        else:
            self.add(block.topic.name, block.count, block.payload)

    @classmethod
    def of(cls, recording: Recording) -> "Checksums":
        """Return the checksums of a recording."""
        sums = cls()
        for name, described in recording.topics.items():
            kind = BY_NAME[name].kind
            if kind is Kind.DOCUMENTS:
                sums.add_documents(name, recording.documents(name))
            elif kind is Kind.PICTURE:
                for taken, jpeg in recording.pictures(name):
                    sums.add(name, 1, TIME.pack(taken) + jpeg)
            elif kind is Kind.FILM:
                for taken, picture in recording.film():
                    sums.add(name, 1, TIME.pack(taken) + picture)
            else:
                for rows in recording.rows(name):
                    sums.add(name, len(rows) // described["row_bytes"], rows)
        return sums

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Checksums) and (self.counts, self.sums) == (other.counts, other.sums)

    __hash__ = None  # type: ignore[assignment]


class Hours:
    """A dive of this length in a data folder, and the older session before it."""

    def __init__(self, folder: Path, seconds: float) -> None:
        self.report = RecordingReport(seconds / 3600)
        self._seconds = seconds
        data = DataFolder(folder / "data")
        rules = SessionsConfig(keep_days=1.0, undo_days=seconds / 4 / DAY)
        self._settings = Settings(data=data, config=CONFIG).with_section(rules)
        make_folders(data)
        prepare(data)
        self._clock = SimulatedClock(STARTED_STEADY)
        self.store = Store(data.database)
        self._notices = Notices(self._clock, lambda _: None)
        self._recorder = Recorder(self.store, self._clock, self._notices, lambda: None)
        self._retention = RetentionWorker(self.store, self._settings, self._notices, self._clock)
        self._folder = folder
        self._old = self._session = 0
        self._sent = Checksums()

    def run(self) -> RecordingReport:
        """Record, and judge what was recorded."""
        with closing(self.store):
            for step in (
                *(self._record_old, self._record, self._judge_samples, self._judge_retention),
                *(self._judge_replay, self._judge_export, self._judge_archive, self._judge_comparison),
            ):
                began = time.process_time()
                step()
                name = step.__name__.removeprefix("_").replace("_", " ")
                self.report.processor_s[name] = round(time.process_time() - began, 1)
        return self.report

    def _record_old(self) -> None:
        self._old = asyncio.run(self._take(OLD_SECONDS * self._seconds, 2, Checksums(), ()))

    def _record(self) -> None:
        # So late that the craft of the older session is no longer in force, and does not begin this one.
        self._clock.forward(STANDING_SECONDS)
        # First the older session goes into the bin; then out of it, so late that its room is not used again.
        self._session = asyncio.run(self._take(self._seconds, 1, self._sent, (0.25, 0.95)))
        with self.store.read() as database:
            removed = database.get(SessionRow, self._old) is None
        self.report.insist(removed, "the older session is still there")

    async def _take(self, seconds: float, seed: int, sent: Checksums, tidied: tuple[float, ...]) -> int:
        """Record a dive of a seed; at these shares of its length retention is at work beside it."""
        start = self._clock.now()
        dive = Dive(start, seconds, seed)
        row = new_row(self._settings, self._clock, f"dive {seed}", "", "{}")
        if not self._old:
            row.started -= 2 * DAY
        began = row.started
        session = (await self._recorder.start(row)).id
        pending = [start + share * seconds for share in tidied]
        at_work: list[asyncio.Task[None]] = []
        while self._clock.now() < start + seconds:
            self._clock.forward(min(PERIOD, start + seconds - self._clock.now()))
            now = self._clock.now()
            for block in dive.until(now):
                sent.add_block(block)
                self._recorder.add(block)
            await self._recorder.flush()
            if pending and now > pending[0]:
                pending.pop(0)
                at_work.append(asyncio.create_task(self._retention.apply(began + now - start)))
        await asyncio.gather(*at_work)
        await self._recorder.stop(session)
        return session

    def _recording(self) -> Recording:
        return Recording.open(self.store, self._session)

    @property
    def _end(self) -> float:
        return self._recording().row.started_steady + self._seconds

    def _judge_samples(self) -> None:
        report, recording = self.report, self._recording()
        stored = Checksums.of(recording)
        for name in recording.topics:
            count, sent = stored.counts.get(name, 0), self._sent.counts.get(name, 0)
            report.insist(count == sent, f"{name}: {count} samples are stored, {sent} were sent")
            same = stored.sums.get(name) == self._sent.sums.get(name)
            report.insist(same or count != sent, f"{name}: samples differ from those sent")
        with self.store.read() as database:
            gaps = database.exec(select(Gap).where(Gap.session_id == self._session)).all()
        report.insist(not gaps, f"gaps: {[(gap.topic, gap.kind, gap.missed) for gap in gaps]}")
        row = recording.row
        report.samples = sum(stored.counts.values())
        report.insist(row.samples == report.samples, f"the session counts {row.samples} samples")
        report.insist(abs(row.duration - self._seconds) < 1.0, f"the session lasts {row.duration} s")
        for name in RATES:
            spans = recording.spans(name)
            report.chunks += len(spans)
            longest = max(last - first for first, last, _ in spans)
            report.insist(longest < CHUNK_SECONDS_MAX, f"{name}: a chunk of {longest:.1f} s")

    def _judge_retention(self) -> None:
        with self.store.read() as database:
            remaining = database.exec(select(func.count()).where(col(Chunk.session_id) == self._old)).one()
            connection = database.connection()
            free = connection.exec_driver_sql("PRAGMA freelist_count").scalar_one()
            pages = connection.exec_driver_sql("PRAGMA page_count").scalar_one()
            size = connection.exec_driver_sql("PRAGMA page_size").scalar_one()
        report = self.report
        report.insist(remaining == 0, f"{remaining} chunks of the removed session are left")
        report.insist(free <= 0.01 * pages, f"{free} of {pages} pages are free, and not given back")
        report.megabytes = round(pages * size / 1e6, 1)
        report.megabytes_per_hour = round(report.megabytes / report.hours, 1)
        a_hour = pages * size / report.hours
        report.insist(a_hour <= HOUR_BYTES_MAX, f"an hour takes {a_hour / 1e6:.1f} MB")

    def _judge_replay(self) -> None:
        recording = self._recording()
        for end in (STRETCH, self._seconds / 2, self._seconds):
            start = recording.row.started_steady + end - STRETCH
            read = read_blocks_between(recording, start, start + STRETCH)
            blocks = [block for block in read_blocks(read.data) if block.topic.name == "imu"]
            given = b"".join(block.payload for block in blocks)
            size = BY_NAME["imu"].row_bytes
            rows = b"".join(recording.rows("imu", start, start + STRETCH))
            cut = b"".join(
                rows[at : at + size]
                for at in range(0, len(rows), size)
                if start <= TIME.unpack_from(rows, at)[0] < start + STRETCH
            )
            self.report.insist(given == cut, f"the replay up to {end:.0f} s has other samples")
            count, right = len(given) // size, round(RATES["imu"] * STRETCH)
            self.report.insist(abs(count - right) <= 1, f"the replay up to {end:.0f} s has {count} samples")
            self.report.insist(not read.left_out, f"the replay left out {read.left_out} samples")

    def _judge_export(self) -> None:
        row = find_row(self.store, self._session)
        options = ExportOptions(format="csv", topics=["depth"])
        output = io.BytesIO()
        write_tables(self.store, ExportSelection(self.store, row, options), output)
        with zipfile.ZipFile(output) as archive, archive.open("depth.csv") as file:
            lines = csv.DictReader(io.TextIOWrapper(file))
            table = np.array([(float(line["time [s]"]), float(line["depth [m]"])) for line in lines])
        times, columns = self._recording().columns("depth", ["depth"])
        same = len(table) == len(times) and (
            np.allclose(table[:, 0], times - row.started_steady, atol=1e-6)
            and np.allclose(table[:, 1], columns["depth"], atol=1e-6)
        )
        self.report.insist(bool(same), f"the export has {len(table)} depths, the recording {len(times)}")

    def _judge_archive(self) -> None:
        row = find_row(self.store, self._session)
        path = self._folder / "archive.zip"
        with path.open("wb") as file:
            write_archive(self.store, ExportSelection(self.store, row, ExportOptions(format="archive")), file)
        other = DataFolder(self._folder / "other")
        make_folders(other)
        prepare(other)
        with closing(Store(other.database)) as store:
            number = asyncio.run(Imports(other, store).take(path))
            imported = Checksums.of(Recording.open(store, number))
        self.report.insist(imported == self._sent, "the imported archive has other samples")

    def _judge_comparison(self) -> None:
        view = TimeRange(start=self._seconds - STRETCH, end=self._seconds)
        query = LinesQuery(sessions=[self._session], signals=["depth.depth"], points=100, view=view)
        (drawn,) = Comparer(self.store).lines(query).sessions
        line = drawn.series["depth.depth"]
        times, columns = self._recording().columns("depth", ["depth"], self._end - STRETCH, self._end)
        since, depth = times - (self._end - self._seconds), columns["depth"]
        lows = [low for low in line.low if low is not None]
        highs = [high for high in line.high if high is not None]
        report = self.report
        report.insist(len(line.time) >= 90, f"the comparison's line has {len(line.time)} columns at the end")
        report.insist(line.time[-1] > since[-1] - 2.0, f"the comparison ends at {line.time[-1]:.1f} s")
        extremes = (min(lows) - depth.min(), max(highs) - depth.max())
        report.insist(max(map(abs, extremes)) < 1e-4, f"the comparison's line differs by {extremes}")


def main() -> int:
    """Exit status."""
    hours = float(sys.argv[1]) if len(sys.argv) > 1 else 8.0
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        report = Hours(Path(name), 3600 * hours).run()
    print(json.dumps(vars(report), indent=2))
    return 1 if report.problems else 0


if __name__ == "__main__":
    sys.exit(main())
