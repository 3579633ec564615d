"""Requests and answers of the identification of a craft."""

from typing import Annotated, Literal

from pydantic import Field

from server.http.request_body import RequestBody
from server.platform.runs import RUN_MEANING
from server.platform.schema_base import Schema
from server.recording.schemas import SessionNumber

SESSIONS_MAX = 12


class IdentificationStart(RequestBody):
    """The sessions of a fit, and the one that checks it."""

    sessions: Annotated[list[SessionNumber], Field(min_length=1, max_length=SESSIONS_MAX)]
    left_out: SessionNumber | None = Field(
        default=None, description="the session that checks the prediction; null: none"
    )


class IdentifiedNumber(Schema):
    """A number of the craft before and after a fit."""

    name: str
    title: str
    unit: str
    before: float
    value: float
    deviation: float | None = Field(description="standard deviation; null if the sessions do not show it")
    seen: Literal["well", "weakly", "no"]
    words: str = Field(description="the confidence, or the motion that is missing")


class FittedSession(Schema):
    """A session of a fit."""

    id: int
    name: str
    windows: int = Field(description="number of windows of 8 s that could be used")
    offsets: list[float] | None = Field(
        description="of its IMU: turn rate (rad/s), then specific force (m/s²); null without a window"
    )


class PredictedChannel(Schema):
    """A measured signal of the session that was left out, and its prediction; null breaks the lines."""

    name: str
    unit: str
    before_rms: float = Field(description="error of the prediction by the craft before the fit")
    after_rms: float
    measured: list[float | None]
    before: list[float | None]
    after: list[float | None]


class CheckedSession(Schema):
    """The check on the session that was left out."""

    id: int
    name: str
    before_error: float = Field(description="share of the measured signals' own variation, before the fit")
    after_error: float
    improvement: float = Field(description="error before over error after")
    times: list[float] = Field(description="s since the session's start")
    channels: list[PredictedChannel]


def describe_improvement(improvement: float) -> str:
    """Return the error before over the error after, as text: below 1 the fit has made it worse."""
    return f"{improvement:.1f} times better" if improvement >= 1 else f"{1 / improvement:.1f} times worse"


class IdentificationResult(Schema):
    """The result of a fit."""

    sessions: list[FittedSession]
    numbers: list[IdentifiedNumber]
    noise: dict[str, float] = Field(description="σ by sensor: pressure (Pa), gyroscope, accelerometer")
    check: CheckedSession | None
    missing: list[str] = Field(description="the motions that these sessions do not show, in words")
    affected: list[str] = Field(description="what changes if the craft is adopted, in words")
    craft: str = Field(description="the craft file")


class IdentificationStarted(Schema):
    """The fit that was started."""

    run: str = Field(description=RUN_MEANING)


class ActiveIdentification(Schema):
    """A fit that runs."""

    run: str = Field(description=RUN_MEANING)
    sessions: list[int]
    left_out: int | None
    progress: float = Field(description="0 to 1")


class EndedIdentification(Schema):
    """The last fit."""

    run: str = Field(description=RUN_MEANING)
    sessions: list[int]
    left_out: int | None
    problem: str = Field(description="why it has no result; empty if it has one")
    result: IdentificationResult | None


class AdoptedCraft(Schema):
    """The craft in force."""

    title: str = Field(description="empty for the default craft")
    origin: str
    file: str = Field(description="its file; empty for the default craft")
    can_undo: bool = Field(description="whether the craft before the last adoption can be restored")
    problem: str = Field(description="why no craft can be adopted now; empty if one can")


class IdentificationState(Schema):
    """The running fit, the last one, and the craft in force."""

    active: ActiveIdentification | None
    last: EndedIdentification | None
    craft: AdoptedCraft


class CraftChange(Schema):
    """The answer to an adoption, or to its undoing."""

    affected: list[str]
