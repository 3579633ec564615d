"""Problems that keep the server from starting, as a sentence instead of a traceback."""

from collections.abc import Iterator
from contextlib import contextmanager

from fastapi import FastAPI
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.platform.settings import SetupError
from server.platform.store import StoreError

PROBLEM = "start_problem"
"""The entry of the application's state that holds the sentence."""


@contextmanager
def explaining_start(app: FastAPI) -> Iterator[None]:
    """Store the sentence of a problem that a person can solve, and raise the problem again."""
    try:
        yield
    except (SetupError, StoreError) as problem:
        setattr(app.state, PROBLEM, problem.detail if isinstance(problem, StoreError) else str(problem))
        raise


class StartProblems:
    """ASGI middleware: the web server logs the sentence where there is one."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request."""
        if scope["type"] != "lifespan":
            await self._app(scope, receive, send)
            return

        async def say(message: Message) -> None:
            problem = getattr(scope["app"].state, PROBLEM, "")
            if message["type"] == "lifespan.startup.failed" and problem:
                message = {**message, "message": problem}
            await send(message)

        await self._app(scope, receive, say)
