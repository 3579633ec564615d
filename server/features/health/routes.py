"""The health of the server and of every part of its robot."""

from server.health.monitor import Health, HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.platform.errors import UnavailableError

router = Operations(prefix="/api", tags=["health"])


class NotAliveError(UnavailableError):
    """The database or the robot's runtime fails"""


@router.operation("GET /health", Need.VIEWER)
async def get_health(monitor: Provided[HealthMonitor]) -> Health:
    """Return the health of the server and of every part of the robot.

    Answered with 200 while the server runs; `status` sums the parts up. A lab has no robot, and its parts
    are server and database.
    """
    return monitor.health()


@router.operation("GET /alive", Need.NOTHING, NotAliveError)
async def check_alive(monitor: Provided[HealthMonitor]) -> None:
    """Check that the robot works.

    Without a sign-in and without data, for programs that watch computers: 204, or 503 where the database or
    the robot's runtime fails.
    """
    if not monitor.alive:
        raise NotAliveError("The database or the robot's runtime fails. /api/health says which, and why.")
