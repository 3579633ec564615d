"""The robot: its state, and commands to it. The runtime checks every command again, and may refuse it."""

from dataclasses import fields
from typing import Any

from fastapi import APIRouter

from robot_runtime.contract.commands import (
    AcknowledgeCommand,
    ArmCommand,
    RobotCommand,
    http_commands,
    is_required,
    summary,
)
from robot_runtime.contract.documents import State
from robot_runtime.control.alarms import Alarms
from robot_runtime.errors import RefusedError
from server.features.parameters.changes import Changes
from server.features.parameters.schemas import Restored
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.problems import COMMAND, SILENT, answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs
from server.platform.disk_space import check_room
from server.platform.errors import UnavailableError
from server.platform.settings import Settings
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api/robot", tags=["robot"])


@router.get(
    "",
    summary="The robot's newest state",
    operation_id="getRobot",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(_503="The runtime has said nothing yet"),
    response_model=State,
)
async def get_robot(watch: Provided[HealthMonitor]) -> object:
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


def _add_route(cls: type[RobotCommand], need: Need) -> None:
    optional = not any(map(is_required, fields(cls)))

    async def perform(
        changes: Provided[Changes],
        settings: Provided[Settings],
        alarms: Provided[Alarms],
        caller: Caller,
        command: Any,
    ) -> Restored | None:
        request: RobotCommand = cls() if command is None else command
        if isinstance(request, ArmCommand):
            if request.alone:
                raise RefusedError("Only a scenario may let the robot go on without the server.")
            check_room(settings.data)
        elif isinstance(request, AcknowledgeCommand):
            alarms.acknowledge()
        restored = await changes.command(caller.name, request)
        return restored if cls.policy.tunes else None

    # FastAPI takes the body's schema from here.
    perform.__annotations__["command"] = cls | None if optional else cls
    if optional:
        perform.__defaults__ = (None,)
    router.add_api_route(
        f"/commands/{cls.policy.name}",
        perform,
        methods=["POST"],
        status_code=200 if cls.policy.tunes else 204,
        response_model=Restored if cls.policy.tunes else None,
        summary=summary(cls),
        description=cls.__doc__,
        operation_id="command" + "".join(part.capitalize() for part in cls.policy.name.split("_")),
        openapi_extra=needs(need),
        responses=COMMAND,
    )


for _cls in http_commands():
    if _cls.policy.need is not None:
        _add_route(_cls, _cls.policy.need)
