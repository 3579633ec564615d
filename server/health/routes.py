"""How everything does."""

from fastapi import APIRouter, Request

from server.container import Assembly
from server.health.monitor import Health

router = APIRouter(prefix="/api", tags=["health"])


@router.get("/health", summary="How the server and every part of the robot do", operation_id="getHealth")
async def get_health(request: Request) -> Health:
    """Always answered with 200 while the server runs; `status` says how things are."""
    return Assembly.of(request).watch.health()
