"""The runtime's end of Zenoh, for tests: publishes on request, and answers every command."""

import json
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import zenoh

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.commands import COMMANDS
from robot_runtime.contract.topics import TIME, Kind
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.errors import RefusedError
from robot_runtime.transport.blocks import Block
from robot_runtime.transport.lifetime import HEARTBEAT
from robot_runtime.transport.outbox import SIMULATOR_STREAM, STREAM
from robot_runtime.transport.replay_cache import ReplayCache
from robot_runtime.transport.zenoh_transport import ZenohTransport
from tests.waiting import SECONDS


def stream_of(block: Block) -> str:
    """Return the stream by which a block's sender sends it."""
    return SIMULATOR_STREAM if block.topic.sender == "simulator" else STREAM


class PatientTransport(ZenohTransport):
    """Waits where the way is full.

    Zenoh drops a message after a millisecond, of which its own thread may get nothing on a busy computer; a
    test would wait for a picture in vain.
    """

    def _publisher(self, name: str) -> zenoh.Publisher:
        if name not in self._publishers:
            block = zenoh.CongestionControl.BLOCK
            publisher = self._session.declare_publisher(self._prefix + name, congestion_control=block)
            self._publishers[name] = publisher
        return self._publishers[name]


class RuntimeEnd:
    """A Zenoh peer in place of the runtime.

    `asked` holds every command that came, but for the control's epochs, which are in `epochs`, and the
    film's, which are in `filmed`; each is answered once its gate is open. `driven` holds what the driver
    sends, `heartbeats` the server's.
    """

    def __init__(self, socket: Path, robot: str) -> None:
        self.asked: list[tuple[str, dict[str, Any]]] = []
        self.epochs: list[int] = []
        self.filmed: list[dict[str, Any]] = []
        self.driven: list[dict[str, Any]] = []
        self.heartbeats: list[str] = []
        self.refusal: str | None = None
        self.gates = {name: threading.Event() for name in COMMANDS if name != "lease"}
        self._messages = PatientTransport(robot, listen=[f"unixsock-stream/{socket}"])
        for name, gate in self.gates.items():
            gate.set()
            self._answer(name, gate)
        self.frames: dict[str, Any] = {"time": 1.0, "frames": [], "fault": None}
        self._messages.serve("query/frames", lambda _: self.frames)
        self.vision = VisionSettings().table()
        self._messages.serve("query/vision", lambda _: {"settings": self.vision, "configured": self.vision})
        self.picked: list[dict[str, Any]] = []
        self._messages.serve("query/pick", self._pick)
        self.snapshot: Block | None = None
        """The picture that a snapshot sends."""
        self._messages.serve("query/snapshot", lambda _: self._send_snapshot())
        self.state: dict[str, Any] = {"mode": "disarmed", "loops": []}
        self._messages.serve("query/state", lambda _: self.state)
        self.parameters: dict[str, Any] = {"time": 1.0, "parameters": []}
        self._messages.serve("query/parameters", lambda _: self.parameters)
        self.provenance = {"configuration": '[robot]\nname = "tested"\n', "software": "0123456789abcdef"}
        self._messages.serve("query/provenance", lambda _: self.provenance)
        self.answer: dict[str, Any] = {}
        """What every command is answered with."""
        self._cache = ReplayCache(self._messages.run, SteadyClock())
        for name in ("query/blocks", "simulator/blocks"):
            self._messages.serve_bytes(name, self._cache.answer)
        self._messages.serve("command/lease", lambda question: self.epochs.append(question["epoch"]))
        self._messages.subscribe("pilot", lambda _, command: self.driven.append(json.loads(command)))
        self._messages.subscribe(HEARTBEAT, lambda _, payload: self.heartbeats.append(payload.decode()))
        # The last of all: who reaches this one reaches every other.
        self._messages.serve("command/there", lambda _: None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._messages.close()

    @property
    def run(self) -> str:
        """The run by which a recording knows this runtime."""
        return self._messages.run

    def publish(self, *blocks: Block) -> None:
        """Publish blocks, each on its own."""
        for block in blocks:
            name = block.topic.name if block.topic.kind is Kind.PICTURE else stream_of(block)
            if block.topic.kind is not Kind.PICTURE:
                self._cache.add(block.data, {block.topic.name: block.following})
            self._messages.publish(name, block.data)
            if name == SIMULATOR_STREAM:
                # The server leaves a message of the simulator until the next one. One of the robot would not
                # do: it may overtake, since each stream has a thread of its own.
                self._messages.publish(name, b"")

    def publish_bytes(self, data: bytes) -> None:
        """Publish any bytes."""
        self._messages.publish(STREAM, data)

    def is_heard(self, topic: str) -> bool:
        """Return True where somebody subscribes to a topic."""
        return self._messages.watched(topic)

    def _pick(self, question: dict[str, Any]) -> Mapping[str, Any]:
        self.picked.append(question)
        if self.refusal is not None:
            raise RefusedError(self.refusal)
        return {"colour": VisionSettings().table()["colours"]["red"], "share": 0.25, "mask": "AAAA"}

    def _send_snapshot(self) -> Mapping[str, Any]:
        if self.snapshot is None:
            raise RefusedError("There is no picture to take. Camera: no picture: it is unplugged.")
        self.publish_bytes(self.snapshot.data)
        return {"time": TIME.unpack_from(self.snapshot.payload)[0]}

    def _answer(self, name: str, gate: threading.Event) -> None:
        def handle(question: dict[str, Any]) -> Mapping[str, Any] | None:
            if name == "film":
                self.filmed.append(question)
            else:
                self.asked.append((name, question))
            gate.wait(SECONDS)
            if self.refusal is not None and name != "stop":
                raise RefusedError(self.refusal)
            return self.answer

        self._messages.serve(f"command/{name}", handle)
