"""The live socket of a page: blocks and notices to the page; pings, stick commands and STOP from it."""

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from math import isfinite
from time import time
from typing import Annotated, Any

from fastapi import Depends, Query, WebSocket, WebSocketDisconnect
from fastapi.responses import Response, StreamingResponse
from pydantic import StringConstraints, ValidationError

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.contract.text_input import TextError, read_json
from robot_runtime.contract.topics import TOPICS, Kind
from robot_runtime.errors import RefusedError
from server.feature import list_features
from server.features.lease.arbiter import ControlArbiter
from server.features.lease.clients import ControlClient
from server.features.lease.driving import DriveCommand
from server.http.audit import AuditLog, address_of
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.page import Page
from server.http.security import POLICY_VIOLATION
from server.http.sign_in.access import PAGE_PROTOCOL, Access
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import MESSAGES, Need, may_say
from server.http.websocket_protocol import BINARY
from server.platform.audit_file import Outcome
from server.platform.settings import Settings
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.budget import Budgets, DeviceBudget
from server.stream.hub import Client, EvictedError, Hub, Send
from server.stream.socket_ends import close_with_reason, end_after

ABNORMAL_CLOSURE = 1006
"""The code of a connection that ended without a closing frame (RFC 6455, 7.4.1)."""
INVALID_MAX = 20
"""Invalid messages in a row after which the socket is closed."""
PIECE_BYTES = 65_536
WATCHABLE = frozenset({"picture", "observer", "mask", "balanced"})
"""Topics of pictures that a page can watch."""

router = Operations()

_ROWS = "|".join(topic.name for topic in TOPICS if topic.kind is Kind.ROWS)
RowTopic = Annotated[str, StringConstraints(pattern=f"^({_ROWS})$")]


class InvalidMessageError(ValueError):
    """An invalid message from the page; the text says why."""


class _LiveConnection:
    """Reads one page's messages and acts on them."""

    def __init__(
        self,
        socket: WebSocket,
        owner: ControlClient,
        hub: Hub,
        arbiter: ControlArbiter,
        bridge: Bridge,
        audit: AuditLog,
        clock: Clock,
        budget: DeviceBudget,
    ) -> None:
        self._socket = socket
        self._owner = owner
        self._hub = hub
        self._arbiter = arbiter
        self._bridge = bridge
        self._audit = audit
        self._clock = clock
        self._budget = budget
        self._stopping: asyncio.Task[None] | None = None
        self._stop_again = False

    async def listen(self, client: Client) -> None:
        """Take in messages until the page leaves. Raises EvictedError where it talks nothing but invalid."""
        invalid = 0
        while True:
            try:
                message = await self._socket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                self._perform(client, _read(message.get("text")))
                invalid = 0
            except InvalidMessageError as problem:
                invalid += 1
                if invalid >= INVALID_MAX:
                    raise EvictedError(
                        f"{invalid} messages in a row were not valid.", POLICY_VIOLATION
                    ) from problem
                client.answer({"op": "error", "text": str(problem)})
            await self._budget.wait_to_receive()

    def _perform(self, client: Client, message: dict[str, Any]) -> None:
        op = message.get("op")
        if not isinstance(op, str) or op not in MESSAGES:
            raise InvalidMessageError(f"Unknown op {json.dumps(op)[:80]}; there are {', '.join(MESSAGES)}.")
        reason = may_say(self._owner.identity, op)
        if reason is not None:
            client.answer({"op": "error", "text": reason})
            self._record(op, "refused")
            return
        match op:
            case "ping":
                number = message.get("id")
                if isinstance(number, bool) or not isinstance(number, int | float | str):
                    raise InvalidMessageError("A ping needs an id, a number or a text.")
                if isinstance(number, float) and not isfinite(number):
                    raise InvalidMessageError(
                        "A ping's id is a number that JSON can write; this one is too large."
                    )
                # With both clocks: the wall clock may be set while the page is open.
                client.answer({"op": "pong", "id": number, "steady": self._clock.now(), "utc": time()})
            case "stop":
                self._stop(client)
            case "watch":
                self._hub.show(client, _topics(message.get("pictures")))
            case "drive":
                self._arbiter.drive(self._owner, _drive(message))

    def _stop(self, client: Client) -> None:
        # A STOP on its way is not enough: the robot may be armed after it. So another one follows.
        if self._stopping is not None and not self._stopping.done():
            self._stop_again = True
            return
        self._stopping = asyncio.create_task(self._send_stops(client))

    async def _send_stops(self, client: Client) -> None:
        self._stop_again = True
        while self._stop_again:
            self._stop_again = False
            try:
                await self._bridge.command("stop", {})
                self._record("stop", "done", "stopRobot")
            except (RefusedError, RuntimeSilentError) as problem:
                self._record("stop", "failed")
                client.answer({"op": "error", "text": f"STOP has not been confirmed: {problem}"})

    def _record(self, op: str, outcome: Outcome, operation: str = "") -> None:
        address = address_of(self._socket.scope)
        action = "STOP" if op == "stop" else f"Message {op}"
        self._audit.record(self._owner.identity, address, action, "/api/live", outcome, operation)


