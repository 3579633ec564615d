"""One connection of a program to a door, from its sign-in to its end."""

import asyncio
from typing import Any, Literal

from fastapi import WebSocket, WebSocketDisconnect

from robot_runtime.clock import Clock
from server.driving.arbiter import ControlArbiter
from server.driving.checked_commands import CheckedCommands
from server.features.doors.commands import DoorCommands, DoorPilot
from server.features.doors.foxglove import SUBPROTOCOLS, FoxgloveSession
from server.features.doors.house import Doors
from server.features.doors.rosbridge import RosbridgeSession, read_operation
from server.features.doors.session import UnusableMessageError
from server.features.doors.subscriptions import DoorClient
from server.http.audit import AuditLog, address_of
from server.http.dependencies import find_service
from server.http.security import POLICY_VIOLATION
from server.http.sign_in.access import Access
from server.http.sign_in.devices import SignInEndedError
from server.http.sign_in.identity import IDENTITY, SIGN_IN_ENDED, Identity
from server.stream.bridge import Bridge
from server.stream.hub import EvictedError
from server.stream.socket_ends import close_with_reason, end_after

SIGN_IN_SECONDS = 5.0
"""A program that shows no token in its address sends it first of all, within this time."""
STRANGERS_MAX = 10
"""Connections that have shown no token yet."""
NO_TOKEN = (
    "Sign in: add ?token= with a token of `mucat access token` to the address, or send it first "
    "(op “auth”, mac)."
)


class DoorVisit:
    """One connection of a program."""

    def __init__(self, socket: WebSocket, name: Literal["rosbridge", "foxglove"]) -> None:
        self._socket = socket
        self._doors = find_service(socket, Doors)
        self._door = self._doors.doors[name]
        self._access = find_service(socket, Access)
        self._arbiter = find_service(socket, ControlArbiter)
        self._audit = find_service(socket, AuditLog)
        self._address = address_of(socket.scope)
        self._commands = DoorCommands(
            f"/{name}",
            find_service(socket, Clock),  # type: ignore[type-abstract]
            self._access,
            find_service(socket, CheckedCommands),
            find_service(socket, Bridge),
            self._arbiter,
            self._audit,
        )

    async def serve(self, subprotocol: str | None) -> None:
        """Accept the connection, and serve it until its end."""
        await self._socket.accept(subprotocol=subprotocol)
        try:
            if self._door.name == "foxglove" and subprotocol is None:
                raise EvictedError(f"Offer a subprotocol: {' or '.join(SUBPROTOCOLS)}.", POLICY_VIOLATION)
            caller = self._socket.scope.get(IDENTITY) or await self._sign_in()
            # Access may have been revoked while the socket opened; from here on the door dismisses it.
            if (changed := self._access.explain_change(caller)) is not None:
                raise EvictedError(changed, POLICY_VIOLATION)
            self._audit.record(caller, self._address, "Open a door", f"/{self._door.name}", "done")
            with self._arbiter.page(caller) as owner:
                pilot = DoorPilot(owner, self._address)
                serving = self._doors.serve(
                    self._door, self._send, caller, self._address, lambda client: self._listen(client, pilot)
                )
                await end_after(self._access.devices.count_seconds(caller.device), serving)
        except WebSocketDisconnect:
            return
        except EvictedError as reason:
            await close_with_reason(self._socket, reason)

    async def _listen(self, client: DoorClient, pilot: DoorPilot) -> None:
        client.owner = pilot.owner.number
        kind = RosbridgeSession if self._door.name == "rosbridge" else FoxgloveSession
        await kind(client, pilot, self._doors, self._door, self._commands).run(self._receive)

    async def _sign_in(self) -> Identity:
        """Return the identity by the first message. Raise EvictedError."""
        ended = self._socket.scope.get(SIGN_IN_ENDED)
        if ended is None and self._door.name == "rosbridge" and self._door.strangers < STRANGERS_MAX:
            self._door.strangers += 1
            try:
                async with asyncio.timeout(SIGN_IN_SECONDS):
                    return self._identify(await self._receive())
            except TimeoutError:
                ended = None
            finally:
                self._door.strangers -= 1
        raise self._refused(ended or NO_TOKEN)

    def _identify(self, message: str | bytes | None) -> Identity:
        if message is None:
            raise WebSocketDisconnect
        try:
            request = read_operation(message)
            token = request.get("mac") if request.get("op") == "auth" else None
            identity = self._access.identify_token(token) if isinstance(token, str) else None
        except (UnusableMessageError, SignInEndedError) as problem:
            raise self._refused(str(problem)) from problem
        if identity is None:
            raise self._refused(NO_TOKEN)
        return identity

    def _refused(self, why: str) -> EvictedError:
        self._audit.record(None, self._address, "Open a door", f"/{self._door.name}", "refused")
        return EvictedError(why[:120], POLICY_VIOLATION)

    async def _receive(self) -> str | bytes | None:
        """Return the next message; None where the program has left."""
        message = await self._socket.receive()
        if message["type"] == "websocket.disconnect":
            return None
        text: str | None = message.get("text")
        data: bytes = message.get("bytes") or b""
        return data if text is None else text

    async def _send(self, data: bytes | str) -> None:
        message: dict[str, Any] = {"type": "websocket.send"}
        message["bytes" if isinstance(data, bytes) else "text"] = data
        await self._socket.send(message)
