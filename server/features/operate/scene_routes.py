"""The simulated scene: from where the bystander looks at the robot."""

from typing import Annotated, Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.stream.bridge import Bridge

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
    openapi_extra=needs(Need.OPERATOR),
    responses=answers(
        _409="The scene refuses",
        _422="The request is not valid",
        _503="The scene is not running",
        _504="The scene did not answer within 2 s",
    ),
)
async def put_view(bridge: Provided[Bridge], view: View) -> None:
    """Where the pictures of topic `observer` are taken from."""
    await bridge.scene("view", view.model_dump())
