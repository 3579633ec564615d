"""The robot as a node of ROS 2, in a Zenoh session of one connected program's own."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import zenoh
from zenoh.ext import CacheConfig, declare_advanced_publisher

from robot_runtime.transport.zenoh_transport import describe_problem
from server.features.doors.ros2_messages import PAYLOAD_MAX
from server.features.doors.ros2_names import Attachment, Endpoint, Ros2Names, gid_of

MESSAGE_MAX = 65_536
"""Bytes of a message that Zenoh puts together from fragments."""
SETTINGS: Mapping[str, Any] = {
    # rmw_zenoh looks for a router, and a router of ROS 2 joins one.
    "mode": "router",
    "connect/endpoints": [],
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "transport/link/protocols": ["unixsock-stream"],
    "transport/unicast/max_sessions": 1,
    "transport/link/rx/max_message_size": MESSAGE_MAX,
    # A burst of pictures and samples fits; the door waits with the next message where the program is slow.
    "transport/link/tx/queue/size/data": 16,
    "transport/shared_memory/enabled": False,
    "timestamping/enabled": True,  # the cache of a latched topic needs it
    "adminspace/enabled": False,
}


@dataclass(frozen=True, slots=True)
class Incoming:
    """A message or, with a `query`, a call. `typed` is false where it came with another type.

    `payload` is None where it is too large.
    """

    endpoint: Endpoint
    typed: bool
    payload: bytes | None
    attachment: bytes
    query: "zenoh.Query | None" = None


class Ros2Node:
    """The robot's topics and services, which publishes messages and passes on received ones.

    `receive` and `match` (somebody subscribes to a topic, or nobody does) are called by Zenoh's threads.
    Only `socket` leads into the session: there is nothing of the robot's own Zenoh in it.
    Raises OSError where the session cannot be opened.
    """

    def __init__(
        self,
        socket: Path,
        names: Ros2Names,
        endpoints: Sequence[Endpoint],
        receive: Callable[[Incoming], None],
        match: Callable[[Endpoint, bool], None],
    ) -> None:
        self._names = names
        self._receive = receive
        self._match = match
        self._publishers: dict[str, _Ros2Publisher] = {}
        self._entities: list[Any] = []
        try:
            self._session = zenoh.open(_configuration(socket))
        except zenoh.ZError as problem:
            raise OSError(f"Zenoh cannot listen at {socket}: {describe_problem(problem)}") from problem
        try:
            self._declare(endpoints)
        except zenoh.ZError as problem:
            self.close()
            raise OSError(f"Zenoh refuses a declaration: {describe_problem(problem)}") from problem

    def publish(self, name: str, payload: bytes) -> None:
        """Send a message of this topic; it is dropped where Zenoh's queue is full."""
        self._publishers[name].put(payload)

    def answer(self, call: Incoming, payload: bytes) -> None:
        """Answer a call.

        Raise UnusableMessageError without the attachment that it repeats, OSError after the session's end.
        """
        asked = Attachment.from_bytes(call.attachment)
        assert call.query is not None
        answered = Attachment(asked.sequence, time.time_ns(), asked.gid)
        try:
            with call.query as query:
                query.reply(self._names.key(call.endpoint), payload, attachment=answered.to_bytes())
        except zenoh.ZError as problem:
            raise OSError(f"Zenoh passes no answer on: {describe_problem(problem)}") from problem

    def close(self) -> None:
        """End the session; nothing is received afterwards."""
        self._session.close()  # type: ignore[no-untyped-call]

    def _declare(self, endpoints: Sequence[Endpoint]) -> None:
        session = str(self._session.info.zid())
        liveliness = self._session.liveliness()
        for number, endpoint in enumerate(endpoints, 1):
            token = self._names.token(session, number, endpoint)
            if endpoint.kind == "MP":
                self._publishers[endpoint.name] = self._make_publisher(endpoint, gid_of(token))
            elif endpoint.kind == "MS":
                self._subscribe(endpoint)
            else:
                self._serve(endpoint)
            self._entities.append(liveliness.declare_token(token))
        self._entities.append(liveliness.declare_token(self._names.node_token(session)))

    def _make_publisher(self, endpoint: Endpoint, gid: bytes) -> "_Ros2Publisher":
        key, drop = self._names.key(endpoint), zenoh.CongestionControl.DROP
        plain = self._session.declare_publisher(key, congestion_control=drop)
        self._entities.append(
            plain.declare_matching_listener(lambda status: self._match(endpoint, bool(status.matching)))
        )
        if not endpoint.latched:
            return _Ros2Publisher(plain, gid)
        self._entities.append(plain)
        cached = declare_advanced_publisher(
            self._session,
            key,
            congestion_control=drop,
            cache=CacheConfig(max_samples=endpoint.depth),
            publisher_detection=True,
        )
        return _Ros2Publisher(cached, gid)

    def _subscribe(self, endpoint: Endpoint) -> None:
        key = self._names.key(endpoint)

        def receive(sample: zenoh.Sample) -> None:
            typed = str(sample.key_expr) == key
            self._receive(
                Incoming(
                    endpoint, typed, read_payload(sample.payload), read_payload(sample.attachment) or b""
                )
            )

        declared = self._session.declare_subscriber(self._names.any_type(endpoint), receive)
        self._entities.append(declared)

    def _serve(self, endpoint: Endpoint) -> None:
        def receive(query: zenoh.Query) -> None:
            payload, attachment = read_payload(query.payload), read_payload(query.attachment) or b""
            self._receive(Incoming(endpoint, True, payload, attachment, query))

        declared = self._session.declare_queryable(self._names.key(endpoint), receive, complete=True)
        self._entities.append(declared)


class _Ros2Publisher:
    """A publisher with the count of its messages."""

    def __init__(self, publisher: Any, gid: bytes) -> None:
        self._publisher = publisher
        self._gid = gid
        self._sequence = 0

    def put(self, payload: bytes) -> None:
        """Send a message."""
        self._sequence += 1
        attachment = Attachment(self._sequence, time.time_ns(), self._gid)
        self._publisher.put(payload, attachment=attachment.to_bytes())


def read_payload(data: "zenoh.ZBytes | None") -> bytes | None:
    """Return the bytes, which may be empty; None where there are too many."""
    if data is None:
        return b""
    return data.to_bytes() if len(data) <= PAYLOAD_MAX else None


def _configuration(socket: Path) -> zenoh.Config:
    config = zenoh.Config()
    for key, value in {**SETTINGS, "listen/endpoints": [f"unixsock-stream/{socket}"]}.items():
        config.insert_json5(key, json.dumps(value))
    return config
