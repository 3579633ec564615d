"""Services of the server, provided to routes by their type: `bridge: Provided[Bridge]`."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Annotated, TypeVar

from fastapi import Depends
from starlette.requests import HTTPConnection

T = TypeVar("T")


def find_service(connection: HTTPConnection, kind: type[T]) -> T:
    """Return the service of this type of the server that answers this request."""
    service: T = connection.app.state.services.get(kind)
    return service


def _provide(kind: type[T]) -> Callable[[HTTPConnection], Awaitable[T]]:
    # Not a plain function, for which FastAPI would take a thread at each request.
    async def provide(connection: HTTPConnection) -> T:
        return find_service(connection, kind)

    return provide


if TYPE_CHECKING:
    Provided = Annotated[T, "the server's service of this type"]
else:

    class Provided:
        """The annotation `Provided[T]` of a route's parameter: the server's service of the type T."""

        def __class_getitem__(cls, kind: type) -> object:
            """Return the annotation by which FastAPI resolves it."""
            return Annotated[kind, Depends(_provide(kind))]
