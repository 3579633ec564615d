"""Routes of the interface: built at their first use, and strict with JSON bodies."""

import threading
from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute
from starlette.routing import compile_path

from robot_runtime.contract.text_input import read_json

_BUILDING = threading.RLock()
"""Held while a route is built: functions of routes run in threads, and look at all of them."""


class JsonRoute(APIRoute):
    """A route that refuses a body which is not UTF-8, names a key twice or holds NaN.

    FastAPI examines an operation's parameters, body and answers when its route is made, which for all of them
    is a fifth of a server's start. Here this is done for the first request of that operation, or when it is
    described; until then the route has what is needed to find it and to judge who may call it.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        self.path, self.endpoint = path, endpoint
        self.path_regex, self.path_format, self.param_convertors = compile_path(path)
        self.name = endpoint.__name__
        self.methods = set(options["methods"])
        self.operation_id = options["operation_id"]
        self.openapi_extra = options["openapi_extra"]
        self.include_in_schema = True
        self._options = options

    def __getattr__(self, name: str) -> Any:
        """Return an attribute that the route has once it is built."""
        with _BUILDING:
            options = self.__dict__.pop("_options", None)
            if options is not None:
                super().__init__(self.path, self.endpoint, **options)
        if name in self.__dict__:
            return self.__dict__[name]
        raise AttributeError(name)

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
