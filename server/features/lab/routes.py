"""The robots of a lab: those it pulls sessions from."""

from server.features.lab.pull import SessionPull
from server.features.lab.robots import LabRobots, RobotKnownError, UnknownRobotError
from server.features.lab.schemas import LabRobot, NewLabRobot
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/lab", tags=["lab"])


@router.operation("GET /robots", Need.VIEWER)
def list_lab_robots(pull: Provided[SessionPull]) -> list[LabRobot]:
    """List the robots of the lab by name, and what comes of pulling from them."""
    return pull.listed()


@router.operation("POST /robots", Need.ADMINISTER, RobotKnownError, status_code=204)
async def add_lab_robot(robots: Provided[LabRobots], pull: Provided[SessionPull], body: NewLabRobot) -> None:
    """Add a robot; its sessions are pulled whenever it is disarmed and reachable."""
    await robots.add(body)
    pull.wake()


@router.operation("DELETE /robots/{robot}", Need.ADMINISTER, UnknownRobotError)
async def remove_lab_robot(robots: Provided[LabRobots], robot: Identifier) -> None:
    """Remove a robot; its sessions stay in the archive."""
    await robots.remove(robot)
