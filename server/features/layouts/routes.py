"""Layouts of panels: those that are kept, keeping, deleting."""

from collections.abc import Sequence
from typing import Annotated

from fastapi import APIRouter, Path, Request
from pydantic import BaseModel, ConfigDict, StringConstraints

from server.container import Assembly
from server.features.layouts.document import LayoutDocument
from server.features.layouts.library import KeptLayout, WholeLayout
from server.features.sessions.routes import STORING
from server.http.problems import answers
from server.platform.models import IDENTIFIER_MAX

UNKNOWN = answers(_404="There is no such layout")

router = APIRouter(prefix="/api/layouts", tags=["layouts"])

LayoutIdentifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


class NewLayout(BaseModel):
    """A layout that is to be kept under a name."""

    model_config = ConfigDict(extra="forbid")
    name: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=60)]
    document: LayoutDocument


@router.get("", summary="The layouts that are kept", operation_id="listLayouts", responses=STORING)
def list_layouts(request: Request) -> Sequence[KeptLayout]:
    """By name."""
    return Assembly.of(request).layouts.list()


@router.get("/{layout}", summary="A layout", operation_id="getLayout", responses={**UNKNOWN, **STORING})
def get_layout(request: Request, layout: LayoutIdentifier) -> WholeLayout:
    """With its document as it was kept, which the page reads."""
    return Assembly.of(request).layouts.get(layout)


@router.post(
    "",
    status_code=201,
    summary="Keep a layout",
    operation_id="saveLayout",
    responses={**answers(_409="There are too many"), **STORING},
)
async def save_layout(request: Request, wanted: NewLayout) -> KeptLayout:
    """Keep it under its name, over one of that name."""
    return await Assembly.of(request).layouts.save(wanted.name, wanted.document)


@router.delete(
    "/{layout}",
    status_code=204,
    summary="Delete a layout",
    operation_id="deleteLayout",
    responses={**UNKNOWN, **STORING},
)
async def delete_layout(request: Request, layout: LayoutIdentifier) -> None:
    """Delete it for good; pages that show it go on showing it."""
    await Assembly.of(request).layouts.delete(layout)
