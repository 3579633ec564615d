"""What recordings take of the disk."""

from fastapi import APIRouter, Request

from server.container import Assembly
from server.features.sessions.storage import Storage, measure

router = APIRouter(prefix="/api/storage", tags=["sessions"])


@router.get("", summary="Storage used and free", operation_id="getStorage")
def get_storage(request: Request) -> Storage:
    """The disk that holds the data folder, and the rules by which sessions go."""
    assembly = Assembly.of(request)
    return measure(assembly.store, assembly.settings)
