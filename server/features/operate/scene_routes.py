"""The simulated scene: from where the bystander looks at the robot."""

from typing import Annotated, Literal

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from server.container import Assembly
from server.http.problems import answers

router = APIRouter(prefix="/api/scene", tags=["scene"])


class View(BaseModel):
    """The bystander's view; all pages share it."""

    model_config = ConfigDict(extra="forbid")
    name: Annotated[
        Literal["follow", "side", "top"], Field(description="follow turns with the robot, the others do not")
    ]
    azimuth: Annotated[
        FiniteFloat, Field(ge=-360, le=360, description="° of the line of sight, from heading or north")
    ]
    elevation: Annotated[FiniteFloat, Field(ge=-60, le=89, description="° above the robot")]
    distance: Annotated[FiniteFloat, Field(ge=0.4, le=15, description="m")]


@router.put(
    "/view",
    status_code=204,
    summary="Choose the bystander's view",
    operation_id="putView",
    responses=answers(
        _409="The scene refuses",
        _422="The request is not valid",
        _503="The scene is not running",
        _504="The scene did not answer within 2 s",
    ),
)
async def put_view(request: Request, view: View) -> None:
    """Where the pictures of topic `observer` are taken from."""
    await Assembly.of(request).bridge.scene("view", view.model_dump())
