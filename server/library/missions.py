"""Missions in a recording: their ends, their documents, and the starts of their steps."""

from collections.abc import Iterator
from typing import Any

from pydantic import Field, TypeAdapter

from robot_runtime.contract.documents import Mission
from robot_runtime.contract.topics import MISSION
from server.library.content import Recording
from server.library.upgrade import NoCounterpartError, rewrite_document
from server.platform.schema_base import Schema

TOPIC = MISSION
_MISSION = TypeAdapter(Mission)
MISSIONS_SHOWN, SHOWN_BYTES = 100, 4_000_000
"""Of one answer; its size is that of the missions as JSON."""


class MissionStepStart(Schema):
    """The first start of a mission's step."""

    path: str = Field(description='from 1 along the branches, as "3.1.2"; empty for the first step')
    words: str
    time: float = Field(description="s since the session's start")


class RecordedMission(Schema):
    """A mission of a session. Times are s since the session's start."""

    start: float
    end: float
    late: bool = Field(description="it had begun before the recording")
    mission: Mission = Field(description="its last state; still running where the recording lacks its end")
    document: str = Field(description="TOML; empty where the recording lacks its first and last state")
    started: list[MissionStepStart] = Field(description="the steps that began, in the order of the document")


def read_missions(recording: Recording) -> tuple[list[RecordedMission], int]:
    """Return the missions of a session in order of time, up to an answer's limit, and the number of the rest.

    Raise StoreError, RecordingError.
    """
    described = (mission.describe(recording.row.started_steady) for mission in _read(recording))
    shown: list[RecordedMission] = []
    size = left_out = 0
    for mission in (entry for entry in described if entry is not None):
        size += len(mission.model_dump_json())
        if len(shown) < MISSIONS_SHOWN and size <= SHOWN_BYTES:
            shown.append(mission)
        else:
            left_out += 1
    return shown, left_out


def _read(recording: Recording) -> Iterator["_Reading"]:
    """Yield the missions one after the other, each when its last document has been read."""
    reading: _Reading | None = None
    for document in recording.documents(TOPIC.name) if TOPIC.name in recording.topics else ():
        if reading is None or not reading.continues_with(document):
            if reading is not None:
                yield reading
            reading = _Reading(document)
        reading.add(document)
    if reading is not None:
        yield reading


class _Reading:
    """The documents of one mission, one after the other. An hour has thousands: only the last is checked."""

    def __init__(self, first: dict[str, Any]) -> None:
        self._first = self._last = first
        self._ended: float | None = None
        self._document = ""
        self._started: dict[str, float] = {}

    def continues_with(self, document: dict[str, Any]) -> bool:
        """Return True if this document is of the same mission; a restarted runtime counts from 1 again."""
        same: bool = document["number"] == self._first["number"]
        return same and bool(document["sequence"] > self._last["sequence"])

    def add(self, document: dict[str, Any]) -> None:
        """Take the next document."""
        self._last = document
        self._document = document["document"] or self._document
        if self._ended is None and document["phase"] not in ("running", "paused"):
            # The last document comes once more when the robot is at the surface.
            self._ended = document["time"]
        for step in document["steps"]:
            if step["status"] != "waiting":
                self._started.setdefault(step["path"], document["time"])

    def describe(self, origin: float) -> RecordedMission | None:
        """Return the mission, times since `origin` (s, steady clock); None if not expressible now."""
        try:
            last = _MISSION.validate_python(rewrite_document(self._last, TOPIC))
        except NoCounterpartError:
            return None
        return RecordedMission(
            start=self._first["time"] - origin,
            end=(last.time if self._ended is None else self._ended) - origin,
            late=self._first["sequence"] > 0,
            mission=last,
            document=self._document,
            started=[
                MissionStepStart(path=step.path, words=step.words, time=self._started[step.path] - origin)
                for step in last.steps
                if step.path in self._started
            ],
        )
