"""Performs the robot's commands, for HTTP and for the doors of other programs."""

from robot_runtime.contract.commands import (
    COMMANDS,
    AcknowledgeCommand,
    ArmCommand,
    RobotCommand,
    http_commands,
)
from robot_runtime.control.alarms import Alarms
from robot_runtime.errors import RefusedError
from server.features.parameters.changes import Changes
from server.features.parameters.schemas import Restored
from server.http.addresses import nearest, shown
from server.platform.disk_space import check_room
from server.platform.errors import NotFoundError
from server.platform.settings import Settings

OFFERED = tuple(cls.policy.name for cls in http_commands() if cls.policy.need is not None)
"""The commands that programs may send; STOP has an operation of its own."""


class UnknownCommandError(NotFoundError):
    """There is no such command for programs"""


def explain_unknown_command(name: str) -> str:
    """The reason for which a command cannot be sent, with those that can."""
    if name == "stop":
        return "STOP is POST /api/robot/stop."
    what = (
        f"The command {shown(name)} is for scenarios and the server alone."
        if name in COMMANDS
        else f"There is no command {shown(name)}. {nearest(name, OFFERED)}".strip()
    )
    return f"{what} Programs can send: {', '.join(OFFERED)}."


class CheckedCommands:
    """Sends commands to the robot with the checks of the server. The caller's rights are checked before."""

    def __init__(self, changes: Changes, settings: Settings, alarms: Alarms) -> None:
        self._changes = changes
        self._settings = settings
        self._alarms = alarms

    async def perform(self, who: str, command: RobotCommand) -> Restored:
        """Send a command of `who`; returns the parameters that it changed, and those that it left out.

        Raises RefusedError, RuntimeSilentError.
        """
        if isinstance(command, ArmCommand):
            if command.alone:
                raise RefusedError("Only a scenario may let the robot go on without the server.")
            check_room(self._settings.data)
        elif isinstance(command, AcknowledgeCommand):
            self._alarms.acknowledge()
        return await self._changes.command(who, command)
