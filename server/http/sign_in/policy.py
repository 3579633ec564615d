"""The access policy: each route declares its need. An operation without one is refused to everybody."""

from collections.abc import Iterable
from typing import Any

from fastapi.routing import iter_route_contexts
from starlette.routing import BaseRoute

from robot_runtime.contract.commands import Need as Need
from server.http.sign_in.identity import Identity

DECLARED = "x-need"
"""The entry of an operation in the interface's document that says its need."""

SESSION = "/api/sessions/{session}"
"""The address of a session."""
LINKED = "x-linked"
"""The entry of an operation that the page links to."""


def needs(need: Need) -> dict[str, Any]:
    """Return a route's `openapi_extra` that declares its need.

    Where the need depends on the request (a scenario on the robot), the route itself checks for more.
    """
    return {DECLARED: need.name.lower()}


def is_linked(routes: Iterable[BaseRoute], path: str) -> bool:
    """Return True where the path's route declares that the page links to it, or shows it."""
    return any(
        LINKED in (getattr(route, "openapi_extra", None) or {}) and route.path_regex.match(path) is not None
        for route in iter_route_contexts([*routes])
    )


def is_within_reach(routes: Iterable[BaseRoute], method: str | None, path: str, session: int) -> bool:
    """Return True where a reader of this session may ask: it reads what stands below the session's address.

    All else is refused, also what has no declared need, and every socket, which has no method.
    """
    return method == "GET" and any(
        _is_for_readers(route)
        and (parts := route.path_regex.match(path)) is not None
        and parts["session"] == str(session)
        for route in iter_route_contexts([*routes])
    )


def _is_for_readers(route: Any) -> bool:
    below = route.path == SESSION or route.path.startswith(f"{SESSION}/")
    return below and need_of(route) is Need.VIEWER and "GET" in (route.methods or ())


def need_of(route: Any) -> Need | None:
    """Return the need that a route declares; None where it declares none."""
    declared = (getattr(route, "openapi_extra", None) or {}).get(DECLARED)
    return None if declared is None else Need[declared.upper()]


def list_needs(routes: Iterable[BaseRoute]) -> dict[str, Need | None]:
    """Return the needs of all operations, by `operation_id`."""
    pairs = (
        (getattr(route, "operation_id", None), need_of(route)) for route in iter_route_contexts([*routes])
    )
    return {operation: need for operation, need in pairs if operation is not None}


def list_refused(routes: Iterable[BaseRoute], identity: Identity) -> list[str]:
    """Return the operations that the caller's role may not call, by `operation_id`; a reader's are all that
    do not read the session."""
    needs = list_needs(routes)
    if identity.session is None:
        return [name for name, need in needs.items() if need is not None and need > Need.VIEWER]
    contexts = iter_route_contexts([*routes])
    readable = {route.operation_id for route in contexts if _is_for_readers(route)}
    return [name for name in needs if name not in readable]


MESSAGES: dict[str, Need] = {
    "ping": Need.VIEWER,
    "stop": Need.VIEWER,
    "watch": Need.VIEWER,
    "drive": Need.CONTROL,
}
"""By `op`, on the live socket."""


def may_say(identity: Identity, op: str) -> str | None:
    """Return the reason to refuse this message of a live socket; None if it is allowed."""
    return refusal(identity, MESSAGES.get(op))


def refusal(identity: Identity | None, need: Need | None) -> str | None:
    """Return the reason to refuse the caller; None if it is allowed.

    Without a declared need, everybody is refused.
    """
    if need is None:
        return "Nobody may ask for this: the server does not declare what it needs."
    if need == Need.NOTHING:
        return None
    if identity is None:
        return "You are not signed in."
    if need == Need.ARCHIVE and identity.kind == "lab":
        return None
    if need > Need.VIEWER and identity.role != "operator":
        return "This needs the role of an operator; you are a viewer. Ask an operator to make you one."
    if need == Need.ADMINISTER and identity.limited:
        return "This needs a token with the scope “administer”, or an operator's browser."
    return None
