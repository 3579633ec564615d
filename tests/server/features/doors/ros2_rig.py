"""A server whose door for ROS 2 is open, and programs of ROS 2 that use zenoh-ros2-sdk, unmodified."""

import asyncio
import json
import os
import queue
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

import zenoh
from zenoh_ros2_sdk import ROS2Publisher, ROS2ServiceClient, ROS2Subscriber, ZenohSession, message_registry
from zenoh_ros2_sdk.utils import compute_service_type_hash

from server.features.doors.config import DoorsConfig
from server.features.doors.house import Doors
from server.features.doors.ros2_door import Ros2Door
from server.features.doors.ros2_messages import TRIGGER, ros2_types
from server.http.sign_in.tokens import digest
from server.platform.authority import Authority
from server.platform.settings import Settings
from tests.server.features.doors.rig import make_token
from tests.server.serving import Served
from tests.server.waiting import SECONDS

OPEN = DoorsConfig(rosbridge=True, ros2=True, ros2_listen="tls/127.0.0.1:0")
PLACEHOLDER = "uint8 structure_needs_at_least_one_member"
TRIGGER_DEFINITIONS = PLACEHOLDER, "bool success\nstring message"


def with_ros2(settings: Settings, doors: DoorsConfig = OPEN) -> Settings:
    """Return these settings with the doors for ROS 2 and rosbridge open, and their authority."""
    settings = settings.with_section(doors)
    Authority(settings).prepare()
    return settings


async def issue(served: Served, scope: str = "operate", name: str = "Lab") -> Path:
    """Return the folder of a new certificate for a program with this scope."""
    token = await make_token(served, scope, name)
    folder = served.settings.data.path.parent / name
    await asyncio.to_thread(Authority(served.settings).issue_program, digest(token), folder)
    return folder


def tls_settings(served: Served, folder: Path) -> dict[str, Any]:
    """Zenoh's settings for a connection to the door with the certificate in this folder."""
    host, port = served.get(Ros2Door).address
    tls = {
        "root_ca_certificate": str(folder / "authority.pem"),
        "connect_certificate": str(folder / "certificate.pem"),
        "connect_private_key": str(folder / "key.pem"),
        "enable_mtls": True,
        "verify_name_on_connect": False,
    }
    return {"connect/endpoints": [f"tls/{host}:{port}"], "transport/link/tls": tls}


def open_zenoh(values: dict[str, Any]) -> zenoh.Session:
    """Return a plain session of Zenoh with these settings."""
    config = zenoh.Config()
    defaults = {"scouting/multicast/enabled": False, "timestamping/enabled": True}
    for key, value in (defaults | values).items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


@contextmanager
def overriding(values: dict[str, Any] | str) -> Iterator[None]:
    """rmw_zenoh's own way of changing a session's settings."""
    if not isinstance(values, str):
        values = ";".join(f"{key}={json.dumps(value)}" for key, value in values.items())
    os.environ["ZENOH_CONFIG_OVERRIDE"] = values
    try:
        yield
    finally:
        del os.environ["ZENOH_CONFIG_OVERRIDE"]


