"""The robot's commands, checked and sent for HTTP and for the doors of other programs."""

from robot_runtime.contract.commands import (
    COMMANDS,
    AcknowledgeCommand,
    ArmCommand,
    RobotCommand,
    StopCommand,
    http_commands,
)
from robot_runtime.control.alarms import Alarms
from robot_runtime.errors import RefusedError
from server.driving.changes import Changes
from server.driving.schemas import Restored
from server.http.addresses import nearest, shown
from server.platform.disk_space import check_room
from server.platform.errors import NotFoundError
from server.platform.settings import Settings

OFFERED = tuple(cls.policy.name for cls in http_commands() if cls.policy.need is not None)
"""The commands that programs may send; STOP has an operation of its own."""


class UnknownCommandError(NotFoundError):
    """There is no such command for programs"""


def explain_unknown_command(name: str) -> str:
    """Return the reason why a command cannot be sent, with the commands that can."""
    if name == StopCommand.policy.name:
        return "STOP is POST /api/robot/stop."
    what = (
        f"The command {shown(name)} is for scenarios and the server alone."
        if name in COMMANDS
        else f"There is no command {shown(name)}. {nearest(name, OFFERED)}".strip()
    )
    return f"{what} Programs can send: {', '.join(OFFERED)}."


class CheckedCommands:
    """The server's checks and sending of commands. The caller's rights are checked before."""

    def __init__(self, changes: Changes, settings: Settings, alarms: Alarms) -> None:
        self._changes = changes
        self._settings = settings
        self._alarms = alarms

    async def perform(self, who: str, command: RobotCommand) -> Restored:
        """Send a command of `who`; return the changed and the omitted parameters.

        Raise RefusedError, RuntimeSilentError.
        """
        if isinstance(command, ArmCommand):
            if command.alone:
                raise RefusedError("Only a scenario may let the robot go on without the server.")
            check_room(self._settings.data)
        elif isinstance(command, AcknowledgeCommand):
            self._alarms.acknowledge()
        return await self._changes.command(who, command)
