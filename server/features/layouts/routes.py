"""Layouts of panels: those that are kept, keeping, deleting."""

from collections.abc import Sequence
from typing import Annotated

from fastapi import APIRouter, Path
from pydantic import BaseModel, ConfigDict, StringConstraints

from server.features.layouts.document import LayoutDocument
from server.features.layouts.library import LayoutDetails, Layouts, SavedLayout, UnknownLayoutError
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.models import IDENTIFIER_MAX
from server.platform.store import StoreError

STORING = answers(StoreError)
UNKNOWN = answers(UnknownLayoutError)

router = APIRouter(prefix="/api/layouts", tags=["layouts"])

LayoutIdentifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


class NewLayout(BaseModel):
    """A layout that is to be kept under a name."""

    model_config = ConfigDict(extra="forbid")
    name: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=60)]
    document: LayoutDocument


@router.get(
    "",
    summary="The layouts that are kept",
    operation_id="listLayouts",
    openapi_extra=needs(Need.VIEWER),
    responses=STORING,
)
def list_layouts(layouts: Provided[Layouts]) -> Sequence[SavedLayout]:
    """By name."""
    return layouts.list()


@router.get(
    "/{layout}",
    summary="A layout",
    operation_id="getLayout",
    openapi_extra=needs(Need.VIEWER),
    responses={**UNKNOWN, **STORING},
)
def get_layout(layouts: Provided[Layouts], layout: LayoutIdentifier) -> LayoutDetails:
    """With its document as it was kept, which the page reads."""
    return layouts.get(layout)


@router.post(
    "",
    status_code=201,
    summary="Keep a layout",
    operation_id="saveLayout",
    openapi_extra=needs(Need.OPERATOR),
    responses={**answers(_409="There are too many"), **STORING},
)
async def save_layout(layouts: Provided[Layouts], body: NewLayout) -> SavedLayout:
    """Keep it under its name, over one of that name."""
    return await layouts.save(body.name, body.document)


@router.delete(
    "/{layout}",
    status_code=204,
    summary="Delete a layout",
    operation_id="deleteLayout",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def delete_layout(layouts: Provided[Layouts], layout: LayoutIdentifier) -> None:
    """Delete it for good; pages that show it go on showing it."""
    await layouts.delete(layout)
