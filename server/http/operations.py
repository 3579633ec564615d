"""Operations of the HTTP interface: routes that declare their need; name and texts are their function's."""

from collections.abc import Callable, Mapping, Sequence
from inspect import cleandoc
from typing import Annotated, Any, Literal, TypeVar

from fastapi import APIRouter, Path, Query
from fastapi.params import Depends
from pydantic import Field
from starlette.responses import Response
from starlette.routing import BaseRoute

from robot_runtime.contract.problems import EntryProblem
from server.http.addresses import refuse_unknown_parameters
from server.http.json_bodies import JsonRoute
from server.http.sign_in.confirmation import UnconfirmedError
from server.http.sign_in.policy import LINKED, Need, needs
from server.platform.errors import ApiError
from server.platform.limits import IDENTIFIER_MAX
from server.platform.schema_base import Schema

Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])
Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]
"""The number of a row of the database, in a path."""
MeantRun = Annotated[str | None, Query(description="the run that is meant: refused if it is over")]
MeantNumber = Annotated[int | None, Query(description="the run that is meant: refused if it is over")]
Errors = type[ApiError] | Mapping[int, str]
"""Errors of an operation: a class of them, or descriptions by status."""


class Problem(Schema):
    """An error: what happened, why, and what to do.

    `problems` are those of a document or a request, by entry. `kind` is `confirmation` where a browser must
    confirm first, by `POST /api/access/confirm`, and `changed` where somebody else has changed the thing
    since the editing began.
    """

    detail: str
    kind: Literal["", "confirmation", "changed"] = ""
    problems: list[EntryProblem] = Field(default=[])


EVERYWHERE: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "model": Problem,
        "description": "Refused: not signed in (401), not allowed or from elsewhere (403), too large (413), "
        "not valid (422)",
    },
    503: {"model": Problem, "description": "Something that the server needs does not work"},
    507: {"model": Problem, "description": "The disk is full"},
}
"""The answers that every operation may give."""


class Operations:
    """The operations of one room, and its sockets.

    A route is built when all of it is known: FastAPI builds those of an included router once more, which
    takes a tenth of a server's start.
    """

    def __init__(self, prefix: str = "", tags: Sequence[str] = (), *, admits_itself: bool = False) -> None:
        self.admits_itself = admits_itself
        """True where its sockets check by themselves who opens them."""
        self._prefix = prefix
        self._tags = tags
        self._declared: list[Callable[[APIRouter], None]] = []

    def build(
        self,
        dependencies: Sequence[Depends] = (),
        responses: Mapping[int | str, dict[str, Any]] | None = None,
    ) -> list[BaseRoute]:
        """Return the routes. All of them have these dependencies, and all operations these answers."""
        router = APIRouter(
            prefix=self._prefix,
            tags=[*self._tags],
            dependencies=[*dependencies],
            responses={**(responses or {})},
            route_class=JsonRoute,
        )
        for declare in self._declared:
            declare(router)
        return router.routes

    def socket(self, path: str) -> Callable[[Endpoint], Endpoint]:
        """Add a WebSocket."""

        def add(endpoint: Endpoint) -> Endpoint:
            self._declared.append(lambda router: router.add_api_websocket_route(path, endpoint))
            return endpoint

        return add

    def operation(
        self,
        address: str,
        need: Need,
        *errors: Errors,
        media_type: str = "",
        linked: bool = False,
        lenient: bool = False,
        **options: Any,
    ) -> Callable[[Endpoint], Endpoint]:
        """Add the operation at `place`, such as "GET /things".

        Its name is the function's, and its summary the first line of the function's docstring. `media_type`
        is that of an answer other than JSON. A function that returns None is answered with 204. `linked` is a
        file, picture or frame that the page names by its address, so that a browser's cookie alone must do.
        `lenient`: it is carried out also with query parameters that it does not know.
        """
        method, _, path = address.partition(" ")
        texts = {423: "Control is with somebody else"} if need is Need.CONTROL else {}
        if need is Need.ADMINISTER:
            texts |= UnconfirmedError.answers()
        for error in errors:
            texts |= error if isinstance(error, Mapping) else error.answers()
        responses: dict[int | str, Any] = {
            status: {"model": Problem, "description": text} for status, text in texts.items()
        }
        if not lenient:
            options["dependencies"] = [Depends(refuse_unknown_parameters)]
        if media_type:
            options["response_class"] = Response
            responses[200] = {"content": {media_type: {}}}

        def add(endpoint: Endpoint) -> Endpoint:
            first, *parts = endpoint.__name__.split("_")
            if endpoint.__annotations__["return"] is None:
                options["status_code"] = 204
            extra = needs(need) | ({LINKED: True} if linked else {}) | options.pop("openapi_extra", {})
            self._declared.append(
                lambda router: router.add_api_route(
                    path,
                    endpoint,
                    methods=[method],
                    operation_id=first + "".join(map(str.capitalize, parts)),
                    summary=cleandoc(endpoint.__doc__ or "").partition("\n")[0].removesuffix("."),
                    openapi_extra=extra,
                    responses=responses,
                    **options,
                )
            )
            return endpoint

        return add
