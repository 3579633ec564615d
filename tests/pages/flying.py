"""A robot that is armed in manual, as a page is told of it: the server's messages, changed on their way."""

import json
from typing import Any

import cv2
import numpy as np
from playwright.sync_api import Page, WebSocketRoute

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.topics import BY_ID, BY_NAME
from robot_runtime.transport.blocks import HEADER, Block, row

ALARM = {
    "fault": "camera_silent",
    "severity": "caution",
    "what": "The camera sends no pictures.",
    "cause": "Its cable is loose.",
    "remedy": "Check its cable.",
    "since": 0.0,
    "until": None,
    "active": True,
    "acknowledged": False,
    "consequences": [],
}


def water(time: float, name: str = "picture") -> Block:
    """Return the block of a picture of water with a yellow card, taken then (s, steady clock)."""
    rows = np.linspace(1.0, 0.35, 480)[:, None, None]
    picture = (np.full((480, 640, 3), (150, 118, 38)) * rows).astype(np.uint8)
    cv2.rectangle(picture, (250, 190), (360, 290), (40, 205, 230), -1)
    _, jpeg = cv2.imencode(".jpg", picture)
    return Block.of(BY_NAME[name], 1, 0, row(time, jpeg.tobytes()))


class Flown:
    """Changes what a page hears: mode, loops that are on, alarms, a scene, and a camera that fails."""

    def __init__(self, page: Page) -> None:
        self.mode = "disarmed"
        self.held: set[str] = set()
        self.alarms: list[dict[str, Any]] = []
        self.scene = False
        self.camera_failure: str | None = None
        self._sockets: list[WebSocketRoute] = []
        page.route_web_socket("**/api/live", self._hand_on)

    def show(self, topic: str = "picture") -> None:
        """Send a picture that is new."""
        self.send(water(SteadyClock().now(), topic))

    def send(self, block: Block) -> None:
        """Send a block that the robot does not."""
        self._sockets[-1].send(block.data)

    def _hand_on(self, socket: WebSocketRoute) -> None:
        def change(message: str | bytes) -> None:
            socket.send(self._blocks(message) if isinstance(message, bytes) else self._text(message))

        self._sockets.append(socket)
        socket.connect_to_server().on_message(change)

    def _text(self, message: str) -> str:
        answer = json.loads(message)
        if answer["op"] == "health" and self.scene:
            answer["parts"] += [{"name": "scene", "state": "works", "text": ""}]
        if answer["op"] == "health" and self.camera_failure:
            failing = {"state": "absent", "text": self.camera_failure}
            answer["parts"] = [
                part | failing if part["name"] == "camera" else part for part in answer["parts"]
            ]
        return json.dumps(answer)

    def _blocks(self, message: bytes) -> bytes:
        changed = b""
        while message:
            topic, _, count, first, size = HEADER.unpack_from(message)
            payload, message = message[HEADER.size : HEADER.size + size], message[HEADER.size + size :]
            if topic == BY_NAME["state"].id:
                payload = json.dumps([self._state(state) for state in json.loads(payload)]).encode()
            changed += Block.of(BY_ID[topic], count, first, payload).data
        return changed

    def _state(self, state: dict[str, Any]) -> dict[str, Any]:
        armed = self.mode in ("manual", "automatic")
        loops = [loop | {"on": loop["name"] in self.held} for loop in state["loops"]]
        since = state["time"] if armed else None
        alarms = [ALARM | alarm for alarm in self.alarms]
        return state | {
            "mode": self.mode,
            "armed": armed,
            "armed_since": since,
            "loops": loops,
            "alarms": alarms,
        }
