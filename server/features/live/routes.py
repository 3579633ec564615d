"""The live socket of a page."""

from collections.abc import Awaitable, Callable
from time import time
from typing import Annotated, Any

from fastapi import Depends, WebSocket, WebSocketDisconnect

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import DEFINITIONS_HASH
from server.driving.arbiter import ControlArbiter
from server.driving.clients import ControlClient
from server.feature import list_features
from server.features.live.connection import LiveConnection
from server.http.audit import AuditLog
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.page import Page
from server.http.security import POLICY_VIOLATION
from server.http.sign_in.access import PAGE_PROTOCOL, Access
from server.http.sign_in.identity import Caller
from server.http.websocket_protocol import BINARY
from server.platform.settings import Settings
from server.stream.bridge import Bridge
from server.stream.budget import Budgets
from server.stream.hub import EvictedError, Hub, Offer, Send
from server.stream.socket_ends import close_with_reason, end_after

ABNORMAL_CLOSURE = 1006
"""The code of a connection that ended without a closing frame (RFC 6455, 7.4.1)."""
router = Operations()


Greeting = Callable[[ControlClient], dict[str, Any]]
"""Makes the first message to a page."""


async def greet(settings: Provided[Settings], clock: Provided[Clock], page: Provided[Page]) -> Greeting:
    """Return the greeting of this server."""
    features = [feature.name for feature in list_features().values() if settings.has(feature)]
    return lambda owner: {
        "op": "hello",
        "definitions": f"{DEFINITIONS_HASH:08x}",
        "robot": settings.robot.name,
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

    send, offer = _senders(socket)
    try:
        # Access may have been revoked while the socket opened; from here on the hub dismisses it.
        if (changed := access.explain_change(caller)) is not None:
            raise EvictedError(changed, POLICY_VIOLATION)
        with arbiter.page(caller) as owner:
            budget = budgets.of(caller)
            listen = LiveConnection(socket, owner, hub, arbiter, bridge, audit, clock, budget).listen
            serving = hub.serve(send, offer, greeting(owner), listen, caller)
            await end_after(access.devices.count_seconds(caller.device), serving)
    except WebSocketDisconnect:
        return
    except EvictedError as reason:
        await close_with_reason(socket, reason)


def _senders(socket: WebSocket) -> tuple[Send, Offer]:
    """Return the functions that send messages, past the application's layers where possible."""
    extension = socket.scope.get("extensions", {}).get(BINARY)
    send_binary: Callable[[bytes], Awaitable[None]] = extension["send"] if extension else socket.send_bytes
    offer: Offer = extension["offer"] if extension else lambda _: False

    async def send(data: bytes | str) -> None:
        if isinstance(data, str):
            await socket.send_text(data)
            return
        try:
            await send_binary(data)
        except OSError as problem:
            raise WebSocketDisconnect(ABNORMAL_CLOSURE) from problem

    return send, offer
