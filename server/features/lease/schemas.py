"""Schemas of control in the HTTP interface."""

from pydantic import BaseModel, Field


class Holder(BaseModel):
    """The client in control."""

    client: int
    name: str


class DriveCounts(BaseModel):
    """Stick commands since the server started: passed to the robot, and dropped for a reason."""

    passed: int = 0
    not_in_control: int = Field(default=0, description="from a client without control")
    other_lease: int = Field(default=0, description="of an earlier change of control")
    not_newer: int = Field(default=0, description="not after the last one that was passed on")
    too_old: int = Field(default=0, description="more than 0.3 s old when it came")
    from_the_future: int = Field(default=0, description="more than 0.3 s ahead of the robot's clock")


class ControlState(BaseModel):
    """The holder of control, as on the live socket."""

    epoch: int = Field(description="grows with every change of the holder")
    holder: Holder | None


class ControlDetails(ControlState):
    """The holder of control, and the counts of stick commands."""

    driven: DriveCounts
