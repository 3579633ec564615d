"""A session's chosen topics within a range, read in batches with progress."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from math import ceil, inf
from typing import Any

from sqlmodel import col, select

from robot_runtime.contract.topics import TIME
from server.features.exports.schemas import ExportOptions
from server.library.content import Recording
from server.platform.errors import InvalidError
from server.platform.models import SessionRow
from server.platform.store import Reader
from server.recording.session import HIDDEN

BATCH_BYTES = 64_000
"""Approximate size of a batch of rows: larger ones are no faster, and cost memory."""

PURGED = "The session was purged before the file was complete, so there is none."
ReportProgress = Callable[[float], None]
"""Called with the share done, 0 to 1."""


class ExportRequestError(InvalidError):
    """The export cannot be made"""


def find_identified(store: Reader, identifier: str) -> SessionRow:
    """Return the row of the session with this identifier.

    Raise ExportRequestError without one, StoreError.
    """
    query = select(SessionRow).where(
        SessionRow.identifier == identifier, col(SessionRow.state).not_in(HIDDEN)
    )
    with store.read() as database:
        row = database.exec(query).first()
    if row is None:
        raise ExportRequestError(PURGED)
    return row


def _check_range(row: SessionRow, options: ExportOptions) -> None:
    """Raise ExportRequestError for a range that is empty or not within the session."""
    start, end = options.start, options.end
    if start is not None and end is not None and start >= end:
        raise ExportRequestError(f"The end, {end:g} s, must be after the start, {start:g} s.")
    # Whole seconds, since people enter a duration that was rounded for them. One that is 0 is not known.
    longest = ceil(row.duration) if row.state != "recording" and row.duration > 0.0 else inf
    for name, seconds in (("start", start), ("end", end)):
        if seconds is not None and not 0.0 <= seconds <= longest:
            within = "it begins at 0 s" if seconds < 0.0 else f"it ends at {row.duration:g} s"
            raise ExportRequestError(f"The {name}, {seconds:g} s, lies outside of the session: {within}.")


class ExportSelection(Recording):
    """The chosen part of a session. `start` and `end` are on the session's steady clock (s).

    Raises ExportRequestError for a topic that the session lacks, or an empty range.
    """

    def __init__(
        self, store: Reader, row: SessionRow, options: ExportOptions, report: ReportProgress = lambda _: None
    ) -> None:
        super().__init__(store, row)
        self.options = options
        self.start = -inf if options.start is None else row.started_steady + options.start
        self.end = inf if options.end is None else row.started_steady + options.end
        _check_range(row, options)
        there = self.counts(self.start, self.end)
        unknown = [name for name in options.topics or () if name not in self.topics]
        if unknown:
            raise ExportRequestError(
                f"This session has no topic {', '.join(unknown)}; it has {', '.join(self.topics)}."
            )
        self.names = [
            name for name in self.topics if name in there and (not options.topics or name in options.topics)
        ]
        """Chosen topics that have samples."""
        # Reading a column of a row costs more than the sums below, which are made for every sample.
        self._steady, self._started = row.started_steady, row.started
        self._started_ns = round(row.started * 1e9)
        self.report = report
        self.samples = {name: there[name] for name in self.names}
        """Samples by topic in the chunks that may overlap the range."""
        self._total = sum(self.samples.values())
        self._seen = 0

    @property
    def is_whole(self) -> bool:
        """True where the range is the whole session."""
        return self.start == -inf and self.end == inf

    def refuse_purged(self) -> None:
        """Raise ExportRequestError where the session was purged meanwhile: samples may be missing."""
        find_identified(self._store, self.row.identifier)

    def chunks(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[Any]:
        """Yield the chunks of a topic; reading them reports progress."""
        for chunk in super().chunks(topic, start, end):
            yield chunk
            self._seen += chunk.count
            self.report(min(1.0, self._seen / max(1, self._total)))

    def batches(self, topic: str) -> Iterator[bytes]:
        """Yield the topic's rows in the range, some hundreds at once."""
        size = self.topics[topic]["row_bytes"]
        pending: list[bytes] = []
        waiting = 0
        for rows in self.rows(topic, self.start, self.end):
            within = rows if self.is_whole else self._cut(rows, size)
            pending.append(within)
            waiting += len(within)
            if waiting >= BATCH_BYTES:
                yield b"".join(pending)
                pending, waiting = [], 0
        if waiting:
            yield b"".join(pending)

    def since_start(self, time: float) -> float:
        """Return the time in s since the session's start."""
        return time - self._steady

    def utc(self, time: float) -> str:
        """Return a time of the steady clock as ISO 8601, to the millisecond."""
        moment = datetime.fromtimestamp(self._started + time - self._steady, UTC)
        return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")

    def date(self, time: float) -> datetime:
        """Return a time of the steady clock as a date without a zone, in UTC."""
        return datetime.fromtimestamp(self._started + time - self._steady, UTC).replace(tzinfo=None)

    def utc_ns(self, time: float) -> int:
        """Return a time of the steady clock in ns since 1970."""
        return self._started_ns + round((time - self._steady) * 1e9)

    def _cut(self, rows: bytes, size: int) -> bytes:
        return b"".join(
            rows[at : at + size]
            for at in range(0, len(rows), size)
            if self.start <= TIME.unpack_from(rows, at)[0] <= self.end
        )
