"""The control of the robot: who has it, taking it, releasing it."""

from fastapi import APIRouter

from server.features.lease import schemas
from server.features.lease.admission import OwnClient
from server.features.lease.arbiter import ControlArbiter
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs

router = APIRouter(prefix="/api/control", tags=["control"])


@router.get("", summary="Who has control", operation_id="getControl", openapi_extra=needs(Need.VIEWER))
async def get_control(arbiter: Provided[ControlArbiter]) -> schemas.ControlDetails:
    """The client in control, and the counts of stick commands."""
    return schemas.ControlDetails(**arbiter.state().model_dump(), driven=arbiter.driving.counts)


@router.post(
    "/take",
    summary="Take control",
    operation_id="takeControl",
    openapi_extra=needs(Need.OPERATOR),
    responses=answers(_409="The request names no open page; somebody else has control"),
)
async def take(
    arbiter: Provided[ControlArbiter], client: OwnClient, over: bool = False
) -> schemas.ControlState:
    """Take free control, or with `over` take it over from another client: its stick commands no longer count.

    A page has control until it releases it or its live socket closes. The programs of one token share it,
    until none of them has made a request that needs control for 10 s.
    """
    arbiter.take(client, over=over)
    return arbiter.state()


@router.post(
    "/release",
    summary="Release control",
    operation_id="releaseControl",
    openapi_extra=needs(Need.OPERATOR),
    responses=answers(_409="The request names no open page"),
)
async def release(arbiter: Provided[ControlArbiter], client: OwnClient) -> schemas.ControlState:
    """Nobody has it then. Nothing changes if this client did not have it."""
    arbiter.release(client)
    return arbiter.state()
