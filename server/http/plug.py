"""The plug of the HTTP interface: sign-in, audit log, memory for STOP."""

import asyncio
from dataclasses import dataclass
from typing import ClassVar

from robot_runtime.clock import Clock
from server.feature import Plug
from server.http.audit import AuditLog
from server.http.page import Page
from server.http.sign_in.access import Access, SocketClosers
from server.platform.memory_reserve import MemoryReserve
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.services import Maker


@dataclass(frozen=True, slots=True)
class ShellToken:
    """The token by which the shell of this computer proves itself."""

    text: str


def make_page(settings: Settings) -> Page:
    """Return the page's files."""
    return Page(settings.page)


def make_audit_log(settings: Settings, clock: Clock, notices: Notices) -> AuditLog:
    """Return the audit log, whose acts are notices too."""
    return AuditLog(settings.data.audit, clock, lambda _, text: notices.notify("control", "info", text))


def make_access(
    settings: Settings,
    store: Store,
    clock: Clock,
    notices: Notices,
    closers: SocketClosers,
    token: ShellToken,
) -> Access:
    """Return the access to this server."""
    return Access(settings, store, clock, notices.notify, closers.close, token.text)


class HttpPlug(Plug):
    """The plug that opens access first, and closes it last."""

    makers: ClassVar[tuple[Maker, ...]] = (make_page, make_audit_log, make_access)

    def __init__(self, access: Access, audit: AuditLog, reserve: MemoryReserve, store: Store) -> None:
        self._access = access
        self._audit = audit
        self._reserve = reserve
        self._store = store

    async def open(self) -> None:
        """Load the devices."""
        self._reserve.watch(asyncio.get_running_loop())
        self._access.open()

    async def close(self) -> None:
        """Write the waiting entries."""
        await self._access.devices.close()
        await asyncio.to_thread(self._audit.close)
        await asyncio.to_thread(self._store.close)
