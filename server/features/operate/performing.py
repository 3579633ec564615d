"""Performs the robot's commands, for HTTP and for the doors of other programs."""

from robot_runtime.contract.commands import AcknowledgeCommand, ArmCommand, RobotCommand
from robot_runtime.control.alarms import Alarms
from robot_runtime.errors import RefusedError
from server.features.parameters.changes import Changes
from server.features.parameters.schemas import Restored
from server.platform.disk_space import check_room
from server.platform.settings import Settings


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
