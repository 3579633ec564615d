"""The plug of the stream: blocks of the robot come in and go to the pages, the heartbeat goes out."""

import asyncio
from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from server.feature import Plug
from server.http.sign_in.access import SocketClosers
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub

BEAT_SECONDS = 1.0


def make_notices(clock: Clock, feed: Feed) -> Notices:
    """Return the server's own messages, delivered as the robot's are."""
    return Notices(clock, lambda block: feed.deliver([block]))


def make_bridge(settings: Settings, feed: Feed) -> Bridge:
    """Return the connection to the robot."""
    return Bridge(settings, feed.deliver)


def make_hub(clock: Clock, bridge: Bridge) -> Hub:
    """Return the pages."""
    return Hub(clock, bridge.watch_pictures)


class StreamPlug(Plug):
    """The plug that connects the robot and the pages."""

    makers: ClassVar[tuple[Maker, ...]] = (make_notices, make_bridge, make_hub)

    def __init__(
        self, settings: Settings, feed: Feed, bridge: Bridge, hub: Hub, closers: SocketClosers
    ) -> None:
        self._has_robot = not settings.lab
        self._bridge = bridge
        self._hub = hub
        self._beating: asyncio.Task[None] | None = None
        feed.listen_to_rounds(hub.add)
        closers.add(hub.dismiss)

    async def open(self) -> None:
        """Connect. Heartbeats start now: catching up may take longer than the runtime waits for them."""
        await self._bridge.open()
        if self._has_robot:
            self._beating = asyncio.create_task(self._beat())

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Watch for pages that have stopped reading."""
        return (self._hub.watch(),)

    async def close(self) -> None:
        """Disconnect."""
        if self._beating is not None:
            self._beating.cancel()
        await self._bridge.close()

    async def _beat(self) -> None:
        while True:
            self._bridge.send_heartbeat(self._hub.operators, self._hub.programs())
            await asyncio.sleep(BEAT_SECONDS)
