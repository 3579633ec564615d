"""Schemas of a lab's robots."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, StringConstraints

from server.http.request_body import RequestBody
from server.platform.schema_base import Schema

Phase = Literal["waiting", "pulling", "done", "armed", "unreachable", "failed"]
Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=100)]


def _check_url(url: str) -> str:
    """Return the address without a slash at its end. Raise ValueError."""
    if not url.startswith(("http://", "https://")):
        raise ValueError('must begin with "http://" or "https://"')
    return url.rstrip("/")


Url = Annotated[str, Field(max_length=300), AfterValidator(_check_url)]


class NewLabRobot(RequestBody):
    """A robot that a lab is to pull from."""

    name: Name
    url: Url = Field(description="its address, such as https://turtle.local:8000")
    token: Annotated[str, Field(min_length=1, max_length=200)] = Field(
        description="one of the robot's tokens with the scope “operate”"
    )
    certificate: Annotated[str, Field(max_length=20_000)] = Field(
        default="",
        description="PEM of the robot's certificate; empty with HTTP, and where a public authority signed it",
    )


class LabRobot(Schema):
    """A robot of a lab, and what comes of pulling from it."""

    id: int
    name: str
    url: str
    added: datetime = Field(description="UTC")
    phase: Phase
    text: str = Field(description="what it does, or why it does not, as a sentence")
    lacking: int = Field(description="sessions that the archive lacks, as of the last look")
    problems: list[str] = Field(description="sessions that cannot be pulled, and why; at most ten")
    seen: datetime | None = Field(description="UTC; when it answered last, since the lab was started")
