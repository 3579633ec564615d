"""Whether somebody may ask for an operation, or say something on the live socket, by the role."""

from server.http.sign_in.identity import Identity
from server.http.sign_in.policy import MESSAGES, Need


def may_say(identity: Identity, op: str) -> str | None:
    """Why this message of a live socket is not obeyed; None where it is."""
    return refusal(identity, MESSAGES.get(op))


def refusal(identity: Identity | None, need: Need | None) -> str | None:
    """Why this is not for this one; None where it is. What declares no need is for nobody."""
    if need is None:
        return "Nobody may ask for this: the server does not declare what it needs."
    if need == Need.NOTHING:
        return None
    if identity is None:
        return "You are not signed in."
    if need >= Need.OPERATOR and identity.role != "operator":
        return "This needs the role of an operator; you are a viewer. Ask an operator to make you one."
    return None
