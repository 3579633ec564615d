"""A segment of a dive."""

from pydantic import Field

from server.analysis.moments import Span
from server.platform.schema_base import Schema

TOGETHER = 1.0
"""s between two changes that belong together, and the least length of a segment that others follow."""

SEGMENTS_MAX = 200
"""Of a session, that are shown."""


class Segment(Schema):
    """A time in which the robot was armed and nothing was changed; s since the session's start."""

    start: float
    end: float
    mode: str = Field(description="empty where the recording lacks it")
    controller: str = Field(description="empty where no depth was held")
    title: str = Field(description="the controller's name for a person")
    gains: dict[str, float] = Field(description="by name")
    holds_depth: bool
    set_point: float | None = Field(
        description="m; null where no depth was held, or where it changed on and on"
    )

    @property
    def span(self) -> Span:
        """Its time."""
        return Span(self.start, self.end)
