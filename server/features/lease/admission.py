"""Admission of requests: the role that an operation needs, and the control where it needs that."""

from typing import Annotated

from fastapi import Depends, HTTPException
from starlette.requests import HTTPConnection

from server.features.lease.arbiter import Desk
from server.features.lease.clients import Seat
from server.http.dependencies import find_service
from server.http.sign_in.authorization import refusal
from server.http.sign_in.identity import IDENTITY, Identity
from server.http.sign_in.policy import Need, need_of

HEADER = "x-mucat-seat"


async def admit(connection: HTTPConnection) -> None:
    """For every router: raises HTTPException with 401 or 403 where this operation may not be asked for, and
    NotInControl where it needs the control, and another seat has it.

    The live socket is let in with a sign-in; each of its messages is then asked about (`may_say`).
    """
    socket = connection.scope["type"] == "websocket"
    need = Need.VIEWER if socket else need_of(connection.scope["route"])
    reason = refusal(connection.scope.get(IDENTITY), need)
    if reason is not None:
        raise HTTPException(403, reason)
    if need == Need.CONTROL:
        require_control(connection)


def require_control(connection: HTTPConnection) -> None:
    """Raises NotInControl where it comes from another seat than the one that has control."""
    find_service(connection, Desk).require(_find_seat(connection))


async def require_seat(connection: HTTPConnection) -> Seat:
    """The seat that this request names. Raises HTTPException (409)."""
    seat = _find_seat(connection)
    if seat is None:
        raise HTTPException(
            409,
            "This request names no seat that there is. A page has one while its live socket is open; a "
            "program gets one with POST /api/control/seat, which it loses after 10 s without a request.",
        )
    return seat


OwnSeat = Annotated[Seat, Depends(require_seat)]
"""A route's parameter that is the seat of whoever asks."""


def _find_seat(connection: HTTPConnection) -> Seat | None:
    key = connection.headers.get(HEADER)
    if key is None:
        return None
    identity: Identity = connection.scope[IDENTITY]
    return find_service(connection, Desk).seats.use(identity, key)
