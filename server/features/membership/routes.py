"""Operations on the robot's membership in a lab."""

from typing import Annotated

from pydantic import Field

from server.features.membership.lab_link import LabLink
from server.features.membership.membership import LabUnreachableError, Membership, WrongJoiningError
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.request_body import RequestBody
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.disk_space import FileWriteError
from server.platform.schema_base import Schema

router = Operations(prefix="/api/lab", tags=["lab"])


class LabMembership(Schema):
    """The lab that the robot has joined; `name` is null without one. `joined` in s since 1970."""

    name: str | None
    address: str
    joined: float | None
    connected: Annotated[bool, Field(description="true while the lab's router is connected")]


class Joining(RequestBody):
    """A lab's address, and a code of it."""

    address: Annotated[str, Field(min_length=1, max_length=200)]
    code: Annotated[str, Field(min_length=1, max_length=64)]


class LeftLab(Schema):
    """The end of a membership; a lab that is not `notified` lists the robot until it is removed there."""

    notified: bool


@router.operation("GET", Need.VIEWER)
async def get_lab(membership: Provided[Membership], link: Provided[LabLink]) -> LabMembership:
    """Return the lab that the robot has joined."""
    return _describe(membership, link)


@router.operation(
    "POST /join",
    Need.ADMINISTER,
    WrongJoiningError,
    LabUnreachableError,
    FileWriteError,
    {409: "It has joined a lab already, or the lab refuses"},
)
async def join_lab(
    membership: Provided[Membership], link: Provided[LabLink], caller: Caller, body: Joining
) -> LabMembership:
    """Join a lab by a code.

    The lab gets the robot's presence once a second, and a token: with it, it reads, stops the robot, and
    fetches its sessions into the archive.
    """
    await membership.join(body.address, body.code, caller)
    return _describe(membership, link)


@router.operation("DELETE", Need.ADMINISTER, FileWriteError, {409: "It has joined no lab"})
async def leave_lab(membership: Provided[Membership], caller: Caller) -> LeftLab:
    """Leave the lab.

    Its token is invalid from now on.
    """
    return LeftLab(notified=await membership.leave(caller))


def _describe(membership: Membership, link: LabLink) -> LabMembership:
    lab = membership.lab
    return LabMembership(
        name=lab.name if lab else None,
        address=lab.address if lab else "",
        joined=lab.joined if lab else None,
        connected=link.connected,
    )
