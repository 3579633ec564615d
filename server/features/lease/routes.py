"""Operations on the control of the robot."""

from server.driving import schemas
from server.driving.admission import OwnClient
from server.driving.arbiter import ControlArbiter
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/control", tags=["control"])


@router.operation("GET", Need.VIEWER)
async def get_control(arbiter: Provided[ControlArbiter]) -> schemas.ControlDetails:
    """Return the client in control, and the counts of stick commands."""
    return schemas.ControlDetails(**arbiter.state().model_dump(), driven=arbiter.driving.counts)


@router.operation("POST /take", Need.OPERATOR, {409: "No open page is named, or another client has control"})
async def take_control(
    arbiter: Provided[ControlArbiter], client: OwnClient, over: bool = False
) -> schemas.ControlState:
    """Take control.

    Take free control, or with `over` take it over from another client, whose stick commands no longer
    count. A page has control until it releases it or its live socket closes. The programs of one token share
    it, until none of them has made a request that needs control for 10 s.
    """
    arbiter.take(client, over=over)
    return arbiter.state()


@router.operation("POST /release", Need.OPERATOR, {409: "No open page is named"})
async def release_control(arbiter: Provided[ControlArbiter], client: OwnClient) -> schemas.ControlState:
    """Release control.

    Nobody has control afterwards. Nothing changes if this client did not have it.
    """
    arbiter.release(client)
    return arbiter.state()
