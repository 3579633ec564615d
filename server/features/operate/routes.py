"""The robot: its state, and commands to it. The runtime checks every command again, and may refuse it."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, HTTPException, Request
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from robot_runtime.contract.documents import State, Steering
from server.container import Assembly
from server.http.problems import answers
from server.http.sign_in.identity import Identity
from server.platform.disk_space import check_room

SILENT = answers(_503="The runtime is not running", _504="The runtime did not answer within 2 s")
COMMAND = {
    **answers(
        _409="The runtime refuses", _422="The request is not valid", _423="Control is with somebody else"
    ),
    **SILENT,
}

router = APIRouter(prefix="/api/robot", tags=["robot"])

Name = Annotated[str, Field(min_length=1, max_length=64)]
Metres = Annotated[FiniteFloat, Field(ge=0, le=10)]


class Controller(BaseModel):
    """A controller, and the gains that are to change."""

    model_config = ConfigDict(extra="forbid")
    name: Name
    gains: Annotated[dict[Name, FiniteFloat], Field(max_length=32)] = {}


class LoopChange(BaseModel):
    """What is to change about a loop; what is left out stays as it is."""

    model_config = ConfigDict(extra="forbid")
    on: Annotated[bool | None, Field(description="steer it; in manual: hold it")] = None
    set_point: Annotated[FiniteFloat | None, Field(description="m, of the angles rad")] = None
    controller: Name | None = None
    gains: Annotated[
        dict[Name, FiniteFloat], Field(max_length=32, description="of this or the chosen controller")
    ] = {}


class SetPoints(BaseModel):
    """Wanted depths, m; what is left out stays as it is."""

    model_config = ConfigDict(extra="forbid")
    default: Metres | None = None
    detected: Annotated[Metres | None, Field(description="while the wanted colour is seen")] = None


class Driver(BaseModel):
    """Who steers: the depth controller, or the pilot by hand."""

    model_config = ConfigDict(extra="forbid")
    mode: Literal["automatic", "manual"]


class Course(BaseModel):
    """Where it swims while it holds its depth."""

    model_config = ConfigDict(extra="forbid")
    by: Annotated[Steering, Field(description="none: nowhere; beacons: to the light that its detectors see")]


class Card(BaseModel):
    """The card before the simulated camera; null takes it away."""

    model_config = ConfigDict(extra="forbid")
    colour: Name | None


class Vision(BaseModel):
    """What the vision node does; what is left out stays as it is."""

    model_config = ConfigDict(extra="forbid")
    rate: Annotated[FiniteFloat | None, Field(gt=0, le=30, description="Hz")] = None
    colour: Name | None = None


async def tune(request: Request, name: str, payload: dict[str, Any]) -> None:
    """Have the runtime do what may change parameters; who did is noted."""
    await Assembly.of(request).changes.command(Identity.of(request).name, name, payload)


@router.get(
    "",
    summary="The robot's newest state",
    operation_id="getRobot",
    responses=answers(_503="The runtime has said nothing yet"),
    response_model=State,
)
async def get_robot(request: Request) -> object:
    """As the runtime sent it last; its `time` says when that was (s, steady clock)."""
    state = Assembly.of(request).watch.state()
    if state is None:
        raise HTTPException(503, "The robot's runtime has said nothing yet. Its state is in /api/health.")
    return state


@router.post("/stop", status_code=204, summary="Disarm at once", operation_id="stopRobot", responses=SILENT)
async def stop(request: Request) -> None:
    """Never refused, and before everything else."""
    await Assembly.of(request).bridge.command("stop", {})


@router.post("/arm", status_code=204, summary="Arm", operation_id="armRobot", responses=COMMAND)
async def arm(request: Request, driver: Driver | None = None) -> None:
    """Refused with every reason that stands against it; without a body the depth controller steers."""
    assembly = Assembly.of(request)
    check_room(assembly.settings.data)
    await assembly.bridge.command("arm", driver.model_dump() if driver else {})


@router.put("/mode", status_code=204, summary="Hand over", operation_id="putMode", responses=COMMAND)
async def put_mode(request: Request, driver: Driver) -> None:
    """Let the pilot or the depth controller steer the armed robot."""
    await Assembly.of(request).bridge.command("mode", driver.model_dump())


@router.post(
    "/check-fins", status_code=204, summary="Check the fins", operation_id="checkFins", responses=COMMAND
)
async def check_fins(request: Request) -> None:
    """Arm for some seconds, try each axis, and tell in an event which fins followed; then disarm."""
    await Assembly.of(request).bridge.command("check_fins", {})


@router.post(
    "/acknowledge",
    status_code=204,
    summary="Acknowledge the alarms",
    operation_id="acknowledgeAlarms",
    responses=COMMAND,
)
async def acknowledge(request: Request) -> None:
    """Say that all alarms were seen; after a failsafe the robot may be armed again from then on."""
    assembly = Assembly.of(request)
    assembly.alarms.acknowledge()
    await assembly.bridge.command("acknowledge", {})


@router.put(
    "/controller",
    status_code=204,
    summary="Choose a controller",
    operation_id="putController",
    responses=COMMAND,
)
async def put_controller(request: Request, controller: Controller) -> None:
    """Choose a controller, and set gains of it."""
    await tune(request, "controller", controller.model_dump())


@router.put(
    "/loops/{name}",
    status_code=204,
    summary="Steer or hold depth or an angle",
    operation_id="putLoop",
    responses=COMMAND,
)
async def put_loop(
    request: Request, name: Literal["depth", "heading", "pitch", "roll"], change: LoopChange
) -> None:
    """Switch a loop on or off, move its set point, choose its controller and gains: all of it or nothing."""
    question = {"name": name, **change.model_dump(exclude_none=True)}
    await tune(request, "loop", question)


@router.put(
    "/set-points", status_code=204, summary="Set depths", operation_id="putSetPoints", responses=COMMAND
)
async def put_set_points(request: Request, set_points: SetPoints) -> None:
    """Set the wanted depths."""
    await tune(request, "set_points", set_points.model_dump(exclude_none=True))


@router.put(
    "/steering", status_code=204, summary="Choose a course", operation_id="putSteering", responses=COMMAND
)
async def put_steering(request: Request, course: Course) -> None:
    """Stay, or swim towards a light beacon."""
    await tune(request, "steering", course.model_dump())


@router.put(
    "/card", status_code=204, summary="Show or hide the card", operation_id="putCard", responses=COMMAND
)
async def put_card(request: Request, card: Card) -> None:
    """Show a coloured card to the simulated camera, or take it away."""
    await Assembly.of(request).bridge.command("card", card.model_dump())


@router.put("/vision", status_code=204, summary="Set up vision", operation_id="putVision", responses=COMMAND)
async def put_vision(request: Request, vision: Vision) -> None:
    """Set how often the vision node looks, and for which colour."""
    await tune(request, "vision", vision.model_dump(exclude_none=True))
