"""The control of the robot: who has it, asking for it, giving it away."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request

from server.container import Assembly
from server.features.lease import schemas
from server.features.lease.admission import require_seat
from server.features.lease.arbiter import Desk
from server.features.lease.clients import PROGRAM_SECONDS, Seat
from server.http.problems import answers
from server.http.sign_in.identity import Identity

NO_SEAT = answers(_409="The request names no seat")
OTHERS = answers(_423="Control is with somebody else")

router = APIRouter(prefix="/api/control", tags=["control"])

OwnSeat = Annotated[Seat, Depends(require_seat)]


@router.get("", summary="Who has control", operation_id="getControl")
async def get_control(request: Request) -> schemas.Control:
    """And who asks for it, and what has come of the driving commands."""
    desk = _desk(request)
    return schemas.Control(**desk.state().model_dump(), driven=desk.driving.counts)


@router.post(
    "/seat",
    status_code=201,
    summary="A seat for a program",
    operation_id="openSeat",
    responses=answers(_409="Too many programs of this device have one"),
)
async def open_seat(request: Request) -> schemas.SeatGiven:
    """Its key goes into the header X-Mucat-Seat of what follows; 10 s without such a request end it."""
    seat = _desk(request).seat_program(Identity.of(request))
    return schemas.SeatGiven(seat=seat.number, key=seat.key, lasts=PROGRAM_SECONDS)


@router.post(
    "/take",
    summary="Take control, or ask for it",
    operation_id="takeControl",
    responses=answers(_409="The request names no seat; somebody else has asked; it was refused a moment ago"),
)
async def take(request: Request, seat: OwnSeat) -> schemas.ControlState:
    """Free control is taken at once. Where it is held, the holder has 10 s to refuse; then it passes."""
    _desk(request).take(seat)
    return _desk(request).state()


@router.post("/release", summary="Give control back", operation_id="releaseControl", responses=NO_SEAT)
async def release(request: Request, seat: OwnSeat) -> schemas.ControlState:
    """Or ask for it no longer. Whoever has asked for it has it at once."""
    _desk(request).release(seat)
    return _desk(request).state()


@router.post(
    "/refuse",
    summary="Keep control",
    operation_id="refuseControl",
    responses={**answers(_409="Nobody asks for it"), **OTHERS},
)
async def refuse(request: Request, seat: OwnSeat) -> schemas.ControlState:
    """Whoever was refused may ask again after 10 s."""
    _desk(request).refuse(seat)
    return _desk(request).state()


@router.post("/renew", summary="Keep a program's seat", operation_id="renewSeat", responses=NO_SEAT)
async def renew(request: Request, _: OwnSeat) -> schemas.ControlState:
    """Any request that needs control or a seat does that too."""
    return _desk(request).state()


@router.post(
    "/hand-over",
    summary="Give control to somebody",
    operation_id="handOverControl",
    responses={**answers(_409="There is no such seat, or it is a viewer's"), **OTHERS},
)
async def hand_over(request: Request, seat: OwnSeat, to: schemas.HandOver) -> schemas.ControlState:
    """At once, also where somebody else has asked for it."""
    _desk(request).hand_over(seat, to.seat)
    return _desk(request).state()


def _desk(request: Request) -> Desk:
    return Assembly.of(request).desk
