"""Reads the JSON bodies of requests as every other text that people and programs hand over."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute

from robot_runtime.contract.text_input import read_json


class JsonRoute(APIRoute):
    """A route that refuses a body which is not UTF-8, names a key twice or holds NaN."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Returns the route's handler, for requests that read their body so."""
        handle = super().get_route_handler()

        async def read(request: Request) -> Response:
            return await handle(_JsonRequest(request.scope, request.receive))

        return read


class _JsonRequest(Request):
    async def json(self) -> Any:
        """The body. Raises TextError."""
        return read_json(await self.body())
