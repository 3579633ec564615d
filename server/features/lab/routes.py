"""The pull of a lab from its robots."""

from server.features.lab.pull import SessionPull
from server.features.lab.schemas import RobotPull
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/lab", tags=["lab"])


@router.operation("GET /pulls", Need.VIEWER)
async def list_pulls(pull: Provided[SessionPull]) -> list[RobotPull]:
    """List, by the name of each robot that has joined, what comes of pulling its sessions."""
    return pull.listed()
