"""Shapes of the control in the interface."""

from pydantic import BaseModel, Field

from server.http.sign_in.identity import Kind, Role


class Holder(BaseModel):
    """Who has control."""

    seat: int
    name: str


class Asking(BaseModel):
    """Who asks for control; granted at `until` unless the holder refuses."""

    seat: int
    name: str
    until: float = Field(description="s, steady clock")


class RefusedSeat(BaseModel):
    """Whose request was refused last; that seat may ask again after `until`."""

    seat: int
    until: float = Field(description="s, steady clock")


class Seated(BaseModel):
    """One page or program that is there; those of operators may have control."""

    seat: int
    name: str
    role: Role
    kind: Kind


class Driven(BaseModel):
    """Driving commands since the server started: how many reached the robot, and how many were dropped."""

    passed: int = 0
    not_in_control: int = Field(default=0, description="from a seat without control")
    other_lease: int = Field(default=0, description="of an earlier change of control")
    not_newer: int = Field(default=0, description="not after the last one that was passed on")
    too_old: int = Field(default=0, description="more than 0.3 s old when it came")
    from_the_future: int = Field(default=0, description="more than 0.3 s ahead of the robot's clock")


class ControlState(BaseModel):
    """Who has control and who asks for it, as on the live socket."""

    epoch: int = Field(description="grows with every change of the holder")
    holder: Holder | None
    request: Asking | None
    refused: RefusedSeat | None
    seats: list[Seated] = Field(description="all that there are, the oldest first")


class Control(ControlState):
    """The same, and what has come of the driving commands."""

    driven: Driven


class SeatGiven(BaseModel):
    """A program's seat. `key` is told only here; it goes into the header X-Mucat-Seat."""

    seat: int
    key: str
    lasts: float = Field(description="s after its last use")


class HandOver(BaseModel):
    """To which seat."""

    seat: int = Field(ge=1, le=2**53)
