"""What recordings take of the disk."""

from fastapi import APIRouter

from server.features.sessions.storage import Storage, measure
from server.http.dependencies import Provided
from server.http.sign_in.policy import Need, needs
from server.platform.settings import Settings
from server.platform.store import Store

router = APIRouter(prefix="/api/storage", tags=["sessions"])


@router.get("", summary="Storage used and free", operation_id="getStorage", openapi_extra=needs(Need.VIEWER))
def get_storage(store: Provided[Store], settings: Provided[Settings]) -> Storage:
    """The disk that holds the data folder, and the rules by which sessions go."""
    return measure(store, settings)
