"""The simulator of a robot with its hardware in the loop: on this computer, or left to another one."""

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict

from robot_runtime.errors import RefusedError
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.settings import Settings
from server.processes.supervisor import SIMULATION, SIMULATION_ELSEWHERE, Parts

router = APIRouter(prefix="/api/simulator", tags=["robot"])


class Place(BaseModel):
    """Whether the simulator runs on this computer."""

    model_config = ConfigDict(extra="forbid")
    here: bool


@router.put(
    "",
    status_code=204,
    summary="Start or end the simulator on this computer",
    operation_id="putSimulator",
    openapi_extra=needs(Need.CONTROL),
    responses=answers(_409="The robot is not in the loop", _423="Control is with somebody else"),
)
async def put_simulator(settings: Provided[Settings], parts: Provided[Parts], wanted: Place) -> None:
    """Only with hardware in the loop; ending it stops an armed robot, for then nobody tells its depth."""
    if not settings.in_the_loop:
        raise RefusedError(
            "Only a robot with its hardware in the loop can do with or without this computer's simulator; "
            f"robot.mode is {settings.mode}."
        )
    for name in SIMULATION:
        if wanted.here:
            parts.resume(name)
        else:
            await parts.pause(name, SIMULATION_ELSEWHERE)
