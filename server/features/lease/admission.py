"""What a request has to show where it needs the control: the key of the seat that has it."""

from fastapi import HTTPException
from starlette.requests import HTTPConnection

from server.container import Assembly
from server.features.lease.clients import Seat
from server.http.sign_in.identity import Identity

HEADER = "x-mucat-seat"


def find_seat(connection: HTTPConnection) -> Seat | None:
    """The seat that this request names and may use; a program's lasts on by that."""
    key = connection.headers.get(HEADER)
    return None if key is None else Assembly.of(connection).desk.seats.use(Identity.of(connection), key)


def require_seat(connection: HTTPConnection) -> Seat:
    """The same, for a route that is about the seat itself. Raises HTTPException (409)."""
    seat = find_seat(connection)
    if seat is None:
        raise HTTPException(
            409,
            "This request names no seat that there is. A page has one while its live socket is open; a "
            "program gets one with POST /api/control/seat, which it loses after 10 s without a request.",
        )
    return seat


def require_control(connection: HTTPConnection) -> None:
    """Raises NotInControl where it comes from another seat than the one that has control."""
    Assembly.of(connection).desk.require(find_seat(connection))
