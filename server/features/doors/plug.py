"""The plug of the doors for other programs."""

from typing import Any, ClassVar

from robot_runtime.clock import Clock
from server.driving.arbiter import ControlArbiter
from server.driving.changes import Changes
from server.driving.checked_commands import CheckedCommands
from server.feature import Plug
from server.features.doors.commands import DoorCommands
from server.features.doors.house import Doors
from server.features.doors.ros2_door import Ros2Door
from server.http.audit import AuditLog
from server.http.sign_in.access import Access, SocketClosers
from server.platform.settings import Settings
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub


def make_ros2(
    settings: Settings,
    clock: Clock,
    access: Access,
    arbiter: ControlArbiter,
    audit: AuditLog,
    doors: Doors,
    commands: CheckedCommands,
    bridge: Bridge,
) -> Ros2Door:
    """Return the door for ROS 2."""
    performed = DoorCommands("/ros2", clock, access, commands, bridge, arbiter, audit)
    return Ros2Door(settings, access, arbiter, audit, doors, performed)


class DoorsPlug(Plug):
    """The plug that passes the pages' data on to the doors."""

    makers: ClassVar[tuple[Maker, ...]] = (make_ros2,)

    def __init__(
        self, doors: Doors, ros2: Ros2Door, changes: Changes, feed: Feed, hub: Hub, closers: SocketClosers
    ) -> None:
        self._doors = doors
        self._ros2 = ros2
        changes.listeners.append(doors.note_parameters)
        closers.add(doors.dismiss)
        feed.listen(doors.see)
        hub.listeners.append(self._see)

    async def start(self) -> None:
        """Listen for programs of ROS 2."""
        await self._ros2.open()

    async def stop(self) -> None:
        """End the connections of ROS 2."""
        await self._ros2.close()

    def _see(self, message: dict[str, Any]) -> None:
        if message["op"] == "health":
            self._doors.see_health(message["parts"])