Greeting = Callable[[ControlClient], dict[str, Any]]
"""Makes the first message to a page."""


async def greet(settings: Provided[Settings], clock: Provided[Clock], page: Provided[Page]) -> Greeting:
    """The greeting of this server."""
    features = [one.name for one in list_features().values() if settings.has(one)]
    return lambda owner: {
        "op": "hello",
        "definitions": f"{DEFINITIONS_HASH:08x}",
        "robot": settings.robot,
        "steady": clock.now(),
        "utc": time(),
        "page_version": page.version,
        "features": features,
        "you": {"name": owner.identity.name, "role": owner.identity.role, "client": owner.number},
        "client_key": owner.key,
    }


@router.socket("/api/live")
async def live(
    socket: WebSocket,
    caller: Caller,
    access: Provided[Access],
    hub: Provided[Hub],
    arbiter: Provided[ControlArbiter],
    bridge: Provided[Bridge],
    audit: Provided[AuditLog],
    clock: Provided[Clock],
    budgets: Provided[Budgets],
    greeting: Annotated[Greeting, Depends(greet)],
) -> None:
    """Serve one page until it leaves."""
    offered = PAGE_PROTOCOL in socket.scope["subprotocols"]
    await socket.accept(subprotocol=PAGE_PROTOCOL if offered else None)

    send = _sender(socket)
    try:
        # Access may have been revoked while the socket opened; from here on the hub dismisses it.
        if (changed := access.explain_change(caller)) is not None:
            raise EvictedError(changed, POLICY_VIOLATION)
        with arbiter.page(caller) as owner:
            budget = budgets.of(caller)
            listen = _LiveConnection(socket, owner, hub, arbiter, bridge, audit, clock, budget).listen
            serving = hub.serve(send, greeting(owner), listen, caller)
            await end_after(access.devices.count_seconds(caller.device), serving)
    except WebSocketDisconnect:
        return
    except EvictedError as reason:
        await close_with_reason(socket, reason)


def _sender(socket: WebSocket) -> Send:
    """Sends binary messages past the application's layers, where the server's protocol offers it."""
    extension = socket.scope.get("extensions", {}).get(BINARY)
    send_binary: Callable[[bytes], Awaitable[None]] = extension["send"] if extension else socket.send_bytes

    async def send(data: bytes | str) -> None:
        if isinstance(data, str):
            await socket.send_text(data)
            return
        try:
            await send_binary(data)
        except OSError as problem:
            raise WebSocketDisconnect(ABNORMAL_CLOSURE) from problem

    return send


@router.operation("GET /api/past", Need.VIEWER, media_type="application/octet-stream", tags=["live"])
async def get_past(
    hub: Provided[Hub],
    topic: Annotated[list[RowTopic], Query(min_length=1, description="of rows; may be given several times")],
    until: Annotated[
        float, Query(allow_inf_nan=False, description="s, steady clock; a little more may come")
    ],
) -> Response:
    """Return rows of the last ten minutes.

    All rows of these topics up to `until`, topic by topic, oldest first, as blocks.
    """
    rows = hub.history.rows(topic, until)
    headers = {"Cache-Control": "no-store", "Content-Length": str(sum(map(len, rows)))}
    return StreamingResponse(_gather(rows), media_type="application/octet-stream", headers=headers)


async def _gather(chunks: list[bytes]) -> AsyncIterator[bytes]:
    """The chunks in pieces of about `PIECE_BYTES`; the next one is made when the client has read the last."""
    first = size = 0
    for place, chunk in enumerate(chunks):
        size += len(chunk)
        if size >= PIECE_BYTES or place == len(chunks) - 1:
            yield b"".join(chunks[first : place + 1])
            first, size = place + 1, 0


def _read(text: str | None) -> dict[str, Any]:
    if text is None:
        raise InvalidMessageError("Messages must be text, not binary.")
    try:
        message = read_json(text)
    except TextError as problem:
        raise InvalidMessageError(f"Messages must be JSON: this one {problem}.") from problem
    if not isinstance(message, dict):
        raise InvalidMessageError("Messages must be JSON objects.")
    return message


def _topics(value: object) -> frozenset[str]:
    if not isinstance(value, list) or not all(isinstance(one, str) and one in WATCHABLE for one in value):
        raise InvalidMessageError(f"A watch needs pictures, a list of any of {', '.join(sorted(WATCHABLE))}.")
    return frozenset(value)


def _drive(message: dict[str, Any]) -> DriveCommand:
    try:
        return DriveCommand.model_validate(message)
    except ValidationError as problem:
        raise InvalidMessageError(
            "A drive needs lease and sequence, whole numbers from 0 on, taken (s), and six axes from -1 to 1."
        ) from problem
