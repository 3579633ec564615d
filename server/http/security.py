"""Checks of Host and Origin, security headers, and refusals before the application sees a request.

The check of Host guards against DNS rebinding, where a foreign name points here; that of Origin against
foreign pages in the operator's browser. No address is trusted; `server.public_url` is
one more name of the server, and so is the very address at which a request arrives: it may be new since the
server began, and no foreign name is an address.
"""

import json
from collections.abc import Collection
from ipaddress import IPv6Address, ip_address

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
POLICY_VIOLATION = 1008
"""WebSocket close code for a client that breaks the rules."""
BODY_BYTES_MAX = 65_536
DOORS = frozenset({"/rosbridge", "/foxglove"})
"""Sockets of other programs, which pages of any origin may open: a token counts there, and a cookie never."""
FRAMED = "/api/panels/frame"
"""The frame of own panels, with a stricter policy of its own (panels/frame.py)."""
HELP = "/help/"
"""The help pages, whose policies name their scripts (http/help_pages.py)."""
OWN_POLICY = frozenset({"content-security-policy", "x-frame-options"})
STREAMED = frozenset({"/api/imports", "/api/update/release"})
"""Paths that read bodies of any size piece by piece, and check their limits themselves."""
HEADERS = {
    "content-security-policy": "default-src 'self'; img-src 'self' blob:; media-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}


class SecurityMiddleware:
    """ASGI middleware: refuses foreign hosts and origins with 403, and adds the security headers.

    `allowed_hosts` are names without a port; `port` is the one the server listens on. Whoever calls it by its
    `public_url` uses the scheme of that, whatever the proxy uses.
    """

    def __init__(self, app: ASGIApp, allowed_hosts: Collection[str], port: int, public_url: str = "") -> None:
        self._app = app
        self._ports = (f":{port}", "") if port in (80, 443) else (f":{port}",)
        self._hosts = {host + port for host in allowed_hosts for port in self._ports}
        self._public_scheme, _, self._public_host = public_url.partition("://")
        if public_url:
            self._hosts.add(self._public_host)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        if self._public_host and Headers(scope=scope).get("host", "").lower() == self._public_host:
            socket = scope["type"] == "websocket"
            scope["scheme"] = self._public_scheme.replace("http", "ws") if socket else self._public_scheme
        reason = self._refusal(scope)
        streamed = scope["path"] in STREAMED
        if reason is None and scope["type"] == "http" and not streamed and _has_large_body(scope):
            text = f"A request's body may have {BODY_BYTES_MAX} bytes, and must say how many."
            await refuse(scope, receive, _with_headers(send, scope), 413, text)
        elif reason is None:
            # Messages of an open socket have no headers, and are too many for a detour.
            opened = scope["type"] == "websocket"
            await self._app(scope, receive, send if opened else _with_headers(send, scope))
        else:
            await refuse(scope, receive, _with_headers(send, scope), 403, reason)

    def _refusal(self, scope: Scope) -> str | None:
        """Return the reason to refuse this request; None if it is allowed."""
        headers = Headers(scope=scope)
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        if len(hosts) != 1 or not self._is_own_host(hosts[0].lower(), scope):
            named = hosts[0] if hosts else "none"
            return (
                f"The address {named[:100]} is not one of this server's. Use one of "
                f"{', '.join(sorted(self._hosts))}, or add it to server.allowed_hosts in robot.toml."
            )
        if scope["path"] in DOORS:
            return None
        unsafe = scope["type"] == "websocket" or scope["method"] not in SAFE_METHODS
        if not origins:
            # Browsers send Origin with all of these; programs send neither this nor Sec-Fetch-Site.
            if unsafe and headers.get("sec-fetch-site") not in (None, "same-origin"):
                return "A browser must name the page that asks (Origin). Open this server's own page."
            return None
        if len(origins) > 1 or not _is_own(origins[0], hosts[0], scope["scheme"]):
            return f"Pages of {origins[0][:100]} may not talk to this robot. Open this server's own page."
        return None

    def _is_own_host(self, host: str, scope: Scope) -> bool:
        if host in self._hosts:
            return True
        address = _own_address(scope)
        return address is not None and host in {address + port for port in self._ports}


def _own_address(scope: Scope) -> str | None:
    """Return the server's address at which the request arrived, as a URL has it; None at a Unix socket."""
    try:
        address = ip_address((scope.get("server") or ("",))[0])
    except ValueError:
        return None
    if isinstance(address, IPv6Address):
        # A socket for both families shows an IPv4 address as an IPv6 one.
        return f"[{address}]" if address.ipv4_mapped is None else str(address.ipv4_mapped)
    return str(address)


def _is_own(origin: str, host: str, scheme: str) -> bool:
    page_scheme = {"ws": "http", "wss": "https"}.get(scheme, scheme)
    return origin.lower() == f"{page_scheme}://{host}".lower()


def _with_headers(send: Send, scope: Scope) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in HEADERS.items():
                if not _has_own_policy(scope["path"]) or name not in OWN_POLICY or name not in headers:
                    headers[name] = value
            if scope["path"].startswith("/api"):
                headers.setdefault("cache-control", "no-store")
        await send(message)

    return send_with_headers


def _has_own_policy(path: str) -> bool:
    return path == FRAMED or path.startswith(HELP)


def _has_large_body(scope: Scope) -> bool:
    headers = Headers(scope=scope)
    length = headers.get("content-length", "0")
    return "transfer-encoding" in headers or not length.isdecimal() or int(length) > BODY_BYTES_MAX


async def refuse(scope: Scope, receive: Receive, send: Send, status: int, reason: str) -> None:
    """Answer with a reason, without reading the rest of the request."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": reason})
        return
    body = json.dumps({"detail": reason}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    if status == 401:
        headers.append((b"www-authenticate", b"Bearer"))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
