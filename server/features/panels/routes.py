"""Operations on your own panels: the list, their scripts, and the frame that runs them."""

from collections.abc import Sequence
from typing import Annotated

from fastapi import Path
from fastapi.responses import HTMLResponse

from server.features.panels import frame, scripts
from server.features.panels.scripts import OwnPanel, OwnPanelScript, UnknownPanelError
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.platform.settings import Settings

router = Operations(prefix="/api/panels", tags=["panels"])


@router.operation("GET", Need.VIEWER)
def list_panels(settings: Provided[Settings]) -> Sequence[OwnPanel]:
    """List your own panels, by name; at most 200.

    The scripts in the folder `panels` of the data folder.
    """
    return scripts.list_panels(settings.data.panels)


@router.operation("GET /frame", Need.VIEWER, response_class=HTMLResponse, linked=True)
def get_panel_frame() -> HTMLResponse:
    """Return the frame that runs your own panels.

    A page with an origin of its own: it receives samples and can send no request.
    """
    return HTMLResponse(frame.FRAME, headers=frame.HEADERS)


@router.operation("GET /own/{panel}", Need.VIEWER, UnknownPanelError)
def get_panel(settings: Provided[Settings], panel: Annotated[str, Path(max_length=60)]) -> OwnPanelScript:
    """Return the script of a panel, as text."""
    return scripts.read_panel(settings.data.panels, panel)
