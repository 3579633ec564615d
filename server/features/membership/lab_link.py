"""The robot's way to its lab: it dials the lab's router, says how it is, and answers two questions.

A lab that is away costs nothing: Zenoh goes on trying, and the robot swims on.
"""

import asyncio
import logging
import time
from collections.abc import Mapping
from typing import Any

from robot_runtime.errors import RefusedError
from robot_runtime.transport.zenoh_transport import ZenohTransport
from server.features.membership.joined_lab import JoinedLab
from server.features.membership.presence_source import PresenceSource
from server.http.audit import AuditLog
from server.http.sign_in.access import Access
from server.http.sign_in.devices import UnknownDeviceError
from server.http.sign_in.identity import Identity
from server.platform.audit_file import Outcome
from server.platform.errors import ApiError
from server.platform.lab_network import ALIVE, CLOCK, PRESENCE, STOP, member_settings
from server.platform.settings import Settings
from server.stream.bridge import Bridge

log = logging.getLogger(__name__)

PRESENCE_SECONDS = 1.0
ADDRESS_SECONDS = 10.0
"""Interval of the looks at the robot's own address, which its network may change at any time."""
STOP_SECONDS = 5.0
"""Longer than the lab waits: a STOP that comes late stops all the same."""


class LabLink:
    """The connection to one lab at a time."""

    def __init__(
        self, settings: Settings, bridge: Bridge, audit: AuditLog, access: Access, source: PresenceSource
    ) -> None:
        self._settings = settings
        self._bridge = bridge
        self._audit = audit
        self._access = access
        self._source = source
        self._lab: JoinedLab | None = None
        self._messages: ZenohTransport | None = None
        self._address = ""

    @property
    def connected(self) -> bool:
        """True while the lab's router is connected."""
        return self._messages is not None and self._messages.routed

    async def open(self, lab: JoinedLab) -> None:
        """Dial a lab's router, which need not be there. Raise OSError, ConfigError."""
        self._loop = asyncio.get_running_loop()
        self._lab = lab
        self._address = await asyncio.to_thread(self._source.address_for, lab.address)
        self._messages = await asyncio.to_thread(
            ZenohTransport,
            lab.robot,
            connect=[lab.router],
            network=member_settings(self._settings.data.membership),
        )
        self._messages.serve(STOP, self._stop)
        self._messages.serve(CLOCK, lambda _: {"time": time.time()})
        self._messages.announce(ALIVE)

    async def run(self) -> None:
        """Say once a second how the robot is, for ever."""
        while True:
            self._say()
            await asyncio.sleep(PRESENCE_SECONDS)

    async def follow_address(self) -> None:
        """Look at the robot's own address, for ever."""
        while True:
            await asyncio.sleep(ADDRESS_SECONDS)
            if self._lab is not None:
                self._address = await asyncio.to_thread(self._source.address_for, self._lab.address)

    async def close(self, *, leave: bool = False) -> None:
        """Hang up; to `leave` says so to the lab, which then forgets the robot."""
        messages = self._messages
        if messages is None:
            return
        if leave:
            self._say(left=True)
        self._messages = self._lab = None
        await asyncio.to_thread(messages.close)

    def _say(self, *, left: bool = False) -> None:
        if self._messages is None:
            return
        try:
            presence = self._source.presence(self._address, left=left)
        except (OSError, ValueError, LookupError) as problem:
            log.warning("the lab does not hear how the robot is: %s", problem)
            return
        self._messages.publish(PRESENCE, presence.model_dump_json().encode())

    def _stop(self, _: Mapping[str, Any]) -> None:
        """Stop the robot, in a thread of Zenoh's. Raise RefusedError."""
        stopping = asyncio.run_coroutine_threadsafe(self._stop_here(), self._loop)
        try:
            stopping.result(STOP_SECONDS)
        except (ApiError, TimeoutError) as problem:
            raise RefusedError(str(problem) or "The robot's runtime has not answered.") from problem

    async def _stop_here(self) -> None:
        try:
            await self._bridge.stop()
        except ApiError:
            self._record("failed")
            raise
        self._record("done")

    def _record(self, outcome: Outcome) -> None:
        self._audit.record(self._identity(), "", "Disarm at once", "by the lab", outcome, "stopRobot")

    def _identity(self) -> Identity | None:
        """Return the lab as a caller: the same as by HTTPS."""
        try:
            return None if self._lab is None else self._access.devices.get(self._lab.device).identity
        except UnknownDeviceError:
            return None
