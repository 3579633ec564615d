"""The plug of control: its holder, and its epoch for the runtime."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import STATE
from server.driving.arbiter import ControlArbiter
from server.driving.sync import LeaseSync
from server.feature import Plug
from server.http.audit import AuditLog
from server.http.sign_in.access import SocketClosers
from server.platform.notices import Notices
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub


def make_sync(bridge: Bridge) -> LeaseSync:
    """Return the sender of control's epoch to the runtime."""
    return LeaseSync(bridge.send_lease)


def make_arbiter(
    clock: Clock, sync: LeaseSync, hub: Hub, bridge: Bridge, notices: Notices, audit: AuditLog
) -> ControlArbiter:
    """Return the arbiter of control."""

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


class DrivingPlug(Plug):
    """The plug that takes control from dismissed clients, and informs the runtime."""

    makers: ClassVar[tuple[Maker, ...]] = (make_sync, make_arbiter)

    def __init__(
        self,
        arbiter: ControlArbiter,
        sync: LeaseSync,
        bridge: Bridge,
        hub: Hub,
        feed: Feed,
        closers: SocketClosers,
    ) -> None:
        self._arbiter = arbiter
        self._sync = sync
        hub.programs = arbiter.programs_in_control
        closers.add(lambda device, _: arbiter.dismiss(device))
        feed.listen(lambda _: sync.see_run(bridge.run), STATE)

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """End control that is not renewed, and send each new epoch."""
        return (self._arbiter.run(), self._sync.run())
