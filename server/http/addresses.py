"""Refusals with a reason of addresses, methods and query parameters that the interface does not have."""

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
    """Refuse a query parameter that the operation does not declare. Raise UnknownParameterError."""
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
    """Return a question with the known name that is nearest to an unknown one; empty where none is near."""
    matches = get_close_matches(name[:SHOWN_MAX], known, 1)
    return f"Did you mean '{matches[0]}'? " if matches else ""


def shown(name: str) -> str:
    """Return an unknown name in the form for an answer, shortened."""
    return repr(name[:SHOWN_MAX])


def _parameters(dependant: Dependant) -> Iterator[str]:
    """Yield the names of query parameters; those of a model are its fields."""
    for field in dependant.query_params:
        model = field.field_info.annotation
        if isinstance(model, type) and issubclass(model, BaseModel):
            yield from (field.alias or name for name, field in model.model_fields.items())
        else:
            yield field.alias
    for below in dependant.dependencies:
        yield from _parameters(below)


def make_unknown_router() -> APIRouter:
    """Answer requests without an operation under /api: another method, or an unknown address."""
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
    """Return the methods of all operations at a request's address."""
    return sorted(
        {
            method
            for context in iter_route_contexts([*request.app.routes])
            if str(context.path).startswith("/api/") and context.path != ANY
            if context.path_regex.match(request.scope["path"])
            for method in context.methods or ()
        }
    )
