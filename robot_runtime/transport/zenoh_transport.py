"""Transport over Zenoh: publish and subscribe to topics, query and serve requests.

Keys are `mucat/<robot>/<name>`. Endpoints are explicit; multicast scouting is off unless it is asked
for. Callbacks run in Zenoh's own threads.
"""

import json
import logging
import os
import re
import secrets
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Literal, Self

import zenoh

from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.transport.network import LOCAL_ONLY

log = logging.getLogger(__name__)

Answer = dict[str, Any]
_CLIENT_TIMEOUT_MS = 1000
_JOIN_RETRY = 1.0
_OPENING_MS = 50
"""ms for which a peer's opening waits at most for the others' declarations; Zenoh's own default is 500."""
_RETRY_MS_MIN, _RETRY_MS_MAX = 50, 200
"""ms between two attempts to connect to a lost peer, doubled from the first to the last."""

_THREADS = "(net: (worker_threads: 1), acc: (handover: net), rx: (worker_threads: 1), tx: (handover: net))"
"""Zenoh's `ZENOH_RUNTIME`: a thread that receives, and one for all else. With a thread for each kind of work,
its default, three are woken for a message, and the work of each is less than its waking. A single one would
wait for itself: where the queue is full, it answers a received message after 5 s; none is sent till then."""

_REFUSAL = zenoh.Encoding.TEXT_PLAIN


class Subscription:
    """A running subscription; close it to end it."""

    def __init__(self, subscriber: "zenoh.Subscriber[None]") -> None:
        self._subscriber = subscriber

    def close(self) -> None:
        """End the subscription."""
        self._subscriber.undeclare()  # type: ignore[no-untyped-call]


class ZenohTransport:
    """One process's transport.

    `listen` and `connect` are Zenoh endpoints, such as "unixsock-stream//run/mucat/runtime.sock" or
    "tls/192.168.0.7:7447", which needs the settings of `robot_runtime.transport.network`. Lost peers are
    tried again for ever. A `client` reaches everybody through the one that it connects to, which must be
    there when it starts. Raises OSError where an endpoint cannot be listened on, or a client's cannot be
    reached.

    `run` are 16 hexadecimal digits that are new in every process; they travel with all that it publishes.
    """

    def __init__(
        self,
        robot: str,
        listen: Sequence[str] = (),
        connect: Sequence[str] = (),
        scouting: bool = False,
        client: bool = False,
        network: Mapping[str, Any] = LOCAL_ONLY,
    ) -> None:
        self.run = secrets.token_hex(8)
        self.endpoints = tuple(listen)
        """The endpoints that it listens on."""
        self.robot = robot
        self._prefix = f"mucat/{robot}/"
        self._session = open_session("client" if client else "peer", listen, connect, network, scouting)
        self._tokens: list[zenoh.LivelinessToken] = []
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._watched: dict[str, bool] = {}
        """Of the names that were asked for: if anybody subscribes to them now."""
        self._queryables: list[zenoh.Queryable[None]] = []

    def publish(self, name: str, payload: bytes) -> None:
        """Send to all subscribers of `name`."""
        self._publisher(name).put(payload, attachment=self.run)

    def watched(self, name: str) -> bool:
        """Return True if anybody subscribes to `name` now."""
        if name not in self._watched:
            publisher = self._publisher(name)
            # It is asked for each block that is sent: a listener is told of changes alone.
            see = partial(self._see_matching, name)
            publisher.declare_matching_listener(zenoh.handlers.Callback(see, indirect=False))
            # Zenoh's stub calls this a bool; it is a MatchingStatus.
            status: Any = publisher.matching_status
            self._watched.setdefault(name, bool(status.matching))
        return self._watched[name]

    def subscribe(self, pattern: str, callback: Callable[[str, bytes], None]) -> Subscription:
        """Call back with the name and payload of every message whose name matches ("depth", "**")."""
        return self.subscribe_runs(pattern, lambda name, payload, _: callback(name, payload))

    def subscribe_runs(self, pattern: str, callback: Callable[[str, bytes, str], None]) -> Subscription:
        """Subscribe as `subscribe`, with the sender's `run` as a third argument."""

        def receive(sample: zenoh.Sample) -> None:
            run = sample.attachment.to_string() if sample.attachment is not None else ""
            callback(str(sample.key_expr).removeprefix(self._prefix), sample.payload.to_bytes(), run)

        return Subscription(self._session.declare_subscriber(self._prefix + pattern, receive))

    def query(self, name: str, payload: Mapping[str, Any], timeout: float = 2.0) -> Answer:
        """Send a request and return its answer.

        Raise RefusedError with the reason, or NoAnswerError after `timeout` seconds.
        """
        data = json.dumps(payload, allow_nan=False).encode()
        answer: Answer = json.loads(self.query_bytes(name, data, timeout))
        if not answer.get("accepted"):
            raise RefusedError(str(answer.get("reason", "refused without a reason")))
        return answer

    def serve(self, name: str, handler: Callable[[Answer], Mapping[str, Any] | None]) -> None:
        """Serve `name` with the handler's results; its RefusedError or ValueError becomes a refusal."""
        self.serve_bytes(name, lambda question: json.dumps(_outcome(name, handler, question)).encode())

    def query_bytes(self, name: str, payload: bytes, timeout: float = 2.0) -> bytes:
        """Send a request and return its answer, both as plain bytes; raise as `query` does."""
        for reply in self._session.get(self._prefix + name, payload=payload, timeout=timeout):
            if reply.ok is not None:
                return reply.ok.payload.to_bytes()
            # Zenoh puts its own errors, such as a timeout, into the same place.
            if reply.err is not None and reply.err.encoding == _REFUSAL:
                raise RefusedError(reply.err.payload.to_string())
        raise NoAnswerError(f"no answer to {name} within {timeout:g} s")

    def serve_bytes(self, name: str, handler: Callable[[bytes], bytes]) -> None:
        """Serve `name` with the bytes that the handler returns; refuse as `serve` does."""

        def reply(query: zenoh.Query) -> None:
            with query:
                try:
                    answer = handler(query.payload.to_bytes() if query.payload is not None else b"")
                except Exception as problem:
                    query.reply_err(_reason(name, problem).encode(), encoding=_REFUSAL)
                else:
                    query.reply(query.key_expr, answer)

        self._queryables.append(self._session.declare_queryable(self._prefix + name, reply))

    def announce(self, name: str) -> None:
        """Declare a liveliness token of this name: who watches for it learns of the end of this process."""
        self._tokens.append(self._session.liveliness().declare_token(self._prefix + name))

    @property
    def routed(self) -> bool:
        """True while a router is connected."""
        return bool(self._session.info.routers_zid())

    def close(self) -> None:
        """Close the session. An open Zenoh session keeps the interpreter alive, so this must be called."""
        self._session.close()  # type: ignore[no-untyped-call]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _see_matching(self, name: str, status: zenoh.MatchingStatus) -> None:
        self._watched[name] = status.matching

    def _publisher(self, name: str) -> zenoh.Publisher:
        publisher = self._publishers.get(name)
        if publisher is None:
            publisher = self._publishers[name] = self._session.declare_publisher(self._prefix + name)
        return publisher


