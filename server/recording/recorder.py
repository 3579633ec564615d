"""The recorder of everything that arrives while a session runs, in chunks of about a second a topic.

Samples are gathered in memory, encoded in the writer's thread and committed every `PERIOD`, so that a power
cut costs at most the last second. While the database cannot be written, up to `BACKLOG_BYTES` wait; the rest
is counted as not stored, the film first. A jump in a topic's numbering ends a chunk and is stored as a gap. A
session of a killed server continues if the missed samples are still available (`server.recording.resume`).
"""

import asyncio
import json
import logging
from collections import Counter
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from time import time
from typing import Any, TypeVar

from sqlalchemy import Connection, bindparam, insert, update
from sqlmodel import col, select

from robot_runtime.clock import Clock
from robot_runtime.contract.chunks import encode
from robot_runtime.contract.topics import BY_NAME, FILM, NOTICE, AnyTopic
from robot_runtime.transport.blocks import NUMBERS, Block
from server.platform.errors import ConflictError
from server.platform.models import Chunk, Gap, SessionRow
from server.platform.notices import Notices
from server.platform.store import Store, StoreError, insert_row
from server.recording.provenance import ProvenanceWatch
from server.recording.resume import InterruptedSession, MissingSamples, find_interrupted
from server.recording.schemas import Session
from server.recording.session import from_row

log = logging.getLogger(__name__)

T = TypeVar("T")

TICK_SECONDS = 1.0
"""Between two looks at the processes and states on which recordings depend."""
PERIOD = 0.8
"""s between commits; with the commit itself and the runtime's batches this stays below a second."""
PROBE_PERIODS = 5
"""Periods between attempts to write while writing fails and nothing is recorded."""
BACKLOG_BYTES = 8_000_000
SPAN_BYTES_MAX = 4_000_000
"""Payloads in one chunk while writing takes long; readers accept `chunks.CHUNK_BYTES_MAX`."""

STANDING_SECONDS = 30.0
"""s after which what is no longer sent counts as no longer in force."""
_UPDATE_SESSION = update(SessionRow).where(col(SessionRow.id) == bindparam("session"))
"""The values come with each execution: building the statement anew costs more than executing it."""


class RecordingRefusedError(ConflictError):
    """Refused now"""


@dataclass(slots=True)
class _Span:
    """Consecutive samples of one topic and of one run of its sender, as they arrived."""

    topic: AnyTopic
    run: str
    first: int
    count: int = 0
    size: int = 0
    """Bytes of the payloads."""
    payloads: list[bytes] = field(default_factory=list)


@dataclass(slots=True)
class _Batch:
    """Spans and rows of one transaction; spans are encoded into chunks on the way."""

    spans: list[_Span] = field(default_factory=list)
    chunks: list[dict[str, Any]] = field(default_factory=list)
    gaps: dict[tuple[str, str], dict[str, Any]] = field(default_factory=dict)

    @property
    def bytes(self) -> int:
        return sum(len(chunk["data"]) for chunk in self.chunks)

    @property
    def samples(self) -> int:
        return sum(chunk["count"] for chunk in self.chunks)

    def note(self, topic: str, kind: str, missed: int, now: float) -> None:
        """Add to the gap of this kind; its time is that of the first addition."""
        gap = self.gaps.setdefault((topic, kind), {"topic": topic, "kind": kind, "time": now, "missed": 0})
        gap["missed"] += missed

    def take(self, newer: "_Batch") -> None:
        """Take over the samples gathered since."""
        self.spans += newer.spans
        for gap in newer.gaps.values():
            self.note(gap["topic"], gap["kind"], gap["missed"], gap["time"])


