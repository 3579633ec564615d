"""The messages of a page on its live socket: pings, stick commands, watched pictures and STOP."""

import asyncio
import json
from math import isfinite
from time import time
from typing import Any

from fastapi import WebSocket
from pydantic import ValidationError

from robot_runtime.clock import Clock
from robot_runtime.contract.text_input import TextError, read_json
from robot_runtime.contract.topics import WATCHABLE, AnyTopic
from robot_runtime.errors import RefusedError
from server.driving.arbiter import ControlArbiter
from server.driving.clients import ControlClient
from server.driving.drive_filter import DriveCommand
from server.http.audit import AuditLog, address_of
from server.http.security import POLICY_VIOLATION
from server.http.sign_in.policy import MESSAGES, may_say
from server.platform.audit_file import Outcome
from server.stream.bridge import Bridge, RuntimeSilentError
from server.stream.budget import DeviceBudget
from server.stream.hub import Client, EvictedError, Hub

INVALID_MAX = 20
"""Invalid messages in a row after which the socket is closed."""


class InvalidMessageError(ValueError):
    """An invalid message from the page; the text says why."""


class LiveConnection:
    """One page's connection, which acts on its messages."""

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
        """Act on messages until the page leaves. Raise EvictedError where it sends only invalid ones."""
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
                await self._bridge.stop()
                self._record("stop", "done", "stopRobot")
            except (RefusedError, RuntimeSilentError) as problem:
                self._record("stop", "failed")
                client.answer({"op": "error", "text": f"STOP has not been confirmed: {problem}"})

    def _record(self, op: str, outcome: Outcome, operation: str = "") -> None:
        address = address_of(self._socket.scope)
        action = "STOP" if op == "stop" else f"Message {op}"
        self._audit.record(self._owner.identity, address, action, "/api/live", outcome, operation)


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


def _topics(value: object) -> frozenset[AnyTopic]:
    if not isinstance(value, list) or not all(isinstance(name, str) and name in WATCHABLE for name in value):
        raise InvalidMessageError(f"A watch needs pictures, a list of any of {', '.join(sorted(WATCHABLE))}.")
    return frozenset(WATCHABLE[name] for name in value)


def _drive(message: dict[str, Any]) -> DriveCommand:
    try:
        return DriveCommand.model_validate(message)
    except ValidationError as problem:
        raise InvalidMessageError(
            "A drive needs lease and sequence, whole numbers from 0 on, taken (s), and six axes from -1 to 1."
        ) from problem
