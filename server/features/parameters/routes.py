"""Parameters of runtime and firmware: what they are, changing them, who did, and undoing it."""

from typing import Any

from fastapi import APIRouter
from fastapi.concurrency import run_in_threadpool

from robot_runtime.contract.documents import Parameters
from server.features.parameters.changes import Changes
from server.features.parameters.schemas import Change, Restored, Undo
from server.http.dependencies import Provided
from server.http.problems import COMMAND, SILENT, answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs
from server.platform.store import StoreError
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api/parameters", tags=["parameters"])


async def ask_parameters(bridge: Bridge) -> dict[str, Any]:
    """As the runtime knows them now. Raises RuntimeSilentError, RefusedError."""
    answer = await bridge.query("parameters")
    return {name: answer[name] for name in ("time", "parameters")}


@router.get(
    "",
    summary="Everything that may be tuned",
    operation_id="getParameters",
    openapi_extra=needs(Need.VIEWER),
    responses={**answers(_409="The robot is lent to a communication test"), **SILENT},
    response_model=Parameters,
)
async def get_parameters(bridge: Provided[Bridge]) -> object:
    """Each with its type, its range, its unit, its meaning and its value, as it is now."""
    return await ask_parameters(bridge)


@router.get(
    "/changes",
    summary="Who changed what",
    operation_id="listParameterChanges",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(StoreError),
)
async def get_changes(changes: Provided[Changes]) -> list[Change]:
    """The newest hundred, the newest first."""
    return await run_in_threadpool(changes.newest)


@router.post(
    "/undo",
    summary="Undo a change",
    operation_id="undoParameters",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def undo(changes: Provided[Changes], caller: Caller, wanted: Undo) -> Restored:
    """Set back what the newest change has changed; then the one before it is the newest."""
    return await changes.undo(caller.name, wanted.change)
