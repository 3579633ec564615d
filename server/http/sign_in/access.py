"""Access to the server: pairing, signing in by cookie or token, roles, revocation."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hmac import compare_digest

from starlette.requests import HTTPConnection

from robot_runtime.clock import Clock
from robot_runtime.contract import documents
from robot_runtime.durable_files import write_whole
from robot_runtime.errors import RefusedError
from server.http.sign_in.confirmation import Confirmations
from server.http.sign_in.devices import BrowserSecrets, Device, Devices, SignInEndedError
from server.http.sign_in.identity import SHELL, Identity, Role, Scope
from server.http.sign_in.pairing_codes import PairingCodes, WrongCodeError
from server.http.sign_in.tokens import digest
from server.platform.errors import ForbiddenError
from server.platform.settings import Settings
from server.platform.store import Store

log = logging.getLogger(__name__)

Notify = Callable[[str, documents.Severity, str], None]
CloseSockets = Callable[[int, str], None]
"""Ends the live sockets of a device, with this reason."""

BEARER = "bearer "
PAGE_HEADER = "x-mucat"
"""The header in which the page sends its secret."""
PAGE_PROTOCOL = "mucat"
"""The subprotocol of the page's live socket, offered with the secret as a second one: a page can give its
socket no header."""
REVOKED = "Access was revoked by an operator."
NO_PAGE_SECRET = (
    "This page has lost its part of the sign-in, as when a browser's stored data are cleared, or after an "
    "update from a version without it. Sign this browser in again."
)


NO_LINK = (
    "This reading link opens nothing here: it was ended, is not complete, or is of another robot. Ask "
    "whoever gave it to you for a new one."
)


class LinkEndedError(ForbiddenError):
    """The reading link has ended, or there never was one"""


def cookie_name(port: int) -> str:
    """Return the name of a browser's cookie: browsers share cookies between all ports of a computer."""
    return f"mucat_{port}"


class SocketClosers:
    """The functions that end the sockets of a device."""

    def __init__(self) -> None:
        self._closers: list[CloseSockets] = []

    def add(self, close: CloseSockets) -> None:
        """Add the function that ends sockets of one kind."""
        self._closers.append(close)

    def close(self, device: int, reason: str) -> None:
        """End all sockets of this device, with a reason."""
        for close in self._closers:
            close(device, reason)


