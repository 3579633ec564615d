"""The limit of requests of one address behind a trusted proxy, whose connections are not its clients' own."""

from collections import Counter

from starlette.types import ASGIApp, Receive, Scope, Send

from server.http.audit import address_of
from server.http.connections import ADDRESS_MAX
from server.http.security import refuse


class RequestsOfAddress:
    """ASGI middleware: refuses with 429 an address's requests beyond `ADDRESS_MAX` at the same time.

    uvicorn has put the client's own address into the scope by then (`server.http.serving`).
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._under_way: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        address = address_of(scope)
        if self._under_way[address] >= ADDRESS_MAX:
            text = "Too many requests of this address are under way already. Wait for their answers."
            await refuse(scope, receive, send, 429, text)
            return
        self._under_way[address] += 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._under_way[address] -= 1
            if not self._under_way[address]:
                del self._under_way[address]
