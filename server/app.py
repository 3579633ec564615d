"""The application: routes, guard and page around one assembly."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager

from fastapi import Depends, FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse

from robot_runtime.errors import Refused
from server import VERSION
from server.access.access import Access
from server.access.admit import admit
from server.access.devices import UnknownDevice
from server.access.gate import Gate
from server.access.secret import TOKEN_PREFIX, make_token
from server.assembly import Assembly
from server.comparison.shapes import NoSessionError
from server.control.lease import NotInControl
from server.download import CopyFailed
from server.layouts.library import UnknownLayout
from server.live.bridge import RuntimeSilent
from server.page import Page, make_router
from server.panels.own import UnknownPanel
from server.parameters.profiles import UnknownProfile
from server.processes.parts import Command
from server.routes import (
    access,
    backup,
    comm_tests,
    compare,
    control,
    exports,
    health,
    layouts,
    link,
    live,
    marks,
    panels,
    parameters,
    past,
    profiles,
    replay,
    robot,
    scenarios,
    scene,
    sessions,
    simulator,
    storage,
    tuning,
    vision,
)
from server.routes.problems import EVERYWHERE
from server.security import Guard
from server.sessions.markers import UnknownMark
from server.sessions.presence import NotNow, UnknownSession
from server.sessions.recorder import RecordingRefused
from server.sessions.recording import RecordingError
from server.settings import Settings
from server.store import StoreError
from server.tuning.runs import UnknownRun


def create_app(
    settings: Settings, commands: Sequence[Command] = (), started: Callable[[Access], None] | None = None
) -> FastAPI:
    """The server for one robot; `commands` are the processes that it keeps running (see `parts.plan`).

    `started` is called once everything is there, before anybody is served.
    """

    # One for all servers that a keeper starts one after the other: who asks meanwhile is known to the next.
    token = make_token(TOKEN_PREFIX)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        assembly = Assembly(settings, commands, token, app.state.ended)
        app.state.assembly = assembly
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
    app.add_exception_handler(Refused, _refused)
    app.add_exception_handler(RecordingRefused, _refused)
    app.add_exception_handler(NotNow, _refused)
    app.add_exception_handler(NotInControl, _not_in_control)
    app.add_exception_handler(UnknownSession, _absent)
    app.add_exception_handler(UnknownMark, _absent)
    app.add_exception_handler(UnknownDevice, _absent)
    app.add_exception_handler(UnknownLayout, _absent)
    app.add_exception_handler(UnknownPanel, _absent)
    app.add_exception_handler(UnknownProfile, _absent)
    app.add_exception_handler(UnknownRun, _absent)
    app.add_exception_handler(RuntimeSilent, _silent)
    app.add_exception_handler(StoreError, _not_stored)
    app.add_exception_handler(CopyFailed, _no_room)
    app.add_exception_handler(NoSessionError, _absent)
    app.add_exception_handler(RecordingError, _unreadable)
    robots = (health, robot, vision, simulator, scene, link, live, past, control, parameters, profiles)
    kept = (sessions, marks, replay, storage, backup, compare, exports)
    for module in (access, *robots, *kept, comm_tests, scenarios, layouts, panels, tuning):
        app.include_router(module.router, dependencies=[Depends(admit)], responses=EVERYWHERE)
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
    assert isinstance(problem, RuntimeSilent)
    return _tell(504 if problem.waited else 503, str(problem))


async def _not_stored(_: Request, problem: Exception) -> JSONResponse:
    return _tell(503, f"The database does not work: {problem}.")


async def _unreadable(_: Request, problem: Exception) -> JSONResponse:
    return _tell(500, f"This recording cannot be read whole: {problem}. Other sessions are not affected.")


def _tell(status: int, detail: str) -> JSONResponse:
    return JSONResponse({"detail": detail}, status)
