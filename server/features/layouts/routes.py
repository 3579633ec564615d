"""Operations on layouts of panels."""

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field, StringConstraints

from server.features.layouts.document import LayoutDocument
from server.features.layouts.library import LayoutDetails, Layouts, SavedLayout, UnknownLayoutError
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.request_body import RequestBody
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.limits import IDENTIFIER_MAX

router = Operations(prefix="/api/layouts", tags=["layouts"])


class NewLayout(RequestBody):
    """A layout to be saved under a name."""

    name: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=60)]
    document: LayoutDocument
    base: Annotated[int, Field(ge=0, le=IDENTIFIER_MAX)] | None = Field(
        default=None,
        description="the version that it replaces, 0 for a new layout: refused if somebody has saved another "
        "since. null replaces any",
    )


@router.operation("GET", Need.VIEWER)
def list_layouts(layouts: Provided[Layouts]) -> Sequence[SavedLayout]:
    """List the saved layouts, by name."""
    return layouts.list()


@router.operation("GET /{layout}", Need.VIEWER, UnknownLayoutError)
def get_layout(layouts: Provided[Layouts], layout: Identifier) -> LayoutDetails:
    """Return a layout with its document."""
    return layouts.get(layout)


@router.operation(
    "POST", Need.OPERATOR, {409: "There are too many, or it was changed meanwhile"}, status_code=201
)
async def save_layout(layouts: Provided[Layouts], caller: Caller, body: NewLayout) -> SavedLayout:
    """Save a layout.

    A layout of the same name is replaced.
    """
    return await layouts.save(body.name, body.document, caller.name, body.base)


@router.operation("DELETE /{layout}", Need.OPERATOR, UnknownLayoutError)
async def delete_layout(layouts: Provided[Layouts], layout: Identifier) -> None:
    """Delete a layout.

    Pages that show it go on showing it.
    """
    await layouts.delete(layout)
