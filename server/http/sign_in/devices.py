"""Browsers, programs, labs and reading links, with their roles: found in memory, stored in the database."""

import asyncio
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from hmac import compare_digest
from math import inf

from sqlalchemy import Connection, delete, update
from sqlmodel import col, select

from robot_runtime.errors import RefusedError
from server.http.sign_in.identity import SHELL, Identity, Kind, Role, Scope
from server.http.sign_in.names import find_same, number_name
from server.http.sign_in.tokens import TOKEN_PREFIX, derive_secret, digest, make_token
from server.platform.errors import NotFoundError, SignedOutError
from server.platform.models import DeviceRow
from server.platform.store import Store, StoreError, insert_row
from server.platform.wall_clock import is_set

log = logging.getLogger(__name__)

CLOCK_NOT_SET = (
    "The clock of the robot's computer has not been set since its start, so that it is not known whether a "
    "token has ended. Connect it to a network with a time server, or set it: "
    "sudo date -u -s '2026-11-24 12:00'."
)
DEVICES_MAX = 200
REMOVED = "removed"
"""Kind of a row that is no device any more."""
LINKS_MAX = 50
"""Reading links of one session, ended ones included."""
FORMER_MAX = 1000
"""Removed devices whose names are remembered, the newest."""
SEEN_SECONDS = 3600.0
"""Interval of storing the last visit; a shorter one would wear out the SD card."""
DAY_SECONDS = 86400.0
IDLE_DAYS = 90
"""A browser that has not been used for so long is signed out."""


class UnknownDeviceError(NotFoundError):
    """There is no such device"""

    def __init__(self, device: int) -> None:
        super().__init__(f"There is no device {device}; GET /api/access/devices lists those there are.")


class UnknownLinkError(NotFoundError):
    """There is no such reading link"""

    def __init__(self, link: int) -> None:
        super().__init__(f"There is no reading link {link}: somebody may have ended it already.")


class SignInEndedError(SignedOutError):
    """The token or the sign-in has ended"""


@dataclass(frozen=True, slots=True)
class BrowserSecrets:
    """The two secrets of a browser.

    `cookie` goes to every server of this host name, whatever its port; `page` to this server's page alone.
    """

    cookie: str
    page: str


@dataclass(slots=True)
class Device:
    """A paired browser or program, a lab, or a reading link, as in DeviceRow.

    `page_secret` is a digest. `stored` is the last visit in the database, `used` the last one since this
    server began (s, steady clock). `stored_role` is the role in the database.
    """

    id: int
    name: str
    role: Role
    kind: Kind
    paired: float
    seen: float
    stored: float
    limited: bool
    ends: float | None
    page_secret: str | None
    stored_role: Role
    session: int | None = None
    used: float = -inf

    def has_page_secret(self, secret: str) -> bool:
        """Check the second secret of a browser; a browser that was paired without one fails."""
        return self.page_secret is not None and compare_digest(digest(secret), self.page_secret)

    @property
    def identity(self) -> Identity:
        """The identity of this device as a caller."""
        return Identity(self.id, self.name, self.role, self.kind, self.limited, self.session)


