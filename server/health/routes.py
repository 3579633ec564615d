"""Route of the robot's health."""

from fastapi import APIRouter

from server.health.monitor import Health, HealthMonitor
from server.http.dependencies import Provided
from server.http.sign_in.policy import Need, needs

router = APIRouter(prefix="/api", tags=["health"])


@router.get(
    "/health",
    summary="How the server and every part of the robot do",
    operation_id="getHealth",
    openapi_extra=needs(Need.VIEWER),
)
async def get_health(watch: Provided[HealthMonitor]) -> Health:
    """Always answered with 200 while the server runs; `status` says how things are."""
    return watch.health()
