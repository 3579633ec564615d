"""The page's one WebSocket: blocks and news to the page, pings and STOP from it."""

import asyncio
import json
from time import time
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import ValidationError

from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.transport.zenoh_transport import Refused
from server.container import Assembly
from server.features.lease.clients import Seat
from server.features.lease.driving import Drive
from server.http.sign_in.authorization import may_say
from server.http.sign_in.identity import Identity
from server.http.sign_in.policy import MESSAGES
from server.stream.bridge import RuntimeSilent
from server.stream.hub import POLICY_VIOLATION, Client, Evicted

NONSENSE_MAX = 20
"""Messages that are not understood, one after the other, before the socket is closed."""
FAREWELL_SECONDS = 1.0
WATCHABLE = frozenset({"picture", "observer", "mask", "balanced"})
"""Topics of pictures that a page can have."""

router = APIRouter()


class Nonsense(ValueError):  # noqa: N818 - it says what happened
    """A message from the page that is not understood; the text says why."""


class _Conversation:
    """What one page says, and what is done about it."""

    def __init__(self, assembly: Assembly, socket: WebSocket, seat: Seat) -> None:
        self._assembly = assembly
        self._seat = seat
        self._socket = socket
        self._stopping: asyncio.Task[None] | None = None
        self._stop_again = False

    async def listen(self, client: Client) -> None:
        """Take in messages until the page leaves. Raises Evicted where it talks nothing but nonsense."""
        nonsense = 0
        while True:
            try:
                message = await self._socket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                self._obey(client, _read(message.get("text")))
                nonsense = 0
            except Nonsense as problem:
                nonsense += 1
                if nonsense >= NONSENSE_MAX:
                    raise Evicted(
                        f"{nonsense} messages in a row were not understood.", POLICY_VIOLATION
                    ) from problem
                client.answer({"op": "error", "text": str(problem)})

    def _obey(self, client: Client, message: dict[str, Any]) -> None:
        op = message.get("op")
        if not isinstance(op, str) or op not in MESSAGES:
            raise Nonsense(f"Unknown op {json.dumps(op)[:80]}; there are {', '.join(MESSAGES)}.")
        reason = may_say(self._seat.identity, op)
        if reason is not None:
            client.answer({"op": "error", "text": reason})
            return
        match op:
            case "ping":
                number = message.get("id")
                if not isinstance(number, int | float | str):
                    raise Nonsense("A ping needs an id, a number or a text.")
                client.answer({"op": "pong", "id": number})
            case "stop":
                self._stop(client)
            case "watch":
                self._assembly.hub.show(client, _topics(message.get("pictures")))
            case "drive":
                self._assembly.desk.drive(self._seat, _drive(message))

    def _stop(self, client: Client) -> None:
        # A STOP on its way is not enough: something may arm the robot after it. So one more follows.
        if self._stopping is not None and not self._stopping.done():
            self._stop_again = True
            return
        self._stopping = asyncio.create_task(self._send_stop(client))

    async def _send_stop(self, client: Client) -> None:
        try:
            await self._assembly.bridge.command("stop", {})
        except (Refused, RuntimeSilent) as problem:
            client.answer({"op": "error", "text": f"STOP has not been confirmed: {problem}"})
        if self._stop_again:
            self._stop_again = False
            await self._send_stop(client)


@router.websocket("/api/live")
async def live(socket: WebSocket) -> None:
    """Serve one page until it leaves."""
    assembly = Assembly.of(socket)
    await socket.accept()

    async def send(data: bytes | str) -> None:
        kind = "bytes" if isinstance(data, bytes) else "text"
        await socket.send({"type": "websocket.send", kind: data})

    identity = Identity.of(socket)
    try:
        # It may have been revoked while the socket opened; from here on the hub knows it.
        if not assembly.access.still(identity):
            raise Evicted("Access was revoked by an operator.", POLICY_VIOLATION)
        with assembly.desk.page(identity) as seat:
            listen = _Conversation(assembly, socket, seat).listen
            await assembly.hub.serve(send, _greeting(assembly, seat), listen, identity.device)
    except WebSocketDisconnect:
        return
    except Evicted as reason:
        # A client that does not read does not take the farewell either; the kernel then ends the connection.
        try:
            async with asyncio.timeout(FAREWELL_SECONDS):
                await socket.close(reason.code, str(reason))
        except (TimeoutError, WebSocketDisconnect, RuntimeError):
            return


def _greeting(assembly: Assembly, seat: Seat) -> dict[str, Any]:
    return {
        "op": "hello",
        "definitions": f"{DEFINITIONS_HASH:08x}",
        "robot": assembly.settings.robot,
        "steady": assembly.clock.now(),
        "utc": time(),
        "page_version": assembly.page.version,
        "you": {"name": seat.identity.name, "role": seat.identity.role, "seat": seat.number},
        "seat_key": seat.key,
    }


def _read(text: str | None) -> dict[str, Any]:
    if text is None:
        raise Nonsense("Messages must be text, not binary.")
    try:
        message = json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as problem:
        raise Nonsense("Messages must be JSON.") from problem
    if not isinstance(message, dict):
        raise Nonsense("Messages must be JSON objects.")
    return message


def _topics(value: object) -> frozenset[str]:
    if not isinstance(value, list) or not all(isinstance(one, str) and one in WATCHABLE for one in value):
        raise Nonsense(f"A watch needs pictures, a list of any of {', '.join(sorted(WATCHABLE))}.")
    return frozenset(value)


def _drive(message: dict[str, Any]) -> Drive:
    try:
        return Drive.model_validate(message)
    except ValidationError as problem:
        raise Nonsense(
            "A drive needs lease and sequence, whole numbers from 0 on, taken (s), and six axes from -1 to 1."
        ) from problem


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is no JSON")
