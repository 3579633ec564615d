"""The robot: its state, and commands to it. The runtime checks every command again, and may refuse it."""

from typing import Annotated, Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from robot_runtime.contract.documents import State, Steering
from robot_runtime.control.alarms import Alarms
from server.features.parameters.changes import Changes
from server.health.monitor import Watch
from server.http.dependencies import Provided
from server.http.problems import COMMAND, SILENT, answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs
from server.platform.disk_space import check_room
from server.platform.errors import UnavailableError
from server.platform.settings import Settings
from server.stream.bridge import Bridge

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


@router.get(
    "",
    summary="The robot's newest state",
    operation_id="getRobot",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(_503="The runtime has said nothing yet"),
    response_model=State,
)
async def get_robot(watch: Provided[Watch]) -> object:
    """As the runtime sent it last; its `time` says when that was (s, steady clock)."""
    state = watch.state()
    if state is None:
        raise UnavailableError("The robot's runtime has said nothing yet. Its state is in /api/health.")
    return state


@router.post(
    "/stop",
    status_code=204,
    summary="Disarm at once",
    operation_id="stopRobot",
    openapi_extra=needs(Need.VIEWER),
    responses=SILENT,
)
async def stop(bridge: Provided[Bridge]) -> None:
    """Never refused, and before everything else."""
    await bridge.command("stop", {})


@router.post(
    "/arm",
    status_code=204,
    summary="Arm",
    operation_id="armRobot",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def arm(settings: Provided[Settings], bridge: Provided[Bridge], driver: Driver | None = None) -> None:
    """Refused with every reason that stands against it; without a body the depth controller steers."""
    check_room(settings.data)
    await bridge.command("arm", driver.model_dump() if driver else {})


@router.put(
    "/mode",
    status_code=204,
    summary="Hand over",
    operation_id="putMode",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_mode(bridge: Provided[Bridge], driver: Driver) -> None:
    """Let the pilot or the depth controller steer the armed robot."""
    await bridge.command("mode", driver.model_dump())


@router.post(
    "/check-fins",
    status_code=204,
    summary="Check the fins",
    operation_id="checkFins",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def check_fins(bridge: Provided[Bridge]) -> None:
    """Arm for some seconds, try each axis, and tell in an event which fins followed; then disarm."""
    await bridge.command("check_fins", {})


@router.post(
    "/acknowledge",
    status_code=204,
    summary="Acknowledge the alarms",
    operation_id="acknowledgeAlarms",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def acknowledge(alarms: Provided[Alarms], bridge: Provided[Bridge]) -> None:
    """Say that all alarms were seen; after a failsafe the robot may be armed again from then on."""
    alarms.acknowledge()
    await bridge.command("acknowledge", {})


@router.put(
    "/controller",
    status_code=204,
    summary="Choose a controller",
    operation_id="putController",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_controller(changes: Provided[Changes], caller: Caller, controller: Controller) -> None:
    """Choose a controller, and set gains of it."""
    await changes.command(caller.name, "controller", controller.model_dump())


@router.put(
    "/loops/{name}",
    status_code=204,
    summary="Steer or hold depth or an angle",
    operation_id="putLoop",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_loop(
    changes: Provided[Changes],
    caller: Caller,
    name: Literal["depth", "heading", "pitch", "roll"],
    change: LoopChange,
) -> None:
    """Switch a loop on or off, move its set point, choose its controller and gains: all of it or nothing."""
    question = {"name": name, **change.model_dump(exclude_none=True)}
    await changes.command(caller.name, "loop", question)


@router.put(
    "/set-points",
    status_code=204,
    summary="Set depths",
    operation_id="putSetPoints",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_set_points(changes: Provided[Changes], caller: Caller, set_points: SetPoints) -> None:
    """Set the wanted depths."""
    await changes.command(caller.name, "set_points", set_points.model_dump(exclude_none=True))


@router.put(
    "/steering",
    status_code=204,
    summary="Choose a course",
    operation_id="putSteering",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_steering(changes: Provided[Changes], caller: Caller, course: Course) -> None:
    """Stay, or swim towards a light beacon."""
    await changes.command(caller.name, "steering", course.model_dump())


@router.put(
    "/card",
    status_code=204,
    summary="Show or hide the card",
    operation_id="putCard",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_card(bridge: Provided[Bridge], card: Card) -> None:
    """Show a coloured card to the simulated camera, or take it away."""
    await bridge.command("card", card.model_dump())


@router.put(
    "/vision",
    status_code=204,
    summary="Set up vision",
    operation_id="putVision",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def put_vision(changes: Provided[Changes], caller: Caller, vision: Vision) -> None:
    """Set how often the vision node looks, and for which colour."""
    await changes.command(caller.name, "vision", vision.model_dump(exclude_none=True))
