"""The robot that attackers attack, over the loopback from an address of their own."""

import socket
import time
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

import httpx
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

FROM = "127.0.0.2"
"""The attackers' address: the operator has another, as on a network."""
PATIENCE = 60.0


class AttackedRobot:
    """The attacked robot, the tokens of a viewer and an operator without control, and a viewer's ROS 2.

    `ros2` is the folder of its certificate for the door; the door's endpoint is in its file `endpoint`.
    """

    def __init__(self, url: str, viewer: str, operator: str, ros2: Path) -> None:
        self.url = url
        self.ros2 = ros2
        parts = urlsplit(url)
        self.address = parts.hostname or "", parts.port or 0
        self.viewer = {"authorization": f"Bearer {viewer}"}
        self.operator = {"authorization": f"Bearer {operator}"}

    def ask(self, method: str, path: str, headers: dict[str, str] | None = None, **options: object) -> int:
        """Return the status of an answer, which is no internal error."""
        with httpx.Client(
            base_url=self.url, timeout=PATIENCE, transport=httpx.HTTPTransport(local_address=FROM)
        ) as client:
            answer = client.request(method, path, headers=headers, **options)  # type: ignore[arg-type]
        assert answer.status_code != 500, (method, path, answer.text[:200])
        assert "root:x:" not in answer.text
        return answer.status_code

    def newest_session(self) -> int:
        """Return the number of the newest session."""
        transport = httpx.HTTPTransport(local_address=FROM)
        with httpx.Client(base_url=self.url, timeout=PATIENCE, transport=transport) as client:
            answer = client.get("/api/sessions?limit=1", headers=self.viewer).raise_for_status()
        return int(answer.json()[0]["id"])

    def make_viewers(self, count: int) -> list[dict[str, str]]:
        """Return the headers of so many new viewers."""
        made = []
        transport = httpx.HTTPTransport(local_address=FROM)
        with httpx.Client(base_url=self.url, timeout=PATIENCE, transport=transport) as client:
            for _ in range(count):
                body = {"name": f"viewer {time.monotonic_ns()}", "scope": "read"}
                answer = client.post("/api/access/tokens", headers=self.operator, json=body)
                made.append({"authorization": f"Bearer {answer.raise_for_status().json()['token']}"})
        return made

    def refuse(
        self, method: str, path: str, headers: dict[str, str] | None = None, **options: object
    ) -> None:
        """Ask for something that is refused."""
        status = self.ask(method, path, headers, **options)
        assert 400 <= status < 500 or status == 503, (method, path, status)

    def reach(self, timeout: float, source: str = FROM) -> socket.socket:
        """Return a connection from the attackers' address. Raise OSError."""
        return socket.create_connection(self.address, timeout, source_address=(source, 0))

    def send(self, data: bytes) -> bytes:
        """Return the beginning of the answer to these bytes."""
        with self.reach(PATIENCE) as line:
            line.sendall(data)
            with suppress(ConnectionError):
                return line.recv(100)
        return b""

    def open(
        self, headers: dict[str, str], path: str = "/api/live", subprotocol: str | None = None
    ) -> ClientConnection:
        """Return a live socket, or one of a door. Raise OSError, WebSocketException."""
        return connect(
            f"{self.url.replace('http', 'ws', 1)}{path}",
            origin=Origin(self.url),
            additional_headers=headers,
            subprotocols=None if subprotocol is None else [Subprotocol(subprotocol)],
            max_size=None,
            compression=None,
            ping_interval=None,
            close_timeout=0.5,
            sock=self.reach(PATIENCE),
        )
