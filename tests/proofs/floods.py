"""Floods of a viewer: as much as a signed-in viewer can send, ask for, or leave unread.

Each lasts for `FLOOD_SECONDS`, and asserts nothing itself: meanwhile an operator presses STOP.
"""

import json
import socket
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing, suppress
from struct import Struct

import zenoh
from websockets.exceptions import WebSocketException

from robot_runtime.contract.topics import TOPICS, Kind
from server.features.doors.ros2_messages import TRIGGER, ros2_types
from server.features.doors.ros2_names import GID_BYTES, Attachment, Endpoint, Ros2Names
from server.features.doors.twist import TAKEN_IN
from tests.proofs.field import AttackedRobot
from tests.server.features.doors.ros2_rig import open_zenoh

FLOOD_SECONDS = 5.0
DEVICE_SOCKETS = 8
"""Sockets that one device may have at a door."""
VIEWERS = 20
UNREAD = 95
"""Connections below the limit of one address."""
BATCH = 400
"""Messages in one piece of bytes: the attackers shall cost less than what they attack."""
SUBPROTOCOL = "foxglove.sdk.v1"
SERVICE_CALL = Struct("<BIII")
ROWS = [topic.name for topic in TOPICS if topic.kind is Kind.ROWS]


def frame(payload: bytes, opcode: int = 1) -> bytes:
    """Return a whole WebSocket message of a client (RFC 6455, 5.2); masked by zeros, it is sent as it is."""
    size = len(payload)
    length = bytes([128 + size]) if size < 126 else bytes([128 + 126]) + size.to_bytes(2)
    return bytes([128 + opcode]) + length + bytes(4) + payload


def pour(line: socket.socket, data: bytes) -> None:
    """Send these bytes over and over while somebody takes them, and read nothing."""
    line.settimeout(0.5)
    end = time.monotonic() + FLOOD_SECONDS
    while time.monotonic() < end:
        with suppress(TimeoutError):
            line.sendall(data)


def pour_into_sockets(field: AttackedRobot, path: str, data: bytes, subprotocol: str | None = None) -> None:
    """Pour into as many sockets as one device may have."""
    with ExitStack() as opened, ThreadPoolExecutor(DEVICE_SOCKETS) as threads:
        pages = []
        for _ in range(DEVICE_SOCKETS):
            with suppress(OSError, WebSocketException):
                page = field.open(field.viewer, path, subprotocol)
                pages.append(opened.enter_context(closing(page)))
        assert pages, "no socket was opened"
        poured = [threads.submit(pour, page.socket, data) for page in pages]
        for piece in poured:
            with suppress(OSError):
                piece.result()


def stops_at_rosbridge(field: AttackedRobot) -> None:
    call = {"op": "call_service", "service": "/mucat/stop", "id": "x"}
    publish = {"op": "publish", "topic": "/mucat/stop", "msg": {}}
    data = frame(json.dumps(call).encode()) + frame(json.dumps(publish).encode())
    pour_into_sockets(field, "/rosbridge", data * BATCH)


def stops_at_foxglove(field: AttackedRobot) -> None:
    channel = {"id": 1, "topic": "/mucat/stop", "encoding": "json", "schemaName": "std_msgs/msg/Empty"}
    head = frame(json.dumps({"op": "advertise", "channels": [channel]}).encode())
    publish = frame(bytes([1]) + (1).to_bytes(4, "little") + b"{}", 2)
    calls = b"".join(frame(SERVICE_CALL.pack(2, call, 1, 4) + b"json{}", 2) for call in range(1, 4))
    pour_into_sockets(field, "/foxglove", head + (publish + calls) * BATCH, SUBPROTOCOL)


def stops_on_live_sockets(field: AttackedRobot) -> None:
    pour_into_sockets(field, "/api/live", frame(b'{"op": "stop"}') * BATCH)


def stops_over_http(field: AttackedRobot) -> None:
    token = field.viewer["authorization"]
    head = f"POST /api/robot/stop HTTP/1.1\r\nHost: localhost\r\nAuthorization: {token}\r\n"
    request = f"{head}Content-Length: 0\r\n\r\n".encode()
    _pour_requests(field, request * 20)


def small_messages(field: AttackedRobot) -> None:
    odd = b"".join(
        frame(json.dumps(document).encode()) for document in ({"op": "ping", "id": 1}, {"op": "watch"})
    )
    watch = b"".join(
        frame(json.dumps({"op": "watch", "pictures": pictures}).encode())
        for pictures in ([], ["picture"], ["mask"])
    )
    pour_into_sockets(field, "/api/live", (odd + watch + frame(b"")) * BATCH)


def pings_unread(field: AttackedRobot) -> None:
    pour_into_sockets(field, "/api/live", frame(bytes(125), 9) * BATCH)


def subscriptions(field: AttackedRobot) -> None:
    asked = b""
    for position in range(40):
        for op in ("subscribe", "unsubscribe"):
            asked += frame(
                json.dumps({"op": op, "topic": "/camera/image/compressed", "id": str(position)}).encode()
            )
    pour_into_sockets(field, "/rosbridge", asked)


def every_topic(field: AttackedRobot) -> None:
    with ExitStack() as opened, ThreadPoolExecutor(DEVICE_SOCKETS) as threads:
        reading = []
        for position in range(DEVICE_SOCKETS):
            with suppress(OSError, WebSocketException):
                page = opened.enter_context(closing(field.open(field.viewer, "/rosbridge")))
                page.send(json.dumps({"op": "call_service", "service": "/rosapi/topics", "id": "topics"}))
                topics = json.loads(page.recv(FLOOD_SECONDS))["values"]["topics"]
                asked = {"op": "subscribe", "compression": ("none", "cbor")[position % 2]}
                for topic in topics:
                    page.send(json.dumps(asked | {"topic": topic}))
                reading.append(threads.submit(_read_on, page.socket))
        for reader in reading:
            reader.result()


