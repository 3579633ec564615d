"""Operations on a lab's robots."""

import socket
from typing import Annotated

from fastapi import Path, Request

from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY
from server.features.roster.joining_codes import (
    JoiningCodes,
    LabWithoutTlsError,
    WrongJoiningCodeError,
)
from server.features.roster.roster import CertificateNotMadeError, Roster
from server.features.roster.router_process import RouterProcess
from server.features.roster.schemas import (
    IssuedMembership,
    JoiningRobot,
    MadeJoiningCode,
    RosterDetails,
    StoppedRobot,
)
from server.http.audit import address_of
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.pairing_codes import TooManyTriesError
from server.http.sign_in.policy import Need
from server.platform.paired_robots import UnpairedRobotError

NOT_ADDED = {409: "A robot of this name has joined already, or too many have"}

router = Operations(prefix="/api/robots", tags=["lab"])


@router.operation("GET", Need.VIEWER)
async def list_robots(roster: Provided[Roster]) -> RosterDetails:
    """List the robots that have joined this lab, with their last presences."""
    return roster.listed()


@router.operation("POST /codes", Need.ADMINISTER, LabWithoutTlsError, status_code=201)
async def make_joining_code(request: Request, codes: Provided[JoiningCodes]) -> MadeJoiningCode:
    """Make a code by which one robot joins this lab, valid for ten minutes.

    Its second part is of the lab's certificate: by it the robot knows the lab before it sends anything.
    """
    return codes.make(request.headers["host"].rsplit(":", 1)[0].lower())


@router.operation(
    "POST /join",
    Need.NOTHING,
    WrongJoiningCodeError,
    TooManyTriesError,
    NOT_ADDED,
    CertificateNotMadeError,
    status_code=201,
)
async def join_robot(
    request: Request,
    codes: Provided[JoiningCodes],
    roster: Provided[Roster],
    lab_router: Provided[RouterProcess],
    body: JoiningRobot,
) -> IssuedMembership:
    """Add a robot by a code.

    Robots' servers ask for it (`POST /api/lab/join` there). The answer is the robot's certificate for the
    lab's Zenoh router.
    """
    codes.use(body.code, address_of(request.scope))
    files = await roster.join(body.name, body.address, body.fingerprint, body.token)
    return IssuedMembership(
        lab=socket.gethostname(),
        router_port=lab_router.port,
        authority=files[AUTHORITY],
        certificate=files[CERTIFICATE],
        key=files[KEY],
    )


@router.operation("POST /stop", Need.VIEWER, lenient=True)
async def stop_all_robots(roster: Provided[Roster]) -> list[StoppedRobot]:
    """Stop all robots at once.

    STOP goes to each by Zenoh and by HTTPS at the same time, and the answer names what each has answered,
    after two seconds at most. It is never refused.
    """
    return await roster.stop_all()


@router.operation("DELETE /{robot}", Need.ADMINISTER, UnpairedRobotError, CertificateNotMadeError)
async def remove_robot(roster: Provided[Roster], robot: Annotated[str, Path(max_length=32)]) -> None:
    """Remove a robot from this lab.

    Its certificate lets it in no more, and the lab forgets its token. The robot itself goes on, and can join
    again by a new code.
    """
    await roster.remove(robot)
