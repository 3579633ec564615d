"""The application: routes, guards and the page around one container."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import cache
from pkgutil import resolve_name

from fastapi import Depends, FastAPI
from starlette.routing import BaseRoute

from server import VERSION
from server.container import Container, features_on
from server.driving.admission import admit
from server.feature import Feature
from server.http.addresses import make_unknown_router
from server.http.description import DescribedApp
from server.http.error_handlers import add_error_handlers
from server.http.help_pages import HelpPages, make_help_router
from server.http.layers import add_layers
from server.http.operations import EVERYWHERE, Operations
from server.http.page import Page, make_router
from server.http.sign_in.access import cookie_name
from server.http.sign_in.tokens import TOKEN_PREFIX, make_token
from server.http.start_problems import explaining_start
from server.platform.settings import Settings
from server.processes.managed_process import ProcessCommand


def create_app(
    settings: Settings,
    commands: Sequence[ProcessCommand] = (),
    started: Callable[[Container], None] | None = None,
) -> FastAPI:
    """Return the server for one robot; it keeps the processes `commands` running (`supervisor.plan`).

    `started` is called once everything is ready, before any request is served.
    """

    # Made before the fork, so that it stays valid when the server is started again.
    token = make_token(TOKEN_PREFIX)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        with explaining_start(app):
            container = Container(settings, commands, token, app.state.ended)
            app.state.container = container
            app.state.services = container.services
            async with container.run():
                if started is not None:
                    started(container)
                yield

    app = DescribedApp(
        cookie=cookie_name(settings.server.port),
        title="µ-CAT",
        version=VERSION,
        description="The server of µ-CAT, a hand-sized underwater robot turtle. Errors say what happened, "
        "why, and what to do, in `detail`.",
        openapi_url="/api/openapi.json",
        docs_url=None,
        redoc_url=None,
        lifespan=lifespan,
    )
    app.state.ended = ""
    add_layers(app, settings)
    add_error_handlers(app)
    for feature in features_on(settings):
        for location in feature.routes:
            app.router.routes.extend(_build_routes(location, feature, settings))
    app.include_router(make_unknown_router())
    app.include_router(make_help_router(HelpPages(settings.help_pages)))
    app.include_router(make_router(Page(settings.page)))
    return app


def _build_routes(location: str, feature: Feature, settings: Settings) -> list[BaseRoute]:
    """Return the routes at this location of a feature's code, each behind admission."""
    source = resolve_name(location)
    if isinstance(source, Operations):
        return _build(source)
    section = feature.section_class
    assert section is not None
    return [route for made in source(settings.section(section)) for route in _build(made)]


@cache
def _build(operations: Operations) -> list[BaseRoute]:
    """Build an application's routes once for all servers of a process."""
    checks = [] if operations.admits_itself else [Depends(admit)]
    return operations.build(checks, responses=EVERYWHERE)
