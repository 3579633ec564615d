"""Operations on layouts of panels."""

from collections.abc import Sequence
from typing import Annotated

from pydantic import StringConstraints

from server.features.layouts.document import LayoutDocument
from server.features.layouts.library import LayoutDetails, Layouts, SavedLayout, UnknownLayoutError
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.request_body import RequestBody
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/layouts", tags=["layouts"])


class NewLayout(RequestBody):
    """A layout to be saved under a name."""

    name: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=60)]
    document: LayoutDocument


@router.operation("GET", Need.VIEWER)
def list_layouts(layouts: Provided[Layouts]) -> Sequence[SavedLayout]:
    """List the saved layouts, by name."""
    return layouts.list()


@router.operation("GET /{layout}", Need.VIEWER, UnknownLayoutError)
def get_layout(layouts: Provided[Layouts], layout: Identifier) -> LayoutDetails:
    """Return a layout with its document."""
    return layouts.get(layout)


@router.operation("POST", Need.OPERATOR, {409: "There are too many"}, status_code=201)
async def save_layout(layouts: Provided[Layouts], body: NewLayout) -> SavedLayout:
    """Save a layout.

    A layout of the same name is replaced.
    """
    return await layouts.save(body.name, body.document)


@router.operation("DELETE /{layout}", Need.OPERATOR, UnknownLayoutError)
async def delete_layout(layouts: Provided[Layouts], layout: Identifier) -> None:
    """Delete a layout.

    Pages that show it go on showing it.
    """
    await layouts.delete(layout)