class Ros2Peer:
    """A program of ROS 2, in one session."""

    def __init__(self, messages: Path, domain: int) -> None:
        self.received: queue.Queue[tuple[str, Any]] = queue.Queue()
        self._messages = messages
        self._domain = domain
        self._open: list[Any] = []

    def subscribe(self, topic: str, kind: str, qos: str | None = None) -> None:
        """Subscribe; the type's definition is that of `messages`, and its hash computed by the peer."""
        self._define(kind)
        receive = lambda message: self.received.put((topic, message))  # noqa: E731
        self._open.append(ROS2Subscriber(topic, kind, receive, domain_id=self._domain, qos=qos))

    def publisher(self, topic: str, kind: str) -> ROS2Publisher:
        """Return a publisher of a topic that the robot subscribes to."""
        self._define(kind)
        publisher = ROS2Publisher(topic, kind, domain_id=self._domain)
        self._open.append(publisher)
        await_match(publisher.pub)
        return publisher

    def call(self, service: str) -> tuple[bool, str]:
        """Call a Trigger; its success and message."""
        request, response = TRIGGER_DEFINITIONS
        client = ROS2ServiceClient(
            service,
            TRIGGER,
            request_definition=request,
            response_definition=response,
            type_hash=compute_service_type_hash(TRIGGER, request, response),
            domain_id=self._domain,
            timeout=SECONDS,
        )
        try:
            await_match(client.querier)
            answer = client.call(structure_needs_at_least_one_member=0)
        finally:
            client.close()
        assert answer is not None, f"{service} was not answered"
        return answer.success, answer.message

    async def next(self, topic: str) -> Any:
        """Return the next message of a topic; others are passed over."""
        while True:
            result, message = await asyncio.to_thread(self.received.get, timeout=SECONDS)
            if result == topic:
                return message

    def type(self, kind: str) -> Any:
        """Return the class of a type that was defined."""
        return ZenohSession.get_instance().store.types[kind]

    def tokens(self, pattern: str) -> list[str]:
        """Return the liveliness tokens there are."""
        replies = ZenohSession.get_instance().liveliness.get(pattern)
        return [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]

    def close(self) -> None:
        """End all of it."""
        for opened in reversed(self._open):
            opened.close()
        ZenohSession.get_instance().close()

    def _define(self, kind: str) -> None:
        """Put the definition of a type, and of those in it, where the peer looks for it."""
        write_definitions(kind, self._messages)


def await_match(declared: "zenoh.Publisher | zenoh.Querier") -> None:
    """Wait until the robot is known as the other end, as ROS 2 waits for a service."""
    end = time.monotonic() + SECONDS
    # Zenoh's stub calls this a bool; it is a MatchingStatus.
    status: Callable[[], Any] = lambda: declared.matching_status  # noqa: E731
    while not status().matching:
        assert time.monotonic() < end, f"nobody is at {declared.key_expr}"
        time.sleep(0.005)


def write_definitions(kind: str, folder: Path) -> None:
    """Write the .msg files of a type and of those in it."""
    parts: dict[str, tuple[str, str]] = {}
    store = ros2_types()._store
    parts[kind] = store.gendefhash(kind, parts, ros_version=2)
    for name, (text, _) in parts.items():
        path = folder / f"{name}.msg"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def start_peer(messages: Path, values: dict[str, Any] | str, domain: int = 0) -> Ros2Peer:
    """Return a program with these settings of its session; definitions of types go into `messages`."""
    message_registry._registry = None
    message_registry.get_registry(str(messages))
    with overriding(values):
        ZenohSession.get_instance()
    return Ros2Peer(messages, domain)


@asynccontextmanager
async def ros2_peer(served: Served, values: dict[str, Any] | str, domain: int = 0) -> AsyncIterator[Ros2Peer]:
    """A program beside a server that runs in this event loop."""
    messages = served.settings.data.path.parent / "messages"
    peer = await asyncio.to_thread(start_peer, messages, values, domain)
    try:
        yield peer
    finally:
        await asyncio.to_thread(peer.close)


async def doors_of(served: Served) -> Sequence[dict[str, Any]]:
    """Return the programs at the door, as System lists them."""
    (answer,) = (door for door in (await served.api.get("/doors")).json() if door["name"] == "ros2")
    clients: list[dict[str, Any]] = answer["clients"]
    return clients


def subscribed(served: Served) -> set[str]:
    """Return the topics that programs at the door subscribe to."""
    return {
        subscription.channel.name
        for client in served.get(Doors).doors["ros2"].clients
        for subscription in client.subscriptions.values()
    }


def refused(served: Served) -> int:
    """Messages and calls at the door that were refused."""
    return sum(client.refused for client in served.get(Doors).doors["ros2"].clients)
