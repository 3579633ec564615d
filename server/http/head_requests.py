"""HEAD requests: every GET answers them, with the same status and headers."""

from contextlib import suppress

from starlette.types import ASGIApp, Message, Receive, Scope, Send


class HeadRequests:
    """ASGI middleware: a HEAD request is a GET that ends where its body would begin (RFC 9110, 9.3.2)."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request; send only the head of the answer."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return
        scope["method"] = "GET"

        async def send_head(message: Message) -> None:
            if message["type"] == "http.response.body":
                await send({"type": "http.response.body"})
                raise _HeadSentError
            await send(message)

        with suppress(_HeadSentError):
            await self._app(scope, receive, send_head)


class _HeadSentError(Exception):
    """The answer is complete: its body is not sent."""
