"""Joining a lab, and leaving it."""

import asyncio
import logging
import time
from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import RefusedError
from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY
from server.features.membership.joined_lab import JoinedLab, read_lab, remove_lab, write_lab
from server.features.membership.lab_link import LabLink
from server.features.membership.presence_source import PresenceSource
from server.http.pinned_requests import (
    PIN_LENGTH,
    OtherServerRefusedError,
    UnreachableError,
    pin_of,
    send,
)
from server.http.sign_in.access import Access
from server.http.sign_in.identity import Identity
from server.http.sign_in.tokens import CODE_LENGTH, normal_code
from server.platform.disk_space import FileWriteError, explain_write_error
from server.platform.errors import InvalidError, UnavailableError
from server.platform.notices import Notices
from server.platform.settings import Settings

log = logging.getLogger(__name__)

JOIN_SECONDS = 20.0
"""The lab makes a certificate meanwhile."""


class WrongJoiningError(InvalidError):
    """The lab's address or the code is not valid"""


class LabUnreachableError(UnavailableError):
    """The lab cannot be reached, or is another one"""


class Membership:
    """The robot's membership in a lab; in one at a time."""

    def __init__(
        self, settings: Settings, access: Access, link: LabLink, source: PresenceSource, notices: Notices
    ) -> None:
        self.lab: JoinedLab | None = None
        self._settings = settings
        self._folder = settings.data.membership
        self._access = access
        self._link = link
        self._source = source
        self._notices = notices
        self._changing = asyncio.Lock()

    async def open(self) -> None:
        """Dial the lab, if the robot has joined one."""
        try:
            self.lab = await asyncio.to_thread(read_lab, self._folder)
            if self.lab is not None:
                await self._link.open(self.lab)
        except (OSError, ConfigError, ValueError, TypeError) as problem:
            # A robot swims also without its lab.
            log.warning("the lab cannot be dialled: %s", problem)
            self._notices.notify("lab", "caution", f"The lab is not connected: {problem}.")

    async def join(self, address: str, code: str, caller: Identity) -> JoinedLab:
        """Join the lab at this address by a code.

        Raise WrongJoiningError, LabUnreachableError, RefusedError, StoreError, FileWriteError.
        """
        address = _check_address(address)
        typed = normal_code(code)
        if len(typed) != CODE_LENGTH + PIN_LENGTH:
            raise WrongJoiningError(
                "This is no code of a lab. It is as long as 7K3PX-Q2M9D-ABCDEFGH-JKLMNPQR; the lab's page "
                "Robots makes one, or `mucat lab pair` on its computer."
            )
        async with self._changing:
            if self.lab is not None:
                raise RefusedError(
                    f"This robot has joined the lab {self.lab.name} already. Leave it first: mucat lab leave."
                )
            host = urlsplit(address).hostname
            device, token = await self._access.make_lab(f"Lab {host}", caller)
            try:
                answer = await asyncio.to_thread(self._ask_lab, address, typed, token)
                lab = JoinedLab(
                    name=str(answer["lab"]),
                    robot=self._settings.robot.name,
                    address=address,
                    router=_router_endpoint(address, int(answer["router_port"])),
                    device=device.id,
                    joined=time.time(),
                )
                files = {AUTHORITY: "authority", CERTIFICATE: "certificate", KEY: "key"}
                texts = {file: str(answer[field]) for file, field in files.items()}
                await self._change_folder(write_lab, self._folder, lab, texts)
            except BaseException:
                await self._access.revoke(device.id, caller)
                raise
            self.lab = lab
            await self._link.open(lab)
        self._notices.notify("lab", "info", f"“{caller.name}” made the robot join the lab {lab.name}.")
        return lab

    async def leave(self, caller: Identity) -> bool:
        """Leave the lab; return True if the lab could be notified.

        Raise RefusedError, StoreError, FileWriteError.
        """
        async with self._changing:
            lab = self.lab
            if lab is None:
                raise RefusedError("This robot has joined no lab.")
            notified = self._link.connected
            await self._link.close(leave=True)
            await self._change_folder(remove_lab, self._folder)
            self.lab = None
            if any(device.id == lab.device for device in self._access.devices.all()):
                await self._access.revoke(lab.device, caller)
        self._notices.notify("lab", "info", f"“{caller.name}” made the robot leave the lab {lab.name}.")
        return notified

    async def _change_folder(self, change: Callable[..., None], *arguments: object) -> None:
        try:
            await asyncio.to_thread(change, *arguments)
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, self._folder)) from problem

    def _ask_lab(self, address: str, typed: str, token: str) -> dict[str, Any]:
        body = {
            "code": typed[:CODE_LENGTH],
            "name": self._settings.robot.name,
            "address": self._source.address_for(address),
            "fingerprint": self._source.fingerprint,
            "token": token,
        }
        pin = typed[CODE_LENGTH:]
        try:
            answer: dict[str, Any] = send(
                address,
                "POST",
                "/robots/join",
                is_meant=lambda fingerprint: pin_of(fingerprint) == pin,
                body=body,
                seconds=JOIN_SECONDS,
            )
        except UnreachableError as problem:
            raise LabUnreachableError(str(problem)) from problem
        except OtherServerRefusedError as problem:
            raise RefusedError(f"The lab refused: {problem}") from problem
        return answer


def _check_address(address: str) -> str:
    """Return a lab's address without what follows its port. Raise WrongJoiningError."""
    try:
        parts = urlsplit(address.strip())
        usable = parts.scheme == "https" and bool(parts.hostname) and parts.port != 0
    except ValueError:
        usable = False
    if not usable or "@" in parts.netloc:
        raise WrongJoiningError(f"{address!r} is no address of a lab; it is like https://lab.local:8000.")
    return f"https://{parts.netloc}"


def _router_endpoint(address: str, port: int) -> str:
    host = urlsplit(address).hostname or ""
    return f"tls/{f'[{host}]' if ':' in host else host}:{port}"