class Access:
    """One for the server; `notify` writes notices, which also get into what is being recorded, and `token` is
    what the shell of this computer is given to prove itself with.
    """

    def __init__(
        self,
        settings: Settings,
        store: Store,
        clock: Clock,
        notify: Notify,
        close_sockets: CloseSockets,
        token: str,
    ) -> None:
        self.cookie = cookie_name(settings.server.port)
        self.codes = PairingCodes(clock)
        self.confirmations = Confirmations(clock)
        self.devices = Devices(store)
        self._token_file = settings.data.token
        self._token = token
        self._notify = notify
        self._close_sockets = close_sockets
        self._limit_reported = False

    def open(self) -> None:
        """Load the devices, and write the token of this computer's shell. Raise StoreError."""
        self.devices.load()
        try:
            self._write_token()
        except OSError as problem:
            log.warning("this server refuses commands in a shell: its token is not written: %s", problem)

    def identify(
        self, connection: HTTPConnection, cookie_suffices: Callable[[], bool] = lambda: False
    ) -> Identity | None:
        """Return the caller's identity. With an authorization header, a cookie is ignored.

        A browser shows its page's secret beside the cookie, unless `cookie_suffices`.
        Raise SignInEndedError.
        """
        header = connection.headers.get("authorization")
        if header is not None:
            if not header.lower().startswith(BEARER):
                return None
            return self._find_bearer(header[len(BEARER) :].strip())
        device = self.devices.find(connection.cookies.get(self.cookie, ""), "browser", "reader")
        whole = device is None or device.has_page_secret(_page_secret(connection)) or cookie_suffices()
        if not whole:
            raise SignInEndedError(NO_PAGE_SECRET)
        return self._see(device)

    def identify_program(self, connection: HTTPConnection) -> Identity | None:
        """Return the identity by a token alone, in the header or the query. Raise SignInEndedError."""
        header = connection.headers.get("authorization")
        if header is not None:
            return self.identify(connection)
        return self.identify_token(connection.query_params.get("token", ""))

    def identify_token(self, token: str) -> Identity | None:
        """Return the identity of a program's or lab's token. Raise SignInEndedError where it has ended."""
        return self._find_bearer(token)

    def identify_certificate(self, common_name: str) -> Identity | None:
        """Return the identity of a program's certificate; its common name is the digest of the program's
        token.

        Raise SignInEndedError where it counts no longer.
        """
        return self._see(self.devices.find_digest(common_name, "program"))

    def refresh(self, identity: Identity | None) -> Identity | None:
        """Return the caller's identity as it is now, perhaps in another role; None where access has ended."""
        if identity is None or identity == SHELL:
            return identity
        device = self.devices.find_valid(identity.device)
        return None if device is None else device.identity

    def explain_change(self, identity: Identity) -> str | None:
        """Return the reason why this is not the caller's identity any more; None while it is."""
        present = self.refresh(identity)
        if present is None:
            return REVOKED
        return None if present == identity else "The role or the name has changed."

    async def pair(
        self, code: str, name: str, known: Identity | None, address: str
    ) -> tuple[Identity, BrowserSecrets | None]:
        """Sign a browser in; return its identity and its new secrets, None if it is `known` and has them.

        A known browser keeps its name, and its role unless the code's role is higher.
        Raise WrongCodeError, TooManyTriesError, RefusedError, StoreError.
        """
        with self._reporting_wrong_codes(address):
            role = self.codes.use(code, address)
        if known is not None and known.kind == "browser":
            if role == "operator" and known.role == "viewer":
                await self.set_role(known.device, role, by=known)
                self.confirmations.confirm(known.device)
            return self.devices.get(known.device).identity, None
        device, secrets = await self.devices.add_browser(name, role)
        self.confirmations.confirm(device.id)
        self._notify("access", "info", f"“{name}” was paired as {role}.")
        return device.identity, secrets

    def confirm(self, code: str, identity: Identity, address: str) -> None:
        """Confirm the user of this browser, for dangerous acts within the next ten minutes.

        Raise WrongConfirmationError, TooManyTriesError.
        """
        with self._reporting_wrong_codes(address):
            self.codes.confirm(code, identity.device, address)
        self.confirmations.confirm(identity.device)

    async def make_program(
        self, name: str, scope: Scope, days: int | None, by: Identity
    ) -> tuple[Device, str]:
        """Add a program; return its device and token, which ends after `days` (None: never).

        Raise RefusedError, StoreError.
        """
        device, token = await self.devices.add_program(name, scope, days)
        self._notify("access", "info", f"“{by.name}” made a token for “{name}”, with the scope {scope}.")
        return device, token

    async def make_lab(self, name: str, by: Identity) -> tuple[Device, str]:
        """Add a lab, which this robot joins; return its device and token, which never ends.

        Raise RefusedError, StoreError.
        """
        device, token = await self.devices.add_lab(name)
        self._notify("access", "info", f"“{by.name}” made a token for “{name}”.")
        return device, token

    async def make_link(self, session: int, ends: float, by: Identity) -> tuple[Device, str]:
        """Add a reading link of a session, until `ends` (s since 1970); return it and its token.

        Raise RefusedError, StoreError.
        """
        device, token = await self.devices.add_link(session, ends)
        self._notify("access", "info", f"“{by.name}” made a reading link for session {session}.")
        return device, token

    def read_link(self, token: str) -> tuple[Device, BrowserSecrets]:
        """Return the reading link of a token, and the secrets of the browsers that it lets in.

        Raise LinkEndedError.
        """
        opened = self.devices.find_link(token)
        if opened is None:
            raise LinkEndedError(NO_LINK)
        device, secrets = opened
        if (reason := self.devices.explain_end(device)) is not None:
            raise LinkEndedError(reason)
        self.devices.see(device)
        return device, secrets

    async def end_link(self, number: int, by: Identity) -> None:
        """End a reading link, also where it is being read. Raise UnknownLinkError, StoreError."""
        link = self.devices.get_link(number)
        await self._remove(link, REVOKED)
        self._notify("access", "info", f"“{by.name}” ended a reading link for session {link.session}.")

    async def set_role(self, number: int, role: Role, by: Identity) -> None:
        """Change a device's role; its live sockets are closed, and open again in the new role.

        Raise UnknownDeviceError, RefusedError, StoreError.
        """
        device = self.devices.get(number)
        if device.kind == "lab":
            raise RefusedError(f"“{device.name}” is a lab: it reads, stops and fetches sessions, no more.")
        if device.role == device.stored_role == role:
            return
        if role == "viewer":
            self._keep_an_operator(device, by)
            self.codes.discard(number)
        try:
            await self.devices.set_role(number, role)
        finally:
            self._close_sockets(number, f"The role is now {device.role}.")
        self._notify("access", "info", f"“{by.name}” made “{device.name}” {_with_article(role)}.")

    async def revoke(self, number: int, by: Identity) -> None:
        """Revoke a device, also on its live sockets.

        Raise UnknownDeviceError, RefusedError, StoreError.
        """
        device = self.devices.get(number)
        self._keep_an_operator(device, by)
        await self._remove(device, REVOKED)
        self._notify("access", "caution", f"“{by.name}” revoked the access of “{device.name}”.")

    async def sign_out(self, identity: Identity) -> None:
        """Sign the caller out, even the last operator.

        Raise RefusedError for the shell, StoreError.
        """
        if identity == SHELL:
            raise RefusedError("The shell of this computer is not signed in, and needs not sign out.")
        await self._remove(self.devices.get(identity.device), "Signed out.")
        self._notify("access", "info", f"“{identity.name}” signed out.")

    def _write_token(self) -> None:
        text = f"{self._token}\n".encode()
        try:
            write_whole(self._token_file, text, 0o600)
        except OSError:
            # A full disk takes no second file, but as many bytes in the place of those that are there.
            with self._token_file.open("r+b") as file:
                file.write(text)

    @contextmanager
    def _reporting_wrong_codes(self, address: str) -> Iterator[None]:
        try:
            yield
        except WrongCodeError:
            if self.codes.many_wrong and not self._limit_reported:
                self._notify("access", "caution", f"Somebody at {address} tries pairing codes.")
                self._limit_reported = True
            raise
        self._limit_reported = False

    async def _remove(self, device: Device, reason: str) -> None:
        self.codes.discard(device.id)
        try:
            await self.devices.remove(device.id)
        finally:
            self._close_sockets(device.id, reason)

    def _keep_an_operator(self, device: Device, by: Identity) -> None:
        if by != SHELL and self.devices.operators == [device]:
            raise RefusedError(
                f"“{device.name}” is the only operator. Make somebody else one first; "
                "or use `mucat access` on the robot's computer, which always may."
            )

    def _find_bearer(self, token: str) -> Identity | None:
        if compare_digest(digest(token), digest(self._token)):
            return SHELL
        return self._see(self.devices.find(token, "program", "lab"))

    def _see(self, device: Device | None) -> Identity | None:
        if device is None:
            return None
        if (reason := self.devices.explain_end(device)) is not None:
            raise SignInEndedError(reason)
        self.devices.see(device)
        return device.identity


def _page_secret(connection: HTTPConnection) -> str:
    """Return the secret that a page shows: in a header, or as the second subprotocol of its socket."""
    if connection.scope["type"] == "http":
        return connection.headers.get(PAGE_HEADER, "")
    match connection.scope["subprotocols"]:
        case [protocol, secret] if protocol == PAGE_PROTOCOL:
            return str(secret)
    return ""


def _with_article(role: Role) -> str:
    return "an operator" if role == "operator" else "a viewer"
