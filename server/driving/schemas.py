"""Schemas of control, and of changes of parameters, in the HTTP interface."""

from datetime import datetime
from typing import Annotated

from pydantic import Field, FiniteFloat, StrictBool, StrictInt

from server.platform.schema_base import Schema

Number = Annotated[FiniteFloat, Field(strict=True)]
Text = Annotated[str, Field(max_length=100)]
Value = StrictBool | StrictInt | Number | Text
"""A parameter's value."""


class Holder(Schema):
    """The client in control."""

    client: int
    name: str


class DriveCounts(Schema):
    """Stick commands since the server started: passed to the robot, and dropped for a reason."""

    passed: int = 0
    not_in_control: int = Field(default=0, description="from a client without control")
    other_lease: int = Field(default=0, description="of an earlier change of control")
    not_newer: int = Field(default=0, description="not after the last one that was passed on")
    too_old: int = Field(default=0, description="more than 0.3 s old when it came")
    from_the_future: int = Field(default=0, description="more than 0.3 s ahead of the robot's clock")


class ControlState(Schema):
    """The holder of control, as on the live socket."""

    epoch: int = Field(description="grows with every change of the holder")
    holder: Holder | None


class ControlDetails(ControlState):
    """The holder of control, and the counts of stick commands."""

    driven: DriveCounts


class ChangedValue(Schema):
    """One parameter before and after a change."""

    name: str
    before: Value
    after: Value


class Change(Schema):
    """Parameters that were changed together."""

    id: int
    time: datetime = Field(description="UTC")
    who: str
    why: str = Field(description="“Profile NAME” for a restored profile, else empty")
    values: list[ChangedValue]
    undone: str = Field(description="the person who undid it; empty if it was not undone")
    undoable: bool = Field(description="true for the next change that can be undone")


class LeftOut(Schema):
    """A parameter that was not set, and the reason."""

    name: str
    why: str


class Restored(Schema):
    """The parameters that a command changed, and those that it omitted."""

    changed: list[ChangedValue]
    left_out: list[LeftOut]
