"""Schemas of communication tests in the interface."""

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import Field

from robot_runtime.contract.problems import EntryProblem
from robot_runtime.experiments.comm_test.results import Direction
from server.features.comm_tests.reference import TableName
from server.http.request_body import RequestBody
from server.platform.schema_base import Schema

Place = Literal["emulated", "robot"]
State = Literal["running", "complete", "cancelled", "failed", "interrupted"]
Phase = Literal["compile", "upload", "run"]
Rate = Annotated[float, Field(ge=0, le=1, description="share of the numbers that arrived right")]

TEXT_MAX = 60_000
"""Largest test document in characters."""


class TestDocument(Schema):
    """A shipped test document."""

    name: str
    title: str
    text: str


class DocumentText(RequestBody):
    """The text of a test document."""

    text: Annotated[str, Field(max_length=TEXT_MAX)]


class CommTestStart(DocumentText):
    """A document to run, and its place."""

    place: Place


class Started(Schema):
    """The first run of the document."""

    run: int


class CheckedTest(Schema):
    """A runnable test of a document; `seconds` is its cells' estimated duration in the test's time."""

    id: int
    name: str
    framing: str
    direction: Direction
    cells: int
    bauds: list[int] = Field(description="bit/s")
    arduino_delays: list[float] = Field(description="s")
    pi_delays: list[float] = Field(description="s")
    seconds: float


class Check(Schema):
    """A document's problems, field by field, or its tests."""

    problems: list[EntryProblem]
    tests: list[CheckedTest]


class RunSummary(Schema):
    """A run; `sample` is the name of a shipped one, and empty for others."""

    id: int
    name: str
    framing: str
    direction: Direction
    place: Place
    sample: str
    state: State
    problem: str
    started: datetime = Field(description="UTC")
    ended: datetime | None = Field(description="UTC; null while it runs")
    cells: int = Field(description="number in the document")
    cells_done: int
    rate_mean: Rate | None = Field(description="null without cells")
    rate_min: Rate | None


class Cell(Schema):
    """One cell; delays and `seconds` (the test's time) in s, the counts of both ends together."""

    number: int
    baud: int
    arduino_delay: float
    pi_delay: float
    rate: Rate
    answered: bool
    right: int
    out_of_sequence: int
    checksum_errors: int
    framing_errors: int
    ring_full: int
    bytes_read: int
    bytes_lost: int
    line_errors: int
    uart_overruns: int
    repeated: int
    seconds: float
    causes: list[str]
    reasons: list[str] = Field(description="of the rate, each begins with its cause")


class CommTestRunDetails(RunSummary):
    """A run with its configuration and its cells."""

    document: dict[str, Any]
    firmware: str = Field(description="hash of the sketch, the core and the compiler's flags")
    tools: dict[str, str]
    host: str
    results: list[Cell]


class TableCell(Schema):
    """One entry of the thesis's tables."""

    baud: int
    arduino_delay: float
    pi_delay: float
    rate: Rate


class ThesisTable(Schema):
    """One of the thesis's tables."""

    name: TableName
    title: str
    framing: str
    cells: list[TableCell]