Mode = Literal["peer", "client", "router"]


def open_session(
    mode: Mode,
    listen: Sequence[str] = (),
    connect: Sequence[str] = (),
    network: Mapping[str, Any] = LOCAL_ONLY,
    scouting: bool = False,
) -> "zenoh.Session":
    """Open a session of Zenoh. Raise OSError as `ZenohTransport` does."""
    # Zenoh reads it once, when a process opens its first session.
    os.environ.setdefault("ZENOH_RUNTIME", _THREADS)
    try:
        return zenoh.open(_configuration(mode, listen, connect, network, scouting))
    except zenoh.ZError as problem:
        does, where = ("reach", connect) if mode == "client" else ("listen on", listen)
        raise OSError(f"cannot {does} {', '.join(where)}: {describe_problem(problem)}") from problem


def join(robot: str, endpoints: Sequence[str], network: Mapping[str, Any] = LOCAL_ONLY) -> ZenohTransport:
    """Connect to a robot as a client; wait until it answers, and log both."""
    warned = False
    while True:
        try:
            joined = ZenohTransport(robot, connect=endpoints, client=True, network=network)
        except OSError as problem:
            if not warned:
                log.warning(
                    "%s Trying again until it answers. Does the robot run, listen at this address "
                    "(zenoh.listen), and is the certificate one of its own?",
                    problem,
                )
            warned = True
            time.sleep(_JOIN_RETRY)
        else:
            log.info("connected to %s", ", ".join(endpoints))
            return joined


def describe_problem(problem: zenoh.ZError) -> str:
    """Return Zenoh's message without source positions: paths of the computer that built it."""
    text = re.sub(r"\s*\bat /\S+\.rs:\d+\.?", "", str(problem))
    # "Single" is its type of a single endpoint.
    return re.sub(r"Single\((.*?)\)", r"\1", text).strip()


def _outcome(name: str, handler: Callable[[Answer], Mapping[str, Any] | None], data: bytes) -> Answer:
    try:
        question = json.loads(data or b"{}")
        if not isinstance(question, dict):
            raise ValueError("a question must be a JSON object")
        return {"accepted": True, **(handler(question) or {})}
    except Exception as problem:
        return {"accepted": False, "reason": _reason(name, problem)}


def _reason(name: str, problem: Exception) -> str:
    if isinstance(problem, RefusedError | ValueError | TypeError):
        return str(problem)
    log.error("answering %s failed", name, exc_info=problem)
    return "an error inside the answering process; its log says more"


def _configuration(
    mode: Mode, listen: Sequence[str], connect: Sequence[str], network: Mapping[str, Any], scouting: bool
) -> zenoh.Config:
    client = mode == "client"
    settings: dict[str, Any] = {
        **network,
        "mode": mode,
        "scouting/multicast/enabled": scouting,
        # It answers others that look for it. It connects to nobody because of a message from the network.
        "scouting/multicast/autoconnect": {"router": [], "peer": [], "client": []},
        "scouting/gossip/enabled": False,
        "listen/endpoints": list(listen),
        "connect/endpoints": list(connect),
        # Batches of some hundred bytes gain nothing from it, and its threads wake thirty times a second.
        "transport/shared_memory/enabled": False,
        # A client's opening waits for this; a peer's goes on trying behind it.
        "connect/timeout_ms": _CLIENT_TIMEOUT_MS if client else -1,
        "connect/exit_on_failure": False,
        "connect/retry": {
            "period_init_ms": _RETRY_MS_MIN,
            "period_max_ms": _RETRY_MS_MAX,
            "period_increase_factor": 2,
        },
    }
    if not client:
        settings["scouting/delay"] = _OPENING_MS
    config = zenoh.Config()
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    return config
