"""Every operation declares its need, and an operation without one is refused."""

import asyncio
from pathlib import Path
from types import SimpleNamespace

import pytest
from fastapi import APIRouter, Depends, FastAPI
from fastapi.routing import iter_route_contexts
from starlette.requests import HTTPConnection

from server.app import create_app
from server.driving.admission import admit
from server.http.sign_in.access import Access
from server.http.sign_in.identity import IDENTITY, SHELL
from server.http.sign_in.middleware import OPEN
from server.http.sign_in.policy import Need, list_needs, needs
from server.platform.errors import ForbiddenError
from server.platform.settings import DataFolder, Settings


def make_app() -> FastAPI:
    return create_app(Settings(data=DataFolder(Path("data")), config=Path("robot.toml"), every_feature=True))


def operations(app: FastAPI) -> dict[str, tuple[str, str]]:
    """Method and path of each operation."""
    return {
        operation["operationId"]: (method.upper(), path)
        for path, methods in app.openapi()["paths"].items()
        for method, operation in methods.items()
    }


def test_every_operation_declares_its_need() -> None:
    app = make_app()
    declared = list_needs(app.routes)
    # The one that refuses what is no command is in no description.
    assert set(declared) == {*operations(app), "refuseCommand"}
    assert [operation for operation, need in declared.items() if need is None] == []


def test_only_operations_without_a_need_are_open() -> None:
    app = make_app()
    there = operations(app)
    assert {there[name] for name, need in list_needs(app.routes).items() if need is Need.NOTHING} == OPEN


def test_an_operation_without_a_need_is_refused_even_to_the_shell() -> None:
    router = APIRouter()
    router.get("/declared", openapi_extra=needs(Need.VIEWER))(lambda: None)
    router.get("/undeclared")(lambda: None)
    app = FastAPI()
    app.include_router(router, dependencies=[Depends(admit)])
    app.state.services = {Access: SimpleNamespace(refresh=lambda identity: identity)}
    routes = {context.path: context for context in iter_route_contexts(app.routes)}

    def ask(path: str) -> None:
        scope = {"type": "http", "app": app, "route": routes[path], IDENTITY: SHELL, "headers": []}
        asyncio.run(admit(HTTPConnection(scope)))

    ask("/declared")
    with pytest.raises(ForbiddenError, match="does not declare"):
        ask("/undeclared")
