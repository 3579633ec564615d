"""Sign-in check for everything under /api: refuses a request before its body is read."""

from contextlib import suppress

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.http.dependencies import find_service
from server.http.security import DOORS, SAFE_METHODS, refuse
from server.http.sign_in.access import PAGE_HEADER, Access
from server.http.sign_in.devices import SignInEndedError
from server.http.sign_in.identity import IDENTITY, SIGN_IN_ENDED, Identity
from server.http.sign_in.policy import is_linked, is_within_reach

OPEN = frozenset(
    {
        ("GET", "/api/alive"),
        ("GET", "/api/access/me"),
        ("POST", "/api/access/pair"),
        ("POST", "/api/access/read"),
        ("POST", "/api/robots/join"),
    }
)
"""The operations that need no sign-in."""
NOBODY = (
    "You are not signed in. Open the link that the server printed when it started, or that `mucat pair` "
    "prints; a program sends Authorization: Bearer with a token from `mucat access token`."
)


BEYOND = (
    "A reading link shows one session, and changes nothing. Sign this browser in for more: ask an operator "
    "for a link to sign in with."
)


class SignInMiddleware:
    """ASGI middleware: puts the caller's Identity into the scope.

    Refuses with 401 without one, and with 403 a browser that does not name this server's page as its origin,
    and a reader who asks for anything but the session of the reading link.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        nobody = NOBODY
        try:
            access = find_service(connection, Access)
            if scope["path"] in DOORS:
                identity = access.identify_program(connection)
            else:
                identity = access.identify(connection, lambda: _is_link(connection))
        except SignInEndedError as problem:
            identity, nobody = None, str(problem)
            scope[SIGN_IN_ENDED] = nobody
        path = scope["path"]
        if identity is None and _is_api(path) and (scope.get("method"), path) not in OPEN:
            await refuse(scope, receive, send, 401, nobody)
        elif identity is not None and (reason := _foreign(connection, identity)) is not None:
            await refuse(scope, receive, send, 403, reason)
        elif identity is not None and _is_beyond_reach(scope, identity):
            scope[IDENTITY] = identity
            await refuse(scope, receive, send, 403, BEYOND)
        elif identity is not None and scope["type"] == "http":
            scope[IDENTITY] = identity
            with suppress(_RevokedError):
                await self._app(
                    scope, receive, _stop_when_revoked(send, find_service(connection, Access), identity)
                )
        else:
            scope[IDENTITY] = identity
            await self._app(scope, receive, send)


def _is_beyond_reach(scope: Scope, identity: Identity) -> bool:
    """Return True where a reader asks for anything but the session of the reading link."""
    method, path = scope.get("method"), scope["path"]
    if identity.session is None or not _is_api(path) or (method, path) in OPEN:
        return False
    return not is_within_reach(scope["app"].routes, method, path, identity.session)


class _RevokedError(Exception):
    """The caller's access was revoked during an answer, whose rest is not sent."""


def _stop_when_revoked(send: Send, access: Access, identity: Identity) -> Send:
    """Return a request's `send`, which ends a long answer, such as a download, with the caller's access."""

    async def send_piece(message: Message) -> None:
        if message.get("more_body") and access.refresh(identity) is None:
            raise _RevokedError
        await send(message)

    return send_piece


def _is_api(path: str) -> bool:
    return path == "/api" or path.startswith("/api/")


def _foreign(connection: HTTPConnection, identity: Identity) -> str | None:
    """Return the reason why a foreign page may have caused this request of a browser."""
    socket = connection.scope["type"] == "websocket"
    if identity.kind in ("program", "lab", "shell") or (
        not socket and connection.scope["method"] in SAFE_METHODS
    ):
        return None
    if "origin" not in connection.headers:
        return "A browser must name the page that asks (Origin). Open this server's own page."
    return None


def _is_link(connection: HTTPConnection) -> bool:
    """Return True for a link or a picture on the page, which a browser fetches with the cookie alone."""
    scope = connection.scope
    if scope.get("method") != "GET" or PAGE_HEADER in connection.headers:
        return False
    return is_linked(scope["app"].routes, scope["path"])