class Recorder:
    """Recorder of one session; `changed` is called at every change of it.

    With a `provenance` a session gets the configuration, firmware and software in force as it begins.
    """

    def __init__(
        self,
        store: Store,
        clock: Clock,
        notices: Notices,
        changed: Callable[[], None],
        provenance: ProvenanceWatch | None = None,
    ) -> None:
        self.session: Session | None = None
        self._provenance = provenance
        self._store = store
        self._clock = clock
        self._notices = notices
        self._changed = changed
        self._busy = asyncio.Lock()
        self._accepts = False
        self._started_steady = 0.0
        self._standing: dict[int, tuple[float, Block]] = {}
        """By the topic's number: when it arrived (s, steady clock), and what."""
        self._reset()

    @property
    def stopping(self) -> bool:
        """True while the end of the session is being stored."""
        return self.session is not None and not self._accepts

    async def recover(self) -> InterruptedSession | None:
        """Mark sessions that a crash left recording as interrupted, except one that may continue.

        Raise StoreError.
        """
        interrupted = await asyncio.to_thread(find_interrupted, self._store)
        resumed = -1 if interrupted is None else interrupted.row.id
        for name, duration in await self._store.write(
            lambda connection: _mark_interrupted(connection, resumed)
        ):
            self._notices.notify(
                "recording",
                "caution",
                f"“{name}” was cut off after {duration:.1f} s. At most the last second before the end is "
                "missing.",
            )
        return interrupted

    async def resume(self, interrupted: InterruptedSession, missing: Mapping[str, MissingSamples]) -> None:
        """Continue a session, or mark it as interrupted if the runtime cannot supply the missing samples.

        `missing` describes the samples of each sender that are not stored, by its name. Call it before these
        are added, and `caught_up` afterwards. Raise StoreError.
        """
        runtime = missing.get("runtime")
        row = interrupted.row
        if runtime is None or not (runtime.same_run and runtime.whole):
            sent = {
                name: count for samples in missing.values() for name, count in samples.sent.items() if count
            }
            gaps = [
                {"session_id": row.id, "topic": name, "kind": "missed", "missed": count}
                | {"time": interrupted.last[name].time}
                for name, count in sent.items()
            ]
            await self._store.write(lambda connection: _interrupt(connection, gaps))
            lost = sum(sent.values())
            self._notices.notify(
                "recording",
                "caution",
                f"The server was killed while “{row.name}” was recorded. Its stored samples remain; "
                + (f"{lost} samples sent since are lost." if lost else "those sent since are lost."),
            )
            return
        self._reset()
        self._started_steady = row.started_steady
        self._numbers.update({name: last.chunks for name, last in interrupted.last.items()})
        self._expected.update({BY_NAME[name].id: last.following for name, last in interrupted.last.items()})
        for sender in missing.values():
            if sender.same_run:
                self._skip |= sender.first
        if NOTICE.name in interrupted.last:
            self._notices.continue_from(interrupted.last[NOTICE.name].following)
        self.session = from_row(row, interrupted.tags, interrupted.markers)
        self._accepts = True
        away = self._clock.now() - row.started_steady - row.duration
        self._notices.notify(
            "recording",
            "caution",
            f"The server was killed. Recording of “{row.name}” continues; {away:.1f} s are fetched.",
        )
        self._changed()

    def caught_up(self) -> None:
        """Accept every block from now on, also low numbers of a new sender: the backlog is complete."""
        self._skip.clear()

    async def start(self, row: SessionRow) -> Session:
        """Store a new session and record into it from now on. Raise RecordingRefusedError, StoreError."""
        return await _finish(self._start(row))

    async def _start(self, row: SessionRow) -> Session:
        async with self._busy:
            if self.session is not None:
                raise RecordingRefusedError(f"“{self.session.name}” is being recorded; stop it first.")
            in_force = asdict(await self._provenance.now()) if self._provenance is not None else {}
            values = row.model_dump(exclude={"id"}) | in_force
            row.id = await self._store.write(lambda connection: insert_row(connection, SessionRow, values))
            self.session = from_row(row).model_copy(update=in_force)
            self._started_steady = row.started_steady
            self._reset()
            self._accepts = True
            now = self._clock.now()
            for arrived, block in list(self._standing.values()):
                # They are sent rarely: the session begins with the values in force.
                if now - arrived < STANDING_SECONDS:
                    self._record(_as_of(block, now))
        self._notices.notify("recording", "info", f"Recording of “{row.name}” has begun.")
        if self._provenance is not None:
            await self._provenance.compare_file()
        self._changed()
        return self.session

    async def stop(self, session: int) -> Session:
        """Store the remaining samples and complete the session.

        Raise RecordingRefusedError if it does not record, StoreError if its end cannot be stored; it then
        continues.
        """
        return await _finish(self._stop(session))

    async def _stop(self, session: int) -> Session:
        async with self._busy:
            if self.session is None or self.session.id != session:
                raise RecordingRefusedError("This session is not recording; there is nothing to stop.")
            self._accepts = False
            try:
                done = await self._commit(final=True)
            except StoreError:
                self._accepts = True
                raise
            self.session = None
        self._notices.notify("recording", "info", f"Recording of “{done.name}” has ended.")
        self._changed()
        return done

    def amend(self, session: Session) -> None:
        """Take over new texts and the corrected date of the session, if it is recording."""
        if self.session is not None and self.session.id == session.id:
            written = session.model_dump(include={"name", "note", "tags", "markers", "kept", "started"})
            self.session = self.session.model_copy(update=written)
            self._changed()

    def add(self, block: Block) -> None:
        """Record a block; without a session it is ignored."""
        if block.topic.standing:
            self._standing[block.topic.id] = self._clock.now(), block
        self._record(block)

    def _record(self, block: Block) -> None:
        topic = block.topic
        if not self._accepts or not topic.recorded or (self._skip and self._is_stored(block)):
            return
        span = self._spans.get(topic.id)
        expected = self._expected.get(topic.id, block.first)
        if block.first != expected:
            ahead = (block.first - expected) % NUMBERS
            kind, missed = ("missed", ahead) if ahead < NUMBERS // 2 else ("restarted", 0)
            self._gathered.note(topic.name, kind, missed, self._clock.now())
            span = None
        payload = block.payload
        if span is None or span.run != block.run or span.size + len(payload) > SPAN_BYTES_MAX:
            span = self._spans[topic.id] = _Span(topic, block.run, block.first)
            self._gathered.spans.append(span)
        span.payloads.append(payload)
        span.count += block.count
        span.size += len(payload)
        self._expected[topic.id] = block.following

    def _is_stored(self, block: Block) -> bool:
        """Return True if an earlier server has stored the block, or it is older than the session."""
        first = self._skip.get(block.topic.id)
        return first is not None and not block.after(first)

    async def run(self) -> None:
        """Commit every period; report failures and recovery."""
        idle = 0
        while True:
            await asyncio.sleep(PERIOD)
            failed_before = self._store.failing
            idle = 0 if self.session or not failed_before else idle + 1
            try:
                if self.session:
                    await self.flush()
                elif idle >= PROBE_PERIODS:
                    idle = 0
                    await self._store.probe()
            except StoreError as problem:
                if failed_before is None:
                    self._notices.notify("database", "alarm", f"Nothing can be stored: {problem}.")
                continue
            if failed_before is not None and self._store.failing is None:
                self._notices.notify("database", "info", "Storing works again.")

    async def flush(self) -> None:
        """Commit the gathered samples. Raise StoreError; they then wait for the next commit."""
        await _finish(self._flush())

    async def _flush(self) -> None:
        async with self._busy:
            if self.session is not None:
                await self._commit(final=False)

    def _reset(self) -> None:
        self._spans: dict[int, _Span] = {}
        self._expected: dict[int, int] = {}
        self._skip: dict[int, int] = {}
        self._numbers: Counter[str] = Counter()
        self._gathered = _Batch()
        self._waiting = _Batch()

    async def _commit(self, *, final: bool) -> Session:
        assert self.session is not None
        batch = self._waiting
        batch.take(self._gathered)
        self._gathered, self._spans = _Batch(), {}
        now, session = self._clock.now(), self.session
        changes: dict[str, Any] = {"duration": now - self._started_steady}
        if final:
            changes |= {"state": "complete", "ended": time()}

        def write(connection: Connection) -> dict[str, Any]:
            self._encode(session.id, batch, now)
            changes["samples"] = session.samples + batch.samples
            changes["bytes"] = session.bytes + batch.bytes
            _insert(connection, session.id, batch, changes)
            return changes

        try:
            await self._store.write(write)
        except StoreError:
            _drop_oldest(batch, now)
            raise
        self._waiting = _Batch()
        if final:
            changes["ended"] = datetime.fromtimestamp(changes["ended"], UTC)
        # Its texts may have changed meanwhile.
        self.session = self.session.model_copy(update=changes)
        self._changed()
        return self.session

    def _encode(self, session: int, batch: _Batch, now: float) -> None:
        while batch.spans:
            span = batch.spans.pop(0)
            name = span.topic.name
            try:
                encoding, data, first_time, last_time = encode(span.topic, span.payloads, span.count)
            except (ValueError, RecursionError) as problem:
                log.warning("samples of %s cannot be recorded: %s", name, problem)
                batch.note(name, "damaged", span.count, now)
                continue
            batch.chunks.append(
                {
                    "session_id": session,
                    "topic": name,
                    "number": self._numbers[name],
                    "first_time": first_time,
                    "last_time": last_time,
                    "first": span.first,
                    "count": span.count,
                    "encoding": encoding,
                    "data": data,
                    "run": span.run,
                }
            )
            self._numbers[name] += 1


