"""Driving the whole robot: from the page's socket to the board's fins, and a cut connection."""

import json
import socket as sockets
import time
from collections.abc import Callable
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from robot_runtime.contract.packets import Navigation
from robot_runtime.contract.topics import BY_NAME, TIME
from robot_runtime.transport.blocks import read_blocks
from server.platform.settings import DataFolder
from tests.proofs.watching import FinWatch
from tests.shell import shell_headers
from tests.stack import Stack
from tests.waiting import wait_for

pytestmark = pytest.mark.stack

TICK = 0.05
NEUTRALS = 10
"""Of the 25 that go out until the all-stop; when the first does is measured in simulated time elsewhere."""


class Driver:
    """A page that drives with its sticks in a fixed position."""

    def __init__(self, stack: Stack, socket: ClientConnection) -> None:
        self._stack = stack
        self._socket = socket
        self._sequence = 0
        self.key = {"X-Mucat-Client": self._next("hello")["client_key"]}
        self.lease = self.order("POST", "/control/take").json()["epoch"]

    def order(self, method: str, path: str, body: Any = None) -> Any:
        return self._stack.api.request(method, path, json=body, headers=self.key).raise_for_status()

    def drive_until(self, condition: Callable[[], object], *axes: float) -> float:
        """Hold the sticks in a position until the condition holds; return the time of the last command."""
        end = time.monotonic() + 20
        while True:
            self._sequence += 1
            taken = time.monotonic()
            answer = {"op": "drive", "lease": self.lease, "sequence": self._sequence, "taken": taken}
            self._socket.send(json.dumps(answer | {"axes": axes}))
            if condition():
                return taken
            assert time.monotonic() < end, "waited in vain"
            time.sleep(TICK)

    def cut(self) -> None:
        """Drop the connection without closing the socket, as out of reach."""
        self._socket.socket.shutdown(sockets.SHUT_RDWR)

    def _next(self, op: str) -> dict[str, Any]:
        while True:
            message = self._socket.recv(10)
            if isinstance(message, str) and (answer := json.loads(message))["op"] == op:
                assert isinstance(answer, dict)
                return answer


def commands(blocks: bytes, since: float) -> list[tuple[float, Navigation]]:
    """Commands that the runtime sent to the board after that, with their times (s, steady clock)."""
    topic = BY_NAME["navigation"]
    rows = [
        block.payload[position : position + topic.row_bytes]
        for block in read_blocks(blocks)
        if block.topic is topic
        for position in range(0, len(block.payload), topic.row_bytes)
    ]
    sent = [(TIME.unpack_from(row)[0], Navigation.from_bytes(row[TIME.size :])) for row in rows]
    return [(time, command) for time, command in sent if time >= since]


def test_after_a_driver_s_connection_is_cut_the_fins_rest_and_then_the_robot_stops(
    shared_stack: Stack,
) -> None:
    stack = shared_stack
    folder = DataFolder(stack.data)
    fins = FinWatch(folder.board_socket)
    try:
        with connect(
            f"ws://127.0.0.1:{stack.port}/api/live",
            origin=Origin(stack.url),
            additional_headers=shell_headers(folder),
            max_size=None,
            proxy=None,
        ) as socket:
            session = stack.api.post("/sessions", json={"name": "by hand"}).raise_for_status().json()["id"]
            driver = Driver(stack, socket)
            wait_for(lambda: fins.seen, "the fins to be seen")
            driver.order("POST", "/robot/commands/arm", {"mode": "manual"})
            moved: list[bool] = []

            def swims() -> bool:
                moved.append(fins.seen[-1].moving and fins.seen[-1].powered)
                return moved.count(True) >= 20

            since = driver.drive_until(swims, 0, 0, 1, 0, 0, 0)
            driver.cut()
        wait_for(lambda: fins.seen[-1].time > since and not fins.seen[-1].powered, "no power")
    finally:
        fins.close()
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    whole = stack.api.get(f"/sessions/{session}/blocks", params={"start": 0, "end": 120}).raise_for_status()
    sent = commands(whole.content, since)
    steered = max((time for time, command in sent if command.z), default=since)
    assert sum(time > steered for time, _ in sent) >= NEUTRALS
    # How soon the fins rest and lose power is measured in simulated time: tests/proofs/test_faults.py.
    assert any(sample.powered and not sample.moving for sample in fins.seen if sample.time > since)
    wait_for(lambda: stack.api.get("/robot").json()["mode"] == "failsafe", "the failsafe to be told")
    control = stack.api.get("/control").json()
    assert (control["holder"], control["driven"]["passed"] > 0) == (None, True)
