"""Admission of requests: the role that an operation needs, and the control where it needs that."""

from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from server.features.lease.arbiter import ControlArbiter
from server.features.lease.clients import ControlClient
from server.http.dependencies import find_service
from server.http.sign_in.identity import IDENTITY, Identity
from server.http.sign_in.policy import Need, need_of, refusal
from server.platform.errors import ConflictError, ForbiddenError

HEADER = "x-mucat-client"


async def admit(connection: HTTPConnection) -> None:
    """For every router: raises ForbiddenError where this operation may not be asked for, and
    NotInControlError where it needs the control, and another client has it.

    The live socket is let in with a sign-in; each of its messages is then asked about (`may_say`).
    """
    socket = connection.scope["type"] == "websocket"
    need = Need.VIEWER if socket else need_of(connection.scope["route"])
    reason = refusal(connection.scope.get(IDENTITY), need)
    if reason is not None:
        raise ForbiddenError(reason)
    if need == Need.CONTROL:
        require_control(connection)


def require_control(connection: HTTPConnection) -> None:
    """Raises NotInControlError if it comes from another client than the one in control."""
    find_service(connection, ControlArbiter).require(_find_client(connection))


async def require_client(connection: HTTPConnection) -> ControlClient:
    """The client that this request comes from; a program needs none before. Raises ConflictError."""
    client, identity = _find_client(connection), connection.scope[IDENTITY]
    if client is None and HEADER not in connection.headers and identity.kind != "browser":
        client = find_service(connection, ControlArbiter).open_program(identity)
    if client is None:
        raise ConflictError(
            "This request names no open page. A page has its key from `hello` while its live socket is open.",
        )
    return client


OwnClient = Annotated[ControlClient, Depends(require_client)]
"""A route's parameter that is the control client of the caller."""


def _find_client(connection: HTTPConnection) -> ControlClient | None:
    """The page whose key this request names, or the programs of who asks; a program's lasts on by that."""
    identity: Identity = connection.scope[IDENTITY]
    return find_service(connection, ControlArbiter).clients.find(identity, connection.headers.get(HEADER))