def _as_of(block: Block, now: float) -> Block:
    """Return the last document of a block again, with the time `now` (s, steady clock)."""
    try:
        document = json.loads(block.payload)[-1] | {"time": now}
    except (ValueError, LookupError, TypeError, RecursionError):
        # Storing it reports the damage.
        return block
    payload = json.dumps([document], separators=(",", ":")).encode()
    return Block.of(block.topic, 1, (block.following - 1) % NUMBERS, payload, block.run)


def _drop_oldest(batch: _Batch, now: float) -> None:
    """Drop films, and where that is not enough all else, the oldest first."""
    size = batch.bytes + sum(span.size for span in batch.spans)
    for film_alone in (True, False):
        # Spans are not encoded where not even a transaction could begin; they are newer than the chunks.
        chunks, batch.chunks = batch.chunks, []
        for chunk in chunks:
            if size > BACKLOG_BYTES and (chunk["topic"] == FILM.name or not film_alone):
                size -= len(chunk["data"])
                batch.note(chunk["topic"], "not stored", chunk["count"], now)
            else:
                batch.chunks.append(chunk)
        spans, batch.spans = batch.spans, []
        for span in spans:
            if size > BACKLOG_BYTES and (span.topic is FILM or not film_alone):
                size -= span.size
                batch.note(span.topic.name, "not stored", span.count, now)
            else:
                batch.spans.append(span)


