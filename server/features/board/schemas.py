"""Uploads of firmware in the interface."""

from datetime import datetime
from typing import Literal

from pydantic import Field

from server.http.request_body import RequestBody
from server.platform.schema_base import Schema

UploadPhase = Literal["idle", "reading", "uploading"]
UploadChoice = Literal["built", "previous"]


class PreviousFirmware(Schema):
    """The firmware that was on the board before the last upload of another one."""

    path: str = Field(description="on the robot's computer")
    since: datetime


class UploadState(Schema):
    """The present or last upload of firmware."""

    phase: UploadPhase = Field(description="reading: the firmware that is on the board is being read")
    progress: float = Field(description="0 to 1, of the phase; an upload is written, then verified")
    words: str = Field(description="how the last one ended")
    problem: str = Field(description="why it failed, and what to do; empty if it did not")
    previous: PreviousFirmware | None


class UploadOrder(RequestBody):
    """The firmware to upload: the one built with this software, or the previous one."""

    firmware: UploadChoice
