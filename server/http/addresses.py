"""Refusals, in words, of addresses, methods and query parameters that the interface does not have."""

from collections.abc import Iterator
from difflib import get_close_matches

from fastapi import APIRouter, Request, Response
from fastapi.dependencies.models import Dependant
from fastapi.responses import JSONResponse
from fastapi.routing import iter_route_contexts
from pydantic import BaseModel

from server.platform.errors import InvalidError

METHODS = ("GET", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
ANY = "/api/{path:path}"
SHOWN_MAX = 80
"""Characters of a name that an answer repeats."""


class UnknownParameterError(InvalidError):
    """The operation has no such query parameter"""


async def refuse_unknown_parameters(request: Request) -> None:
    """Refuse a query parameter that the operation does not declare. Raises UnknownParameterError."""
    if not request.query_params:
        return
    known = tuple(dict.fromkeys(_parameters(request.scope["route"].dependant)))
    for name in request.query_params:
        if name not in known:
            there = f"There are: {', '.join(known)}." if known else "It has none."
            raise UnknownParameterError(
                f"The operation has no query parameter {shown(name)}. {nearest(name, known)}{there}"
            )


def nearest(name: str, known: tuple[str, ...]) -> str:
    """A question for the likely meaning of an unknown name; empty where none is near."""
    found = get_close_matches(name[:SHOWN_MAX], known, 1)
    return f"Did you mean '{found[0]}'? " if found else ""


def shown(name: str) -> str:
    """An unknown name as an answer repeats it."""
    return repr(name[:SHOWN_MAX])


def _parameters(dependant: Dependant) -> Iterator[str]:
    """The names of query parameters; those of a model are its fields."""
    for field in dependant.query_params:
        model = field.field_info.annotation
        if isinstance(model, type) and issubclass(model, BaseModel):
            yield from (one.alias or name for name, one in model.model_fields.items())
        else:
            yield field.alias
    for below in dependant.dependencies:
        yield from _parameters(below)


def make_unknown_router() -> APIRouter:
    """Answers what no operation under /api does: another method of one, or an address that nothing has."""
    router = APIRouter(include_in_schema=False)

    @router.get("/api")
    @router.api_route(ANY, methods=[*METHODS])
    def refuse_address(request: Request) -> Response:
        methods = _methods(request)
        if not methods:
            return JSONResponse({"detail": "There is no such address."}, 404)
        allow = {"allow": ", ".join((*methods, "OPTIONS"))}
        if request.method == "OPTIONS":
            return Response(status_code=204, headers=allow)
        text = f"{request.method} is not possible here. Possible: {', '.join(methods)}."
        return JSONResponse({"detail": text}, 405, allow)

    return router


def _methods(request: Request) -> list[str]:
    """The methods of all operations at a request's address."""
    return sorted(
        {
            method
            for one in iter_route_contexts([*request.app.routes])
            if str(one.path).startswith("/api/") and one.path != ANY
            if one.path_regex.match(request.scope["path"])
            for method in one.methods or ()
        }
    )
