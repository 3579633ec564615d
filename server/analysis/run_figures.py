"""Figures of a run in simulated time that is not recorded: the same code as a comparison of sessions."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Any

from robot_runtime.contract.chunks import StoredChunk, describe_topics, encode
from robot_runtime.contract.topics import (
    CONTROL,
    CRAFT,
    DEPTH,
    EVENT,
    LINK,
    MISSION,
    MOTOR,
    PARAMETERS,
    STATE,
    STATUS,
    AnyTopic,
)
from robot_runtime.transport.blocks import Block
from server.analysis.definitions import ALARMS, DEEPEST, RUN_FIGURES
from server.analysis.figures import (
    NEVER_ARMED,
    NOTHING_THERE,
    EvaluationRange,
    count_samples,
    measure,
)
from server.analysis.history import read_history
from server.analysis.moments import Span
from server.analysis.samples import Samples
from server.analysis.segment_figures import DiveFigures
from server.library.content import Recording
from server.metrics.figure import Figure
from server.platform.models import SessionRow

_TOPICS: frozenset[AnyTopic] = frozenset(
    (CONTROL, CRAFT, DEPTH, EVENT, LINK, MISSION, MOTOR, PARAMETERS, STATE, STATUS)
)
_CHUNK_BYTES = 4_000_000


class RunSamples:
    """The samples of a run that figures are computed of, gathered block by block."""

    def __init__(self) -> None:
        # Bytes alone: thousands of blocks that stay would cost the garbage collector more than all else.
        self._payloads: dict[AnyTopic, list[bytes]] = {}
        self._counts: dict[AnyTopic, list[int]] = {}

    def add(self, blocks: Iterable[Block]) -> None:
        """Take in blocks."""
        for block in blocks:
            if block.topic in _TOPICS:
                self._payloads.setdefault(block.topic, []).append(block.payload)
                self._counts.setdefault(block.topic, []).append(block.count)

    def record(self, duration: float) -> Recording:
        """Return the samples as a recording of this duration, s, from time 0 on."""
        return _RunRecording(
            duration,
            {
                topic.name: [*_pack(topic, payloads, self._counts[topic])]
                for topic, payloads in self._payloads.items()
            },
        )


def measure_run(recording: Recording, start: float | None, end: float | None) -> dict[str, Figure]:
    """Return the RUN_FIGURES of a run, between two times (s) or, without, of all its armed time.

    Raise RecordingError.
    """
    samples = Samples()
    history = read_history(recording, samples)
    if start is None and end is None:
        evaluated = EvaluationRange(history.armed, history.armed[0].start if history.armed else None)
    else:
        evaluated = EvaluationRange((Span(start or 0.0, recording.row.duration if end is None else end),))
    spans = evaluated.spans
    figures = measure(recording, samples, history, evaluated) | count_samples(recording, spans)
    dive = DiveFigures(recording, samples, history, [])
    whole = dive.measure_all() if spans is history.armed else dive.measure_part(spans[0].start, spans[0].end)
    figures |= {meaning.name: whole.whole[meaning.name] for meaning in (DEEPEST, ALARMS)}
    missing = Figure(value=None, words=NOTHING_THERE if spans else NEVER_ARMED)
    return {meaning.name: figures.get(meaning.name, missing) for meaning in RUN_FIGURES}


def was_armed(recording: Recording) -> bool:
    """Return True where the robot was armed at any time. Raise RecordingError."""
    return bool(read_history(recording, Samples()).armed)


def _pack(topic: AnyTopic, payloads: Sequence[bytes], counts: Sequence[int]) -> Iterator[StoredChunk]:
    """Yield the chunks of a topic's payloads, which follow each other."""
    begin = size = samples = 0
    for number, payload in enumerate(payloads):
        if size and size + len(payload) > _CHUNK_BYTES:
            yield _chunk(topic, samples, payloads[begin:number], sum(counts[begin:number]))
            samples += sum(counts[begin:number])
            begin, size = number, 0
        size += len(payload)
    yield _chunk(topic, samples, payloads[begin:], sum(counts[begin:]))


def _chunk(topic: AnyTopic, samples: int, payloads: Sequence[bytes], count: int) -> StoredChunk:
    """Return the chunk of these payloads; `samples` come before it."""
    encoding, data, first, last = encode(topic, payloads, count)
    # Read in order alone: no chunk is asked for by its number.
    return StoredChunk(0, first, last, samples, count, encoding, data)


class _RunRecording(Recording):
    """The recording of a run, in memory."""

    def __init__(self, duration: float, chunks: Mapping[str, list[StoredChunk]]) -> None:
        # Without a store: all that would read it is here.
        self.row = SessionRow(
            name="run",
            note="",
            # So that no cache holds what is never asked for again.
            state="recording",
            robot="",
            version="",
            definitions="",
            started=0.0,
            started_steady=0.0,
            duration=duration,
            configuration="",
            robot_state="null",
            topics="",
        )
        self.topics = describe_topics()
        self._chunks = chunks

    def counts(self, start: float = -inf, end: float = inf) -> dict[str, int]:
        """Return the numbers of samples by topic in the chunks that may overlap this range."""
        there = {topic: [*self._select(None, 0, topic, start, end)] for topic in self._chunks}
        return {topic: sum(chunk.count for chunk in chunks) for topic, chunks in there.items() if chunks}

    def has(self, topic: str) -> bool:
        """Return True where the run has any sample of the topic."""
        return topic in self._chunks

    def spans(self, topic: str) -> list[tuple[float, float, int]]:
        """Return first time, last time and number of samples of each chunk in order."""
        return [(chunk.first_time, chunk.last_time, chunk.count) for chunk in self._chunks.get(topic, ())]

    def _select(
        self,
        query: Any,  # noqa: ARG002 - the database's
        limit: int,  # noqa: ARG002
        topic: str,
        start: float,
        end: float,
    ) -> Iterator[Any]:
        for chunk in self._chunks.get(topic, ()):
            if chunk.last_time >= start and chunk.first_time <= end:
                yield chunk
