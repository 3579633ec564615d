"""The application: routes, guards and the page around one container."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import cache
from pkgutil import resolve_name

from fastapi import Depends, FastAPI
from starlette.routing import BaseRoute

from server import VERSION
from server.container import Container, features_on
from server.feature import Feature
from server.features.lease.admission import admit
from server.http.addresses import make_unknown_router
from server.http.audit import AuditMiddleware
from server.http.description import DescribedApp
from server.http.error_handlers import add_error_handlers
from server.http.head_requests import HeadRequests
from server.http.help_pages import HelpPages, make_help_router
from server.http.operations import EVERYWHERE, Operations
from server.http.page import Page, make_router
from server.http.proxies import RequestsOfAddress
from server.http.security import SecurityMiddleware
from server.http.sign_in.access import cookie_name
from server.http.sign_in.middleware import SignInMiddleware
from server.http.sign_in.tokens import TOKEN_PREFIX, make_token
from server.http.start_problems import StartProblems, explaining_start
from server.http.turns import RequestTurns
from server.platform.settings import Settings
from server.processes.managed_process import ProcessCommand


def create_app(
    settings: Settings,
    commands: Sequence[ProcessCommand] = (),
    started: Callable[[Container], None] | None = None,
) -> FastAPI:
    """The server for one robot; `commands` are the processes that it keeps running (`supervisor.plan`).

    `started` is called once everything is there, before anybody is served.
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
        cookie=cookie_name(settings.port),
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
    # The middleware added last runs first.
    app.add_middleware(RequestTurns)
    app.add_middleware(SignInMiddleware)
    app.add_middleware(
        SecurityMiddleware,
        allowed_hosts=settings.allowed_hosts,
        port=settings.port,
        public_url=settings.public_url,
    )
    if settings.trusted_proxies:
        app.add_middleware(RequestsOfAddress)
    app.add_middleware(HeadRequests)
    app.add_middleware(AuditMiddleware)
    app.add_middleware(StartProblems)
    add_error_handlers(app)
    for feature in features_on(settings):
        for place in feature.routes:
            app.router.routes.extend(_build_routes(place, feature, settings))
    app.include_router(make_unknown_router())
    app.include_router(make_help_router(HelpPages(settings.help_pages)))
    app.include_router(make_router(Page(settings.page)))
    return app


def _build_routes(place: str, feature: Feature, settings: Settings) -> list[BaseRoute]:
    """The routes at this place of a feature's code, each behind admission."""
    found = resolve_name(place)
    if isinstance(found, Operations):
        return _build(found)
    assert feature.section is not None
    return [route for made in found(settings.section(feature.section)) for route in _build(made)]


@cache
def _build(operations: Operations) -> list[BaseRoute]:
    """The same for all servers of a process."""
    checks = [] if operations.admits_itself else [Depends(admit)]
    return operations.build(checks, responses=EVERYWHERE)
