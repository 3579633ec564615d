"""The application: routes, guards and the page around one container."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import cache

from fastapi import Depends, FastAPI
from starlette.routing import BaseRoute

from server import VERSION
from server.container import Container
from server.features.backup import routes as backup
from server.features.board import routes as board
from server.features.bring_up import routes as bring_up
from server.features.comm_tests import routes as comm_tests
from server.features.comparison import routes as compare
from server.features.doctor import routes as doctor
from server.features.doors import routes as doors
from server.features.exports import routes as exports
from server.features.identification import routes as identification
from server.features.layouts import routes as layouts
from server.features.lease import routes as control
from server.features.lease.admission import admit
from server.features.live import routes as live
from server.features.missions import routes as missions
from server.features.operate import routes as robot
from server.features.panels import routes as panels
from server.features.parameters import routes as parameters
from server.features.people import audit
from server.features.people import routes as access
from server.features.scenarios import routes as scenarios
from server.features.sessions import routes as sessions
from server.features.simulator import routes as simulator
from server.features.tuning import routes as tuning
from server.features.updates import routes as updates
from server.features.vision import routes as vision
from server.http.addresses import make_unknown_router
from server.http.audit import AuditMiddleware
from server.http.description import DescribedApp
from server.http.error_handlers import add_error_handlers
from server.http.head_requests import HeadRequests
from server.http.help_pages import HelpPages, make_help_router
from server.http.operations import EVERYWHERE
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

ROUTES = (
    *(access, audit, backup, board, bring_up, comm_tests, compare, control, doctor, doors, exports),
    *(identification, layouts, live, missions, panels, parameters, robot, scenarios, sessions),
    *(simulator, tuning, updates, vision),
)


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
    app.router.routes.extend(_build_routes())
    for door in doors.open_routes(settings):
        app.router.routes.extend(door.build())
    app.include_router(make_unknown_router())
    app.include_router(make_help_router(HelpPages(settings.help_pages)))
    app.include_router(make_router(Page(settings.page)))
    return app


@cache
def _build_routes() -> list[BaseRoute]:
    """The routes of every feature, each behind admission; the same for all servers of a process."""
    return [
        route for module in ROUTES for route in module.router.build([Depends(admit)], responses=EVERYWHERE)
    ]
