"""The control of the robot: who has it, asking for it, giving it away."""

from fastapi import APIRouter

from server.features.lease import schemas
from server.features.lease.admission import OwnSeat
from server.features.lease.arbiter import Desk
from server.features.lease.clients import PROGRAM_SECONDS
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs

NO_SEAT = answers(_409="The request names no seat")
OTHERS = answers(_423="Control is with somebody else")

router = APIRouter(prefix="/api/control", tags=["control"])


@router.get("", summary="Who has control", operation_id="getControl", openapi_extra=needs(Need.VIEWER))
async def get_control(desk: Provided[Desk]) -> schemas.Control:
    """And who asks for it, and what has come of the driving commands."""
    return schemas.Control(**desk.state().model_dump(), driven=desk.driving.counts)


@router.post(
    "/seat",
    status_code=201,
    summary="A seat for a program",
    operation_id="openSeat",
    openapi_extra=needs(Need.OPERATOR),
    responses=answers(_409="Too many programs of this device have one"),
)
async def open_seat(desk: Provided[Desk], caller: Caller) -> schemas.SeatGiven:
    """Its key goes into the header X-Mucat-Seat of what follows; 10 s without such a request end it."""
    seat = desk.seat_program(caller)
    return schemas.SeatGiven(seat=seat.number, key=seat.key, lasts=PROGRAM_SECONDS)


@router.post(
    "/take",
    summary="Take control, or ask for it",
    operation_id="takeControl",
    openapi_extra=needs(Need.OPERATOR),
    responses=answers(_409="The request names no seat; somebody else has asked; it was refused a moment ago"),
)
async def take(desk: Provided[Desk], seat: OwnSeat) -> schemas.ControlState:
    """Free control is taken at once. Where it is held, the holder has 10 s to refuse; then it passes."""
    desk.take(seat)
    return desk.state()


@router.post(
    "/release",
    summary="Give control back",
    operation_id="releaseControl",
    openapi_extra=needs(Need.OPERATOR),
    responses=NO_SEAT,
)
async def release(desk: Provided[Desk], seat: OwnSeat) -> schemas.ControlState:
    """Or ask for it no longer. Whoever has asked for it has it at once."""
    desk.release(seat)
    return desk.state()


@router.post(
    "/refuse",
    summary="Keep control",
    operation_id="refuseControl",
    openapi_extra=needs(Need.CONTROL),
    responses={**answers(_409="Nobody asks for it"), **OTHERS},
)
async def refuse(desk: Provided[Desk], seat: OwnSeat) -> schemas.ControlState:
    """Whoever was refused may ask again after 10 s."""
    desk.refuse(seat)
    return desk.state()


@router.post(
    "/renew",
    summary="Keep a program's seat",
    operation_id="renewSeat",
    openapi_extra=needs(Need.OPERATOR),
    responses=NO_SEAT,
)
async def renew(desk: Provided[Desk], _: OwnSeat) -> schemas.ControlState:
    """Any request that needs control or a seat does that too."""
    return desk.state()


@router.post(
    "/hand-over",
    summary="Give control to somebody",
    operation_id="handOverControl",
    openapi_extra=needs(Need.CONTROL),
    responses={**answers(_409="There is no such seat, or it is a viewer's"), **OTHERS},
)
async def hand_over(desk: Provided[Desk], seat: OwnSeat, to: schemas.HandOver) -> schemas.ControlState:
    """At once, also where somebody else has asked for it."""
    desk.hand_over(seat, to.seat)
    return desk.state()
