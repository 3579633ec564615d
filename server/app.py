"""The application: routes, guard and page around one assembly."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager

from fastapi import Depends, FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse

from robot_runtime.errors import RefusedError
from server import VERSION
from server.container import Assembly
from server.features.backup import routes as backup
from server.features.backup.download import DatabaseCopyError
from server.features.comm_tests import routes as comm_tests
from server.features.comparison import routes as compare
from server.features.comparison.schemas import NoSessionError
from server.features.exports import routes as exports
from server.features.layouts import routes as layouts
from server.features.layouts.library import UnknownLayoutError
from server.features.lease import routes as control
from server.features.lease.admission import admit
from server.features.lease.lease import NotInControlError
from server.features.live import routes as live
from server.features.operate import link_routes as link
from server.features.operate import routes as robot
from server.features.operate import scene_routes as scene
from server.features.panels import routes as panels
from server.features.panels.scripts import UnknownPanelError
from server.features.parameters import profile_routes as profiles
from server.features.parameters import routes as parameters
from server.features.parameters.profiles import UnknownProfileError
from server.features.people import routes as access
from server.features.scenarios import routes as scenarios
from server.features.sessions import bookmark_routes as marks
from server.features.sessions import replay_routes as replay
from server.features.sessions import routes as sessions
from server.features.sessions import storage_routes as storage
from server.features.sessions.bookmarks import UnknownBookmarkError
from server.features.sessions.presence import SessionStateError, UnknownSessionError
from server.features.sessions.recorder import RecordingRefusedError
from server.features.sessions.recording import RecordingError
from server.features.simulator import routes as simulator
from server.features.tuning import routes as tuning
from server.features.tuning.runs import UnknownTuningRunError
from server.features.vision import routes as vision
from server.health import routes as health
from server.http.help_pages import HelpPages, make_help_router
from server.http.page import Page, make_router
from server.http.problems import EVERYWHERE
from server.http.security import Guard
from server.http.sign_in.access import Access
from server.http.sign_in.devices import UnknownDeviceError
from server.http.sign_in.gate import Gate
from server.http.sign_in.tokens import TOKEN_PREFIX, make_token
from server.platform.settings import Settings
from server.platform.store import StoreError
from server.processes.supervisor import Command
from server.stream.bridge import RuntimeSilentError


def create_app(
    settings: Settings, commands: Sequence[Command] = (), started: Callable[[Access], None] | None = None
) -> FastAPI:
    """The server for one robot; `commands` are the processes that it keeps running (see `parts.plan`).

    `started` is called once everything is there, before anybody is served.
    """

    # Made before the fork, so that it stays valid when the server is started again.
    token = make_token(TOKEN_PREFIX)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        assembly = Assembly(settings, commands, token, app.state.ended)
        app.state.assembly = assembly
        app.state.services = assembly.services
        async with assembly.run():
            if started is not None:
                started(assembly.access)
            yield

    app = FastAPI(
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
    # What is added last is asked first.
    app.add_middleware(Gate)
    app.add_middleware(Guard, allowed_hosts=settings.allowed_hosts, port=settings.port)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(400, _unreadable_body)
    app.add_exception_handler(RefusedError, _refused)
    app.add_exception_handler(RecordingRefusedError, _refused)
    app.add_exception_handler(SessionStateError, _refused)
    app.add_exception_handler(NotInControlError, _not_in_control)
    app.add_exception_handler(UnknownSessionError, _absent)
    app.add_exception_handler(UnknownBookmarkError, _absent)
    app.add_exception_handler(UnknownDeviceError, _absent)
    app.add_exception_handler(UnknownLayoutError, _absent)
    app.add_exception_handler(UnknownPanelError, _absent)
    app.add_exception_handler(UnknownProfileError, _absent)
    app.add_exception_handler(UnknownTuningRunError, _absent)
    app.add_exception_handler(RuntimeSilentError, _silent)
    app.add_exception_handler(StoreError, _not_stored)
    app.add_exception_handler(DatabaseCopyError, _no_room)
    app.add_exception_handler(NoSessionError, _absent)
    app.add_exception_handler(RecordingError, _unreadable)
    robots = (health, robot, vision, simulator, scene, link, live, control, parameters, profiles)
    kept = (sessions, marks, replay, storage, backup, compare, exports)
    for module in (access, *robots, *kept, comm_tests, scenarios, layouts, panels, tuning):
        app.include_router(module.router, dependencies=[Depends(admit)], responses=EVERYWHERE)
    app.include_router(make_help_router(HelpPages(settings.help_pages)))
    app.include_router(make_router(Page(settings.page)))
    return app


async def _invalid(_: Request, problem: Exception) -> JSONResponse:
    assert isinstance(problem, RequestValidationError)
    words = "; ".join(
        f"{'.'.join(str(place) for place in error['loc'])}: {error['msg']}" for error in problem.errors()[:5]
    )
    return _tell(422, f"The request is not valid. {words}")


async def _unreadable_body(_: Request, __: Exception) -> JSONResponse:
    return _tell(422, "The request is not valid. Its body is not JSON in UTF-8.")


async def _refused(_: Request, problem: Exception) -> JSONResponse:
    return _tell(409, str(problem))


async def _not_in_control(_: Request, problem: Exception) -> JSONResponse:
    return _tell(423, str(problem))


async def _no_room(_: Request, problem: Exception) -> JSONResponse:
    return _tell(507, str(problem))


async def _absent(_: Request, problem: Exception) -> JSONResponse:
    return _tell(404, str(problem))


async def _silent(_: Request, problem: Exception) -> JSONResponse:
    assert isinstance(problem, RuntimeSilentError)
    return _tell(504 if problem.waited else 503, str(problem))


async def _not_stored(_: Request, problem: Exception) -> JSONResponse:
    return _tell(503, f"The database does not work: {problem}.")


async def _unreadable(_: Request, problem: Exception) -> JSONResponse:
    return _tell(500, f"This recording cannot be read whole: {problem}. Other sessions are not affected.")


def _tell(status: int, detail: str) -> JSONResponse:
    return JSONResponse({"detail": detail}, status)