async def _finish(step: Coroutine[Any, Any, T]) -> T:
    """Finish a step even if its caller is cancelled, so that memory and database agree."""
    return await asyncio.shield(asyncio.create_task(step))


def _insert(connection: Connection, session: int, batch: _Batch, changes: dict[str, Any]) -> None:
    if batch.chunks:
        connection.execute(insert(Chunk), batch.chunks)
    if batch.gaps:
        connection.execute(insert(Gap), [gap | {"session_id": session} for gap in batch.gaps.values()])
    connection.execute(_UPDATE_SESSION, {"session": session} | changes)


def _interrupt(connection: Connection, gaps: list[dict[str, Any]]) -> None:
    _mark_interrupted(connection, -1)
    if gaps:
        connection.execute(insert(Gap), gaps)


def _mark_interrupted(connection: Connection, but: int | None) -> list[tuple[str, float]]:
    """Mark sessions as interrupted; return their names and durations (s)."""
    interrupted = col(SessionRow.state) == "recording", col(SessionRow.id) != but
    rows = connection.execute(select(SessionRow.name, SessionRow.duration).where(*interrupted))
    marked = [(name, duration) for name, duration in rows]
    connection.execute(
        update(SessionRow)
        .where(*interrupted)
        .values(state="interrupted", ended=col(SessionRow.started) + col(SessionRow.duration))
    )
    return marked
