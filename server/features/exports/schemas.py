"""Schemas of exports in the interface."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from server.http.request_body import RequestBody
from server.platform.csv_cells import Spreadsheet
from server.platform.schema_base import Schema
from server.recording.schemas import SessionNumber

Compression = Literal["none", "zstd", "lz4"]
Overlay = Literal["none", "subtitles", "lines"]
Format = Literal["csv", "csv-grid", "xlsx", "parquet", "mcap", "archive", "report", "mp4"]
State = Literal["waiting", "running", "done", "failed"]

PERIOD_MIN, PERIOD_MAX = 0.001, 3600.0
SECONDS_MAX = 1e9

Name = Annotated[str, Field(min_length=1, max_length=100)]
Seconds = Annotated[float, Field(ge=-SECONDS_MAX, le=SECONDS_MAX)]


class ExportOptions(RequestBody):
    """Choice of a session's topics, range and file format."""

    model_config = ConfigDict(allow_inf_nan=False)
    format: Format
    topics: Annotated[list[Name], Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="names of topics; null for all. Not for csv-grid, archive and report"
    )
    columns: Annotated[list[Name], Field(min_length=1, max_length=1000)] | None = Field(
        default=None, description="such as depth.depth or motor.angle_0; null for all. For csv-grid alone"
    )
    start: Seconds | None = Field(
        default=None, description="s since the session's start; null for its beginning"
    )
    end: Seconds | None = Field(default=None, description="s since the session's start; null for its end")
    period: Annotated[float, Field(ge=PERIOD_MIN, le=PERIOD_MAX)] = Field(
        default=0.1, description="s between the lines of csv-grid"
    )
    spreadsheet: Spreadsheet = Field(
        default="none",
        description="none: CSV for programs; point, comma: for a spreadsheet with this decimal sign, with a "
        "byte order mark, and for comma with semicolons. For csv and csv-grid",
    )
    compression: Compression = Field(
        default="none", description="of the chunks of mcap; zstd and lz4 need their packages"
    )
    overlay: Overlay = Field(
        default="none",
        description="values over the film of mp4: as subtitles, which a player shows or hides, or as the "
        "flight view's lines, drawn into each picture",
    )


class NewExport(ExportOptions):
    """A new export."""

    session: SessionNumber


class Job(Schema):
    """An export job; its file is stored for some days."""

    id: str
    session: int
    identifier: str = Field(
        default="", description="the session's identifier; empty for a file of an older version"
    )
    session_name: str
    wanted: ExportOptions
    state: State
    progress: float = Field(description="0 to 1")
    made: datetime = Field(description="UTC, time of the request")
    bytes: int | None = Field(default=None, description="the file's size; null until it is done")
    file: str = Field(description="the file's name")
    sha256: str | None = Field(
        default=None, description="the file's checksum, hexadecimal; null until it is done"
    )
    problem: str = Field(default="", description="cause of a failure")
