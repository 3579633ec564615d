"""Schemas of the choice of a film in the interface."""

from typing import Annotated

from pydantic import ConfigDict, Field

from robot_runtime.contract.commands import FilmQuality
from robot_runtime.contract.limits import STREAM_RATE
from server.features.film.choice import Coding
from server.http.request_body import RequestBody
from server.platform.schema_base import Schema


class FilmOrder(RequestBody):
    """The choice of a film: for the session that records, and those to come."""

    model_config = ConfigDict(allow_inf_nan=False)
    record: bool = Field(description="true: sessions are filmed")
    rate: Annotated[float, Field(ge=STREAM_RATE.minimum, le=STREAM_RATE.maximum)] = Field(
        description="pictures a second; at most the stream's"
    )
    quality: FilmQuality


class PictureBytes(Schema):
    """Bytes of one picture of a film, by quality."""

    low: float
    medium: float
    high: float


class FilmPlan(Schema):
    """The choice of a film that is in force, and the space that films need."""

    record: bool
    rate: float = Field(description="pictures a second")
    quality: FilmQuality
    rate_max: float = Field(description="pictures a second of the camera's stream")
    coding: Coding
    refusal: str = Field(description="the reason for which nothing is filmed, whatever is chosen; or empty")
    picture_bytes: PictureBytes
    measured: bool = Field(description="true where the bytes are those of this robot's films")
    room: int = Field(description="bytes of the disk that are free for recordings, above `keep_free`")
