"""The plug of the membership in a lab."""

from collections.abc import Coroutine, Sequence
from typing import Any

from server.feature import Plug
from server.features.membership.lab_link import LabLink
from server.features.membership.membership import Membership


class MembershipPlug(Plug):
    """The plug that dials the lab which the robot has joined."""

    def __init__(self, membership: Membership, link: LabLink) -> None:
        self._membership = membership
        self._link = link

    async def start(self) -> None:
        """Dial the lab."""
        await self._membership.open()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Say how the robot is, and where."""
        return (self._link.run(), self._link.follow_address())

    async def stop(self) -> None:
        """Hang up."""
        await self._link.close()
