"""Operations on the simulator: its computer, and the bystander's view."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from robot_runtime.errors import RefusedError
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.request_body import RequestBody
from server.http.sign_in.policy import Need
from server.platform.settings import Settings
from server.processes.supervisor import SIMULATION, SIMULATION_ELSEWHERE, ProcessSupervisor
from server.stream.bridge import Bridge, RuntimeSilentError

router = Operations(prefix="/api")


class SimulatorPlace(RequestBody):
    """The computer of the simulator; `here`: this one."""

    here: bool


class SceneView(RequestBody):
    """The bystander's view; all pages share it."""

    name: Annotated[
        Literal["follow", "side", "top"], Field(description="follow turns with the robot, the others do not")
    ]
    azimuth: Annotated[
        FiniteFloat, Field(ge=-360, le=360, description="° of the line of sight, from heading or north")
    ]
    elevation: Annotated[FiniteFloat, Field(ge=-60, le=89, description="° above the robot")]
    distance: Annotated[FiniteFloat, Field(ge=0.4, le=15, description="m")]


@router.operation("PUT /simulator", Need.CONTROL, {409: "The robot is not in the loop"}, tags=["robot"])
async def put_simulator(
    settings: Provided[Settings], processes: Provided[ProcessSupervisor], body: SimulatorPlace
) -> None:
    """Start or end the simulator on this computer.

    Only with hardware in the loop. Ending the simulator disarms the robot, which then has no depth.
    """
    if not settings.in_the_loop:
        raise RefusedError(
            "The simulator can be moved only with hardware in the loop: set robot.mode to hil in robot.toml "
            f"(it is {settings.robot.mode})."
        )
    for name in SIMULATION:
        if body.here:
            processes.resume(name)
        else:
            await processes.pause(name, SIMULATION_ELSEWHERE)


@router.operation("PUT /scene/view", Need.OPERATOR, RuntimeSilentError, tags=["scene"])
async def put_view(bridge: Provided[Bridge], view: SceneView) -> None:
    """Choose the bystander's view.

    The pictures of the topic `observer` are taken from there.
    """
    await bridge.scene("view", view.model_dump())
