"""Panels of one's own: which there are, their scripts, and the frame in which the page runs them."""

from collections.abc import Sequence
from typing import Annotated

from fastapi import APIRouter, Path
from fastapi.responses import HTMLResponse

from server.features.panels import frame
from server.features.panels.scripts import (
    OwnPanel,
    OwnPanelScript,
    UnknownPanelError,
    list_panels,
    read_panel,
)
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.settings import Settings

router = APIRouter(prefix="/api/panels", tags=["panels"])


@router.get("", summary="One's own panels", operation_id="listPanels", openapi_extra=needs(Need.VIEWER))
def get_panels(settings: Provided[Settings]) -> Sequence[OwnPanel]:
    """Those in the folder `panels` of the data folder, by name."""
    return list_panels(settings.data.panels)


@router.get(
    "/frame",
    summary="Where one's own panels run",
    operation_id="getPanelFrame",
    openapi_extra=needs(Need.VIEWER),
    response_class=HTMLResponse,
)
def get_frame() -> HTMLResponse:
    """A page with an origin of its own, which hears samples and can ask nobody for anything."""
    return frame.respond()


@router.get(
    "/own/{panel}",
    summary="A panel's script",
    operation_id="getPanel",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(UnknownPanelError),
)
def get_panel(settings: Provided[Settings], panel: Annotated[str, Path(max_length=60)]) -> OwnPanelScript:
    """As text, which the page hands to a frame."""
    return read_panel(settings.data.panels, panel)
