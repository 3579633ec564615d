"""JSON bodies of requests, read as every other text of people and programs."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute

from robot_runtime.contract.text_input import read_json


class JsonRoute(APIRoute):
    """A route that refuses a body which is not UTF-8, names a key twice or holds NaN."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the route's handler, for requests of this class."""
        handle = super().get_route_handler()

        async def read(request: Request) -> Response:
            return await handle(_JsonRequest(request.scope, request.receive))

        return read


class _JsonRequest(Request):
    async def json(self) -> Any:
        """Return the body. Raise TextError."""
        return read_json(await self.body())
