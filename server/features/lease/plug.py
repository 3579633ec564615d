"""The plug of control: who has it, and what the runtime knows of it."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import STATE
from server.feature import Plug
from server.features.lease.arbiter import ControlArbiter
from server.features.lease.sync import LeaseSync
from server.http.audit import AuditLog
from server.http.sign_in.access import SocketClosers
from server.platform.notices import Notices
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub


def make_sync(bridge: Bridge) -> LeaseSync:
    """Sends the runtime the epoch of control."""
    return LeaseSync(bridge.send_lease)


def make_arbiter(
    clock: Clock, sync: LeaseSync, hub: Hub, bridge: Bridge, notices: Notices, audit: AuditLog
) -> ControlArbiter:
    """Grants control."""

    def notify(message: dict[str, Any]) -> None:
        sync.see_epoch(message["epoch"])
        hub.notify(message)

    return ControlArbiter(
        clock,
        notify,
        bridge.drive,
        lambda text: notices.notify("control", "info", text),
        lambda identity, why: audit.record(identity, "", "Lose control", why, "done"),
    )


class LeasePlug(Plug):
    """Takes control from those who are dismissed, and tells the runtime."""

    makers: ClassVar[tuple[Maker, ...]] = (make_sync, make_arbiter)

    def __init__(
        self, arbiter: ControlArbiter, sync: LeaseSync, bridge: Bridge, feed: Feed, closers: SocketClosers
    ) -> None:
        self._arbiter = arbiter
        self._sync = sync
        closers.add(lambda device, _: arbiter.dismiss(device))
        feed.listen(lambda _: sync.see_run(bridge.run), STATE)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """End control that nobody renews, and send each new epoch."""
        return (self._arbiter.run(), self._sync.run())
