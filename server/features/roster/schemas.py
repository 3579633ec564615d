"""Schemas of a lab's robots."""

from typing import Annotated

from pydantic import Field

from server.http.request_body import RequestBody
from server.interchange.presence import Presence
from server.platform.schema_base import Schema


class RosterRobot(Schema):
    """A robot that has joined the lab, and its last presence."""

    name: str
    joined: Annotated[float, Field(description="s since 1970")]
    present: Annotated[bool, Field(description="false where it is not heard now")]
    seen: Annotated[float | None, Field(description="s since its last presence; null before the first")]
    presence: Presence | None
    depths: Annotated[list[float | None], Field(description="m; of the last minute, once a second")]
    clock_offset: Annotated[
        float | None, Field(description="s by which its clock is ahead of the lab's; null until measured")
    ]
    address: Annotated[
        str, Field(description="of its own page; empty where that is open to no other computer")
    ]


class RosterDetails(Schema):
    """The lab's robots by name; `problem` says why none can be heard, empty otherwise."""

    robots: list[RosterRobot]
    problem: str


class MadeJoiningCode(Schema):
    """A code by which one robot joins; `expires` in s since 1970, `command` is for the robot's shell."""

    code: str
    address: str
    command: str
    expires: float


class JoiningRobot(RequestBody):
    """A robot that joins by a code: its own page, that page's certificate, and a token for reading it."""

    code: Annotated[str, Field(min_length=1, max_length=64)]
    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,31}$")]
    address: Annotated[str, Field(pattern=r"^(https?://[^/@\s]+)?$", max_length=200)]
    fingerprint: Annotated[str, Field(max_length=100)]
    token: Annotated[str, Field(min_length=1, max_length=200)]


class IssuedMembership(Schema):
    """The answer to a robot: the lab's name, its router's port, and the robot's certificate with its key."""

    lab: str
    router_port: int
    authority: str
    certificate: str
    key: str


class StoppedRobot(Schema):
    """The answers of one robot to STOP; `zenoh` and `https` are empty where it has answered that way."""

    name: str
    stopped: bool
    zenoh: str
    https: str
