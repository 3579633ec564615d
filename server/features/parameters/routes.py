"""Parameters of runtime and firmware: what they are, changing them, who did, and undoing it."""

from typing import Any

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool

from robot_runtime.contract.documents import Parameters
from server.container import Assembly
from server.features.operate.routes import COMMAND, SILENT
from server.features.parameters.schemas import Change, NewValues, Restored, Undo
from server.http.problems import answers
from server.http.sign_in.identity import Identity

router = APIRouter(prefix="/api/parameters", tags=["parameters"])


async def ask_parameters(request: Request) -> dict[str, Any]:
    """As the runtime knows them now. Raises RuntimeSilent, Refused."""
    answer = await Assembly.of(request).bridge.query("parameters")
    return {name: answer[name] for name in ("time", "parameters")}


@router.get(
    "",
    summary="Everything that may be tuned",
    operation_id="getParameters",
    responses={**answers(_409="The robot is lent to a communication test"), **SILENT},
    response_model=Parameters,
)
async def get_parameters(request: Request) -> object:
    """Each with its type, its range, its unit, its meaning and its value, as it is now."""
    return await ask_parameters(request)


@router.patch("", summary="Change parameters", operation_id="changeParameters", responses=COMMAND)
async def change_parameters(request: Request, wanted: NewValues) -> Restored:
    """All or none, between two control ticks; what has the value already is not changed."""
    changes = Assembly.of(request).changes
    return await changes.command(Identity.of(request).name, "parameters", wanted.model_dump())


@router.get(
    "/changes",
    summary="Who changed what",
    operation_id="listParameterChanges",
    responses=answers(_503="The database does not work"),
)
async def get_changes(request: Request) -> list[Change]:
    """The newest hundred, the newest first."""
    return await run_in_threadpool(Assembly.of(request).changes.newest)


@router.post("/undo", summary="Undo a change", operation_id="undoParameters", responses=COMMAND)
async def undo(request: Request, wanted: Undo) -> Restored:
    """Set back what the newest change has changed; then the one before it is the newest."""
    return await Assembly.of(request).changes.undo(Identity.of(request).name, wanted.change)
