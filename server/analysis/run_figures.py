"""Figures of a run in simulated time that is not recorded: the same code as a comparison of sessions."""

import json
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.chunks import describe_topics
from robot_runtime.contract.topics import CONTROL, DEPTH, EVENT, LINK, MISSION, MOTOR, STATE
from robot_runtime.transport.blocks import gather_payloads
from server.analysis.definitions import RUN_FIGURES
from server.analysis.figures import (
    MEASURED,
    NEVER_ARMED,
    NOTHING_THERE,
    OUTPUT,
    SET_POINT,
    EvaluationRange,
    count_samples,
    measure_series,
)
from server.analysis.moments import ControlHistory, Span
from server.analysis.samples import Samples
from server.analysis.segment_figures import count_alarms, find_deepest, read_alarms
from server.library.content import Recording
from server.metrics.figure import Figure
from server.platform.models import SessionRow

_TOPICS = (CONTROL, DEPTH, EVENT, LINK, MISSION, MOTOR, STATE)
"""All that the figures, and a run's failures, follow from."""


class RunSamples:
    """The samples of a run that its figures are computed of."""

    def __init__(self) -> None:
        # Bytes alone: thousands of blocks that stay would cost the garbage collector more than all else.
        self._payloads: dict[int, list[bytes]] = {topic.id: [] for topic in _TOPICS}

    def add(self, data: bytes) -> None:
        """Take in blocks of this process."""
        gather_payloads(data, self._payloads)

    def record(self, duration: float) -> Recording:
        """Return the samples as a recording of this duration, s, from time 0 on."""
        return _RunRecording(duration, {topic.name: self._payloads[topic.id] for topic in _TOPICS})


def measure_run(
    recording: Recording, history: ControlHistory, start: float | None, end: float | None
) -> dict[str, Figure]:
    """Return the RUN_FIGURES of a run, between two times (s) or, without, of all its armed time.

    Raise RecordingError.
    """
    if start is None and end is None:
        evaluated = EvaluationRange(history.armed, history.armed[0].start if history.armed else None)
    else:
        evaluated = EvaluationRange((Span(start or 0.0, recording.row.duration if end is None else end),))
    figures = count_samples(recording, evaluated.spans)
    if evaluated.spans:
        series = Samples().read(recording, [MEASURED, SET_POINT, OUTPUT])
        figures |= measure_series(series, history, evaluated)
        figures["deepest"] = find_deepest(series.get(MEASURED), evaluated)
        figures["alarms"] = count_alarms(read_alarms(recording), evaluated.spans)
    missing = Figure(value=None, words=NOTHING_THERE if evaluated.spans else NEVER_ARMED)
    return {meaning.name: figures.get(meaning.name, missing) for meaning in RUN_FIGURES}


@cache
def _describe() -> Mapping[str, Any]:
    return describe_topics()


class _RunRecording(Recording):
    """The recording of a run, in memory: payloads of blocks, by their topics."""

    def __init__(self, duration: float, payloads: Mapping[str, Sequence[bytes]]) -> None:
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
        self.topics = _describe()
        self._payloads = payloads

    def has(self, topic: str) -> bool:
        """Return True where the run has any sample of the topic."""
        return bool(self._payloads.get(topic))

    def documents(self, topic: str, start: float = -inf, end: float = inf) -> Iterator[dict[str, Any]]:
        """Yield the documents between `start` and `end`."""
        for payload in self._payloads.get(topic, ()):
            yield from (document for document in json.loads(payload) if start <= document["time"] <= end)

    def changes(self, topic: str) -> Iterator[dict[str, Any]]:
        """Yield the documents that differ from the previous one in more than their time."""
        before: dict[str, Any] | None = None
        for document in self.documents(topic):
            content = {**document, "time": None}
            if content != before:
                before = content
                yield document

    def _tables(
        self,
        topic: str,
        start: float,  # noqa: ARG002 - the caller leaves out what is outside
        end: float,  # noqa: ARG002
    ) -> Iterator[NDArray[np.uint8]]:
        """Yield the bytes of all rows in the shape (1, size of a row, samples)."""
        if rows := b"".join(self._payloads.get(topic, ())):
            size: int = self.topics[topic]["row_bytes"]
            yield np.frombuffer(rows, np.uint8).reshape(1, -1, size).transpose(0, 2, 1)
