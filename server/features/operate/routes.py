"""The robot: its state and link, and commands to it, which the runtime checks again."""

from dataclasses import fields
from typing import Any

from pydantic import Field

from robot_runtime.contract.commands import RobotCommand, http_commands, is_required
from robot_runtime.contract.documents import State
from robot_runtime.contract.topics import STATE
from robot_runtime.link.dissection import Dissection
from server.driving.changes import COMMAND_ERRORS
from server.driving.checked_commands import (
    CheckedCommands,
    UnknownCommandError,
    explain_unknown_command,
)
from server.driving.schemas import Restored
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.errors import UnavailableError
from server.platform.schema_base import Schema
from server.stream.bridge import Bridge, RuntimeSilentError

router = Operations(prefix="/api")


class LinkFault(Schema):
    """The last fault of the serial line, and the frames before it."""

    time: float = Field(description="s, steady clock")
    text: str
    frames: list[Dissection]


class LinkFrames(Schema):
    """The last hundred frames each way since the port was opened, in the order of time."""

    time: float = Field(description="now, s, steady clock")
    frames: list[Dissection]
    fault: LinkFault | None = Field(description="null if there was none since the runtime started")


@router.operation("GET /link/frames", Need.VIEWER, RuntimeSilentError, tags=["link"])
async def get_link_frames(bridge: Provided[Bridge]) -> LinkFrames:
    """Return the last frames on the serial line, now and at the last fault."""
    return LinkFrames.model_validate(await bridge.query("frames"))


@router.operation("GET /robot", Need.VIEWER, UnavailableError, response_model=State, tags=["robot"])
async def get_robot(monitor: Provided[HealthMonitor], bridge: Provided[Bridge]) -> object:
    """Return the robot's newest state.

    The runtime sent it at its `time` (s, steady clock), after the last command that it answered. 503 where
    that state is too old to be the present one.
    """
    await monitor.catch_up(STATE, bridge.answered)
    state = monitor.state()
    if state is None:
        raise UnavailableError("The robot's runtime has sent no state yet. /api/health says why.")
    monitor.require_heard()
    return state


@router.operation("POST /robot/stop", Need.VIEWER, RuntimeSilentError, lenient=True, tags=["robot"])
async def stop_robot(bridge: Provided[Bridge]) -> None:
    """Disarm at once.

    STOP is never refused, and precedes everything else.
    """
    await bridge.stop()


def _add_command(cls: type[RobotCommand], need: Need) -> None:
    optional = not any(map(is_required, fields(cls)))
    answer = Restored if cls.policy.tunes else None

    async def perform(commands: Provided[CheckedCommands], caller: Caller, command: Any) -> Restored | None:
        restored = await commands.perform(caller.name, cls() if command is None else command)
        return restored if answer else None

    # FastAPI takes name, texts and schemas of the operation from the function.
    perform.__name__ = f"command_{cls.policy.name}"
    perform.__doc__ = cls.__doc__
    perform.__annotations__ |= {"command": cls | None if optional else cls, "return": answer}
    if optional:
        perform.__defaults__ = (None,)
    router.operation(f"POST /robot/commands/{cls.policy.name}", need, *COMMAND_ERRORS, tags=["robot"])(
        perform
    )


for _cls in http_commands():
    if _cls.policy.need is not None:
        _add_command(_cls, _cls.policy.need)


@router.operation("POST /robot/commands/{name}", Need.VIEWER, UnknownCommandError, include_in_schema=False)
async def refuse_command(name: str) -> None:
    """Refuse an unknown command."""
    raise UnknownCommandError(explain_unknown_command(name))
