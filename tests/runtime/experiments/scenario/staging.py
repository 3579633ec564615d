"""Scenarios written by a test, run in simulated time, and their output."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.contract.topics import TIME, Kind
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import Scenario, read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.transport.blocks import read_blocks, read_rows

ROOT = Path(__file__).resolve().parents[4]
POOL = 'kind = "pool"\ndepth = 3.0\nlength = 10.0\nwidth = 5.0'


def document(seconds: float, *events: str, seed: int = 7, scene: str = POOL, more: str = "") -> str:
    """Return a scenario of this duration in s; each event is the content of an inline table."""
    happens = "".join(f"\n[[events]]\n{event.replace('; ', chr(10))}\n" for event in events)
    head = f'name = "test"\ntitle = "Test"\nduration = {seconds}\nseed = {seed}\n'
    control = '[control]\ncontroller = "pid"\nset_point = 0.6\n'
    return f"{head}\n[scene]\n{scene}\n\n{control}\n{more}\n{happens}"


class Output:
    """The complete output of a run."""

    def __init__(self) -> None:
        self.on_event: Callable[[dict[str, Any]], None] = lambda _: None
        self.events: list[dict[str, Any]] = []
        self.rows: dict[str, list[tuple[float, Any]]] = {}
        self.documents: dict[str, list[dict[str, Any]]] = {}
        self.film: list[tuple[float, FilmPicture]] = []
        self.bytes = b""

    def blocks(self, data: bytes) -> None:
        """Decode and store blocks."""
        self.bytes += data
        for block in read_blocks(data):
            if block.topic.kind is Kind.ROWS:
                self.rows.setdefault(block.topic.name, []).extend(read_rows(block))
            elif block.topic.kind is Kind.FILM:
                (time,) = TIME.unpack_from(block.payload)
                self.film.append((time, FilmPicture(block.payload[TIME.size :])))
            elif block.topic.kind is Kind.DOCUMENTS:
                self.documents.setdefault(block.topic.name, []).extend(json.loads(block.payload))

    def event(self, event: str, **more: Any) -> None:
        """Store an event."""
        self.events.append({"event": event, **more})
        self.on_event(self.events[-1])

    def texts(self, topic: str) -> list[str]:
        """Return the texts of all the topic's documents."""
        return [document["text"] for document in self.documents.get(topic, [])]

    def time_of(self, topic: str, message: str) -> float:
        """Time of the first document of this topic with these words, s."""
        return float(
            next(document["time"] for document in self.documents[topic] if message in document["text"])
        )

    @property
    def markers(self) -> list[tuple[float, str]]:
        """Times and texts of the bookmarks."""
        return [(event["time"], event["text"]) for event in self.events if event["event"] == "marker"]

    @property
    def ended(self) -> dict[str, Any]:
        """The event of its end."""
        assert self.events[-1]["event"] == "ended"
        return self.events[-1]

    def between(self, topic: str, start: float, end: float) -> list[Any]:
        """Return the topic's records in this range of time."""
        return [record for time, record in self.rows[topic] if start <= time < end]


def perform(scenario: str | Scenario, board: str = "host", report: Output | None = None) -> Output:
    """Run a scenario to its end."""
    report = report or Output()
    read = read_scenario(scenario) if isinstance(scenario, str) else scenario
    ScenarioRun(read, boards()[board], report).perform(lambda firmware: {"firmware": str(len(firmware))})
    return report
