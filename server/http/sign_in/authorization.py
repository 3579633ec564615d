"""Whether somebody may do what is asked: the table in `policy`, applied to every route and message."""

from fastapi import HTTPException
from starlette.requests import HTTPConnection

from server.features.lease.admission import require_control
from server.http.sign_in.identity import IDENTITY, Identity
from server.http.sign_in.policy import MESSAGES, OPERATIONS, Need


async def admit(connection: HTTPConnection) -> None:
    """For every router: raises HTTPException with 401 or 403 where this operation may not be asked for, and
    NotInControl where it needs the control, and another seat has it.

    The live socket is let in with a sign-in; each of its messages is then asked about (`may_say`).
    """
    if connection.scope["type"] == "websocket":
        need: Need | None = Need.VIEWER
    else:
        need = OPERATIONS.get(getattr(connection.scope["route"], "operation_id", None) or "")
    reason = refusal(connection.scope.get(IDENTITY), need)
    if reason is not None:
        raise HTTPException(403, reason)
    if need == Need.CONTROL:
        require_control(connection)


def may_say(identity: Identity, op: str) -> str | None:
    """Why this message of a live socket is not obeyed; None where it is."""
    return refusal(identity, MESSAGES.get(op))


def refusal(identity: Identity | None, need: Need | None) -> str | None:
    """Why this is not for this one; None where it is. What has no entry is for nobody."""
    if need is None:
        return "Nobody may ask for this: it is not in the server's table of what is allowed."
    if need == Need.NOTHING:
        return None
    if identity is None:
        return "You are not signed in."
    if need >= Need.OPERATOR and identity.role != "operator":
        return "This needs the role of an operator; you are a viewer. Ask an operator to make you one."
    return None
