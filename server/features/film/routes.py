"""The choice of a film for the sessions to come."""

from server.features.film.choice import FilmChoice
from server.features.film.config import FilmConfig
from server.features.film.schemas import FilmOrder, FilmPlan, PictureBytes
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.library.storage import free_for_recordings
from server.platform.settings import Settings
from server.platform.store import Store

router = Operations(prefix="/api", tags=["sessions"])


@router.operation("GET /film", Need.VIEWER)
def get_film_plan(
    choice: Provided[FilmChoice], store: Provided[Store], settings: Provided[Settings]
) -> FilmPlan:
    """Return the choice of a film that is in force, and the space that films need."""
    now = choice.now
    return FilmPlan(
        record=now.record,
        rate=min(now.rate, choice.rate_max),
        quality=now.quality,
        rate_max=choice.rate_max,
        coding=choice.coding,
        refusal=choice.refusal,
        picture_bytes=PictureBytes(**choice.picture_bytes),
        measured=choice.is_measured,
        room=max(0, free_for_recordings(store, settings)),
    )


@router.operation("PUT /film", Need.OPERATOR, status_code=204)
async def choose_film(choice: Provided[FilmChoice], body: FilmOrder) -> None:
    """Choose whether and how sessions are filmed: the one that records at once, and those to come."""
    await choice.change(FilmConfig(record=body.record, rate=body.rate, quality=body.quality))
