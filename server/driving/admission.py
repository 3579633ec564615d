"""Admission of requests: the check of the caller's role, and of its control if needed."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection, Request

from server.driving.arbiter import ControlArbiter
from server.driving.clients import ControlClient
from server.http.dependencies import find_service
from server.http.sign_in.access import Access
from server.http.sign_in.confirmation import UNCONFIRMED, UnconfirmedError
from server.http.sign_in.identity import IDENTITY, Identity
from server.http.sign_in.policy import Need, need_of, refusal
from server.platform.errors import ConflictError, ForbiddenError, SignedOutError

HEADER = "x-mucat-client"


async def admit(connection: HTTPConnection) -> None:
    """Check a request to any router, once its body has been read, and again after each wait.

    The sign-in was checked at the request's head: until now it may have been revoked, or its role changed.
    The live socket needs a sign-in; each of its messages is checked by itself (`may_say`). Raise
    SignedOutError, ForbiddenError, UnconfirmedError if a browser asks for a dangerous act without a fresh
    confirmation, or NotInControlError if the operation needs control and another client has it.
    """
    socket = connection.scope["type"] == "websocket"
    need = Need.VIEWER if socket else need_of(connection.scope["route"])
    before = connection.scope.get(IDENTITY)
    identity = connection.scope[IDENTITY] = find_service(connection, Access).refresh(before)
    if identity is None and before is not None and need != Need.NOTHING:
        raise SignedOutError("Your access was revoked before the request was complete.")
    reason = refusal(identity, need)
    if reason is not None:
        raise ForbiddenError(reason)
    if need == Need.ADMINISTER:
        _require_confirmation(connection)
    if need == Need.CONTROL:
        require_control(connection)


async def read_admitted(request: Request) -> AsyncIterator[bytes]:
    """Yield the body of a request, in pieces: a long upload ends with its sender's access."""
    async for piece in request.stream():
        await admit(request)
        yield piece


def _require_confirmation(connection: HTTPConnection) -> None:
    try:
        find_service(connection, Access).confirmations.require(connection.scope[IDENTITY])
    except UnconfirmedError:
        connection.scope[UNCONFIRMED] = True
        raise


def require_control(connection: HTTPConnection) -> None:
    """Check that the client in control sends the request. Raise NotInControlError."""
    find_service(connection, ControlArbiter).require(_find_client(connection))


async def require_client(connection: HTTPConnection) -> ControlClient:
    """Return the client that sends the request; a program's is opened if needed. Raise ConflictError."""
    client, identity = _find_client(connection), connection.scope[IDENTITY]
    if client is None and HEADER not in connection.headers and identity.kind != "browser":
        client = find_service(connection, ControlArbiter).open_program(identity)
    if client is None:
        raise ConflictError(
            "This request names no open page. A page gets its key in `hello` on its live socket: reload it.",
        )
    return client


OwnClient = Annotated[ControlClient, Depends(require_client)]
"""A route's parameter that is the control client of the caller."""


def _find_client(connection: HTTPConnection) -> ControlClient | None:
    """Return the page whose key the request names, or the caller's programs, whose time starts anew."""
    identity: Identity = connection.scope[IDENTITY]
    return find_service(connection, ControlArbiter).clients.find(identity, connection.headers.get(HEADER))
