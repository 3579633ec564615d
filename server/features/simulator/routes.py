"""The simulator of a robot with its hardware in the loop: on this computer, or left to another one."""

from typing import Annotated, Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from robot_runtime.errors import RefusedError
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.settings import Settings
from server.processes.supervisor import SIMULATION, SIMULATION_ELSEWHERE, ProcessSupervisor
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api")


class Place(BaseModel):
    """Place of the simulator; `here` is true for this computer."""

    model_config = ConfigDict(extra="forbid")
    here: bool


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
    "/simulator",
    status_code=204,
    summary="Start or end the simulator on this computer",
    operation_id="putSimulator",
    tags=["robot"],
    openapi_extra=needs(Need.CONTROL),
    responses=answers(_409="The robot is not in the loop", _423="Control is with somebody else"),
)
async def put_simulator(
    settings: Provided[Settings], processes: Provided[ProcessSupervisor], body: Place
) -> None:
    """Only with hardware in the loop; ending it stops an armed robot, for then nobody tells its depth."""
    if not settings.in_the_loop:
        raise RefusedError(
            "Only a robot with its hardware in the loop can do with or without this computer's simulator; "
            f"robot.mode is {settings.mode}."
        )
    for name in SIMULATION:
        if body.here:
            processes.resume(name)
        else:
            await processes.pause(name, SIMULATION_ELSEWHERE)


@router.put(
    "/scene/view",
    status_code=204,
    summary="Choose the bystander's view",
    operation_id="putView",
    tags=["scene"],
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
