"""Schemas of the pull from a lab's robots."""

from datetime import datetime
from typing import Literal

from pydantic import Field

from server.platform.schema_base import Schema

Phase = Literal["waiting", "pulling", "done", "armed", "unreachable", "failed"]


class RobotPull(Schema):
    """The pull from one robot of the lab, and what the archive has of it."""

    robot: str = Field(description="its name, as in `GET /api/robots`")
    phase: Phase
    text: str = Field(description="what it does, or why it does not, as a sentence")
    progress: float = Field(description="from 0 to 1, of the session that is being pulled")
    lacking: int = Field(description="sessions that the archive lacks, as of the last look")
    problems: list[str] = Field(description="sessions that cannot be pulled, and why; at most ten")
    seen: datetime | None = Field(description="UTC; when it answered last, since the lab was started")
    sessions: int = Field(description="its sessions in the archive, as of the last look")
    pulled: datetime | None = Field(description="UTC; when the last of them was pulled; null before")