def history_unread(field: AttackedRobot) -> None:
    token = field.viewer["authorization"]
    query = "&".join(f"topic={row}" for row in ROWS)
    head = f"GET /api/past?{query}&until=1e9 HTTP/1.1\r\nHost: localhost\r\nAuthorization: {token}\r\n\r\n"
    _pour_requests(field, head.encode())


def small_connections(field: AttackedRobot) -> None:
    _ask_in_turn(field, ["/api/sessions"], [field.viewer])


def crowded_session(field: AttackedRobot) -> None:
    newest = f"/api/sessions/{field.newest_session()}"
    _ask_in_turn(field, [newest, f"{newest}/timeline"], [field.viewer])


def many_viewers(field: AttackedRobot) -> None:
    newest = f"/api/sessions/{field.newest_session()}"
    query = "&".join(f"topic={row}" for row in ROWS)
    lists = [f"/api/{name}" for name in ("sessions", "missions", "scenarios", "exports")]
    parts = [f"{newest}{ending}" for ending in ("", "/timeline", "/missions", "/signals")]
    paths = [f"/api/past?{query}&until=1e9", *parts, *lists]
    statuses = {path: field.ask("GET", path, field.viewer) for path in paths}
    assert set(statuses.values()) == {200}, statuses
    _ask_in_turn(field, paths, field.make_viewers(VIEWERS))


def messages_at_ros2(field: AttackedRobot) -> None:
    """Send calls of STOP and twists of as many programs as one certificate may have; await no answer."""
    types, names = ros2_types(), Ros2Names(0, "")
    stop = names.key(Endpoint("SS", "/mucat/stop", TRIGGER, types.hash(TRIGGER)))
    twists = [names.key(Endpoint("MS", name, kind, types.hash(kind))) for name, kind in TAKEN_IN.items()]
    certificate = {
        "root_ca_certificate": str(field.ros2 / "authority.pem"),
        "connect_certificate": str(field.ros2 / "certificate.pem"),
        "connect_private_key": str(field.ros2 / "key.pem"),
        "enable_mtls": True,
        "verify_name_on_connect": False,
    }
    values = {
        "mode": "client",
        "connect/endpoints": [(field.ros2 / "endpoint").read_text(encoding="utf-8")],
        "transport/link/tls": certificate,
    }
    end = time.monotonic() + FLOOD_SECONDS

    def send(_: int) -> None:
        with suppress(zenoh.ZError), open_zenoh(values) as session:
            number = 0
            while time.monotonic() < end:
                number += 1
                attachment = Attachment(number, 0, bytes(GID_BYTES)).to_bytes()
                session.get(
                    stop, lambda _: None, payload=bytes(5), attachment=attachment, timeout=FLOOD_SECONDS
                )
                for key in twists:
                    session.put(key, bytes(52), attachment=attachment)
                # Far more than the door takes in already: what Zenoh drops here costs the attackers alone.
                time.sleep(0.002)

    with ThreadPoolExecutor(DEVICE_SOCKETS) as threads:
        list(threads.map(send, range(DEVICE_SOCKETS)))


def _ask_in_turn(field: AttackedRobot, paths: list[str], viewers: list[dict[str, str]]) -> None:
    """Ask for these over many connections, one request each, and read the answers."""
    end = time.monotonic() + FLOOD_SECONDS

    def ask(position: int) -> None:
        token = viewers[position % len(viewers)]["authorization"]
        head = f"GET {paths[position % len(paths)]} HTTP/1.1\r\nHost: localhost\r\nAuthorization: {token}\r\n"
        request = f"{head}Connection: close\r\n\r\n".encode()
        while time.monotonic() < end:
            with suppress(OSError), field.reach(1.0) as line:
                line.sendall(request)
                while line.recv(65_536):
                    pass

    with ThreadPoolExecutor(50) as threads:
        list(threads.map(ask, range(50)))


def _pour_requests(field: AttackedRobot, request: bytes) -> None:
    """Send requests over many connections, and read no answers."""
    with ExitStack() as opened:
        lines = []
        for _ in range(UNREAD):
            with suppress(OSError):
                line = opened.enter_context(field.reach(1.0))
                line.setblocking(False)
                lines.append(line)
        end = time.monotonic() + FLOOD_SECONDS
        while time.monotonic() < end:
            for line in lines:
                with suppress(OSError):
                    line.send(request)
            time.sleep(0.02)


def _read_on(line: socket.socket) -> None:
    line.settimeout(0.5)
    end = time.monotonic() + FLOOD_SECONDS
    while time.monotonic() < end:
        with suppress(TimeoutError):
            if not line.recv(1 << 20):
                return


FLOODS: dict[str, Callable[[AttackedRobot], None]] = {
    "STOPs at rosbridge": stops_at_rosbridge,
    "STOPs at Foxglove": stops_at_foxglove,
    "STOPs on live sockets": stops_on_live_sockets,
    "STOPs over HTTP": stops_over_http,
    "small messages on live sockets": small_messages,
    "pings whose answers are not read": pings_unread,
    "subscriptions that come and go": subscriptions,
    "all topics of rosbridge": every_topic,
    "the history asked for and not read": history_unread,
    "small connections": small_connections,
    "a session of 400,000 gaps": crowded_session,
    "twenty viewers who read all there is": many_viewers,
    "STOPs and twists at ROS 2": messages_at_ros2,
}
"""Each alone, while an operator presses STOP."""
