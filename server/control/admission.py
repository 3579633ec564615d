"""What a request has to show where it needs the control: the key of the seat that has it."""

from fastapi import HTTPException, Request

from server.access.identity import Identity
from server.access.policy import Need
from server.assembly import Assembly
from server.control.seats import Seat

HEADER = "x-mucat-seat"
SHELL = Identity(device=0, name="This computer's shell", role="operator", kind="shell")


def who(request: Request) -> Identity:
    """Who asks."""
    return getattr(request.state, "identity", SHELL)


def find_seat(request: Request) -> Seat | None:
    """The seat that this request names and may use; a program's lasts on by that."""
    key = request.headers.get(HEADER)
    return None if key is None else Assembly.of(request).desk.seats.use(who(request), key)


def require_seat(request: Request) -> Seat:
    """The same, for a route that is about the seat itself. Raises HTTPException (409)."""
    seat = find_seat(request)
    if seat is None:
        raise HTTPException(
            409,
            "This request names no seat that there is. A page has one while its live socket is open; a "
            "program gets one with POST /api/control/seat, which it loses after 10 s without a request.",
        )
    return seat


def require_control(request: Request) -> None:
    """Raises NotInControl where it comes from another seat than the one that has control."""
    Assembly.of(request).desk.require(find_seat(request))


async def admit(request: Request) -> None:
    """INTERIM, until the access room's own: enforce the control."""
    from server.access.policy import OPERATIONS

    operation = getattr(request.scope.get("route"), "operation_id", None)
    if OPERATIONS.get(operation or "", Need.NOTHING) is Need.CONTROL:
        require_control(request)