class Devices:
    """All devices. Only this server writes them, so that memory and database agree."""

    def __init__(
        self,
        store: Store,
        utc: Callable[[], float] = time.time,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:
        self._store = store
        self._utc = utc
        self._steady = steady
        self._devices: dict[int, Device] = {}
        self._by_secret: dict[str, int] = {}
        self._former: list[str] = []
        """Names of removed devices, which no new browser gets."""
        self._writing: set[asyncio.Task[None]] = set()
        self._naming = asyncio.Lock()
        """Held from the look at the names there are until a new one is stored."""

    def load(self) -> None:
        """Load all devices from the database. Raise StoreError."""
        with self._store.read() as session:
            for row in session.exec(select(DeviceRow)):
                assert row.id is not None
                if row.kind == REMOVED:
                    self._former.append(row.name)
                else:
                    self._keep(row.id, row)

    def all(self) -> list[Device]:
        """Return all browsers, programs and labs, by number."""
        return [device for _, device in sorted(self._devices.items()) if device.kind != "reader"]

    def links(self, session: int) -> list[Device]:
        """Return the reading links of a session, by number."""
        return [device for _, device in sorted(self._devices.items()) if device.session == session]

    def get(self, number: int) -> Device:
        """Return the browser, program or lab of this number. Raise UnknownDeviceError."""
        device = self._devices.get(number)
        if device is None or device.kind == "reader":
            raise UnknownDeviceError(number)
        return device

    def get_link(self, number: int) -> Device:
        """Return the reading link of this number. Raise UnknownLinkError."""
        device = self._devices.get(number)
        if device is None or device.kind != "reader":
            raise UnknownLinkError(number)
        return device

    def find(self, secret: str, *kinds: Kind) -> Device | None:
        """Return the device of one of these kinds that has this secret, even if it has expired."""
        return self.find_digest(digest(secret), *kinds)

    def find_digest(self, secret: str, *kinds: Kind) -> Device | None:
        """Return the device of one of these kinds by the digest of its secret."""
        device = self._devices.get(self._by_secret.get(secret, 0))
        return device if device is not None and device.kind in kinds else None

    def find_link(self, token: str) -> tuple[Device, BrowserSecrets] | None:
        """Return the reading link of a token, even if it has expired, and the secrets of its browsers."""
        secrets = _secrets_of_link(token)
        device = self.find(secrets.cookie, "reader")
        return None if device is None else (device, secrets)

    def find_valid(self, number: int) -> Device | None:
        """Return the device of this number; None if expired or revoked, even before that is stored."""
        device = self._devices.get(number) if number in self._by_secret.values() else None
        return None if device is None or self.explain_end(device) is not None else device

    def explain_end(self, device: Device) -> str | None:
        """Return the reason why a device's time is over; None while it is not."""
        if device.ends is not None and not is_set(self._utc()):
            return CLOCK_NOT_SET
        if device.ends is not None and self._utc() >= device.ends and device.kind == "reader":
            moment = datetime.fromtimestamp(device.ends, UTC)
            return f"This reading link ended on {moment:%Y-%m-%d at %H:%M} UTC. Ask for a new one."
        if device.ends is not None and self._utc() >= device.ends:
            day = datetime.fromtimestamp(device.ends, UTC).date()
            return f"This token ended on {day}. Make a new one under People, or with `mucat access token`."
        # The steady clock too: a computer without a clock battery may learn the time in the middle of a dive.
        unused = min(self._utc() - device.seen, self._steady() - device.used)
        # A visit of an impossible date, before the clock was set, has no known age.
        if device.kind == "browser" and is_set(device.seen) and unused > IDLE_DAYS * DAY_SECONDS:
            return f"This browser was not used for {IDLE_DAYS} days, and is signed out. Sign it in again."
        return None

    def end_of(self, number: int) -> float | None:
        """Return the end of a device's token or link, s since 1970; None where it never ends."""
        return self._devices[number].ends if number in self._devices else None

    def count_seconds(self, number: int) -> float | None:
        """Return the seconds until the device's token or link ends; None where it never does."""
        ends = self.end_of(number)
        return None if ends is None else max(0.0, ends - self._utc())

    @property
    def operators(self) -> list[Device]:
        """The operators that are browsers; only they can admit others."""
        return [
            device
            for device in self._devices.values()
            if (device.kind, device.role) == ("browser", "operator")
            and self.find_valid(device.id) is not None
        ]

    async def add_browser(self, name: str, role: Role) -> tuple[Device, BrowserSecrets]:
        """Add a browser; return it and its secrets, which are not stored.

        Its name gets a number where another has it, or a removed one had it. Raise RefusedError
        where there are too many devices, StoreError.
        """
        page = make_token()
        async with self._naming:
            name = number_name(name, [*self._list_names(), *self._former])
            device, cookie = await self._add(name, role, "browser", page_secret=digest(page))
        return device, BrowserSecrets(cookie, page)

    async def add_program(self, name: str, scope: Scope, days: int | None) -> tuple[Device, str]:
        """Add a program; return it and its token, which is not stored. The token ends after `days` (None:
        never).

        Raise RefusedError where there are too many devices, another has the name, or the clock has
        not been set and the token is to end, StoreError.
        """
        if days is not None and not is_set(self._utc()):
            raise RefusedError(f"{CLOCK_NOT_SET} Or make a token that never ends.")
        role: Role = "viewer" if scope == "read" else "operator"
        ends = None if days is None else self._utc() + days * DAY_SECONDS
        async with self._naming:
            self._refuse_same(name, self._list_names())
            return await self._add(name, role, "program", limited=scope != "administer", ends=ends)

    async def add_lab(self, name: str) -> tuple[Device, str]:
        """Add a lab; return it and its token, which is not stored and never ends. Raise as `add_program`."""
        async with self._naming:
            self._refuse_same(name, self._list_names())
            return await self._add(name, "viewer", "lab", limited=True)

    async def add_link(self, session: int, ends: float) -> tuple[Device, str]:
        """Add a reading link of a session; return it and its token, which is not stored.

        It ends at `ends` (s since 1970). Raise RefusedError where there are too many, that moment is over, or
        the clock has not been set, StoreError.
        """
        if not is_set(self._utc()):
            raise RefusedError(CLOCK_NOT_SET)
        if ends <= self._utc():
            raise RefusedError("This reading link would have ended already. Choose a later end.")
        if len(self.links(session)) >= LINKS_MAX:
            raise RefusedError(f"This session has {LINKS_MAX} reading links already. End those nobody needs.")
        token = make_token()
        secrets = _secrets_of_link(token)
        device, _ = await self._add(
            f"reading link for session {session}",
            "viewer",
            "reader",
            ends=ends,
            secret=secrets.cookie,
            page_secret=digest(secrets.page),
            session=session,
        )
        return device, token

    async def _add(
        self,
        name: str,
        role: Role,
        kind: Kind,
        *,
        limited: bool = False,
        ends: float | None = None,
        secret: str = "",
        page_secret: str | None = None,
        session: int | None = None,
    ) -> tuple[Device, str]:
        # Links are limited by session: however many there are, a browser can be signed in.
        if kind != "reader" and len(self.all()) >= DEVICES_MAX:
            raise RefusedError(f"{DEVICES_MAX} devices are paired already. Revoke those that nobody uses.")
        secret = secret or make_token(TOKEN_PREFIX if kind in ("program", "lab") else "")
        now = self._utc()
        row = DeviceRow(
            name=name,
            role=role,
            kind=kind,
            secret=digest(secret),
            paired=now,
            seen=now,
            limited=limited,
            ends=ends,
            page_secret=page_secret,
            session_id=session,
        )
        values = row.model_dump(exclude={"id"})
        number = await self._store.write(lambda connection: insert_row(connection, DeviceRow, values))
        return self._keep(number, row), secret

    async def set_role(self, number: int, role: Role) -> None:
        """Change a role: a lower one holds at once, a higher one when it is stored.

        Raise UnknownDeviceError, StoreError.
        """
        device = self.get(number)
        if role == "viewer":
            device.role = role
        await self._update(number, role=role)
        device.role = device.stored_role = role

    async def rename(self, number: int, name: str) -> None:
        """Rename a device.

        Raise UnknownDeviceError, RefusedError where another has the name, StoreError.
        """
        async with self._naming:
            device = self.get(number)
            self._refuse_same(name, self._list_names(but=number))
            await self._update(number, name=name)
            device.name = name

    def _list_names(self, but: int | None = None) -> list[str]:
        """Return the names of the shell and of all browsers, programs and labs but this one."""
        return [SHELL.name, *(device.name for device in self.all() if device.id != but)]

    @staticmethod
    def _refuse_same(name: str, others: list[str]) -> None:
        if (other := find_same(name, others)) is not None:
            raise RefusedError(
                f"“{name}” is, or looks like, the name of another: “{other}”. Choose one that nobody can "
                "mistake for it."
            )

    async def remove(self, number: int) -> None:
        """Remove a device or link; its secret is invalid at once. Raise UnknownDeviceError, StoreError."""
        if number not in self._devices:
            raise UnknownDeviceError(number)
        name = self._devices[number].name
        self._by_secret = {secret: owner for secret, owner in self._by_secret.items() if owner != number}

        def forget(connection: Connection) -> None:
            # No digest of a secret is such a text.
            values = {"kind": REMOVED, "secret": f"removed {number}", "page_secret": None}
            connection.execute(update(DeviceRow).where(col(DeviceRow.id) == number).values(values))
            old = col(DeviceRow.kind) == REMOVED, col(DeviceRow.id) <= number - FORMER_MAX
            connection.execute(delete(DeviceRow).where(*old))

        await self._store.write(forget, frees=True)
        if self._devices.pop(number, None) is not None:
            self._former.append(name)

    def see(self, device: Device) -> None:
        """Record a request of the device."""
        device.seen, device.used = self._utc(), self._steady()
        # The clock may also have been set back.
        if abs(device.seen - device.stored) < SEEN_SECONDS:
            return
        device.stored = device.seen
        task = asyncio.create_task(self._store_seen(device))
        self._writing.add(task)
        task.add_done_callback(self._writing.discard)

    async def close(self) -> None:
        """Wait for pending writes."""
        await asyncio.gather(*self._writing)

    async def _store_seen(self, device: Device) -> None:
        try:
            await self._update(device.id, seen=device.seen)
        except StoreError as problem:
            log.warning("the last visit of device %d was not stored: %s", device.id, problem)

    async def _update(self, number: int, **values: str | float) -> None:
        await self._store.write(
            lambda connection: connection.execute(
                update(DeviceRow).where(col(DeviceRow.id) == number).values(**values)
            )
        )

    def _keep(self, number: int, row: DeviceRow) -> Device:
        role: Role = "operator" if row.role == "operator" else "viewer"
        device = Device(
            id=number,
            name=row.name,
            role=role,
            kind=_kind_of(row),
            paired=row.paired,
            seen=row.seen,
            stored=row.seen,
            limited=row.limited,
            ends=row.ends,
            page_secret=row.page_secret,
            stored_role=role,
            session=row.session_id,
        )
        self._devices[number] = device
        self._by_secret[row.secret] = number
        return device


def _secrets_of_link(token: str) -> BrowserSecrets:
    return BrowserSecrets(derive_secret("cookie", token), derive_secret("page", token))


def _kind_of(row: DeviceRow) -> Kind:
    if row.session_id is not None:
        return "reader"
    match row.kind:
        case "program" | "lab" as kind:
            return kind
    return "browser"
