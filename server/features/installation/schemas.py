"""Updates in the interface."""

from datetime import datetime
from typing import Literal

from pydantic import Field

from server.platform.schema_base import Schema

UpdatePhase = Literal["none", "asked", "running", "done", "failed"]


class UpdateState(Schema):
    """The versions on the robot's computer, and the present or last update or way back."""

    installed: bool = Field(description="as services, which can be updated from a page")
    version: str = Field(description="in use")
    previous: str = Field(description="the one that `mucat rollback` goes back to; empty without one")
    refusal: str = Field(description="why none can be begun from a page now; empty if one can")
    phase: UpdatePhase = Field(description="since the computer's start; asked: it is about to begin")
    text: str = Field(description="what is being done, or how it ended")
    time: datetime | None = Field(description="of the text")
