"""`python -m robot_runtime.vision` is the vision process of a runtime, which is at its standard input."""

import logging
import os
import signal
import socket
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robot_runtime.clock import SteadyClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.commands import FilmCommand
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.errors import RefusedError
from robot_runtime.transport.lifetime import end_with_parent, limit_memory
from robot_runtime.vision.camera import Camera, CameraError
from robot_runtime.vision.interface import STARTING, VisionOutputs
from robot_runtime.vision.messages import MessageSocket
from robot_runtime.vision.node import VisionNode
from robot_runtime.vision.process import ALIVE_SECONDS, BYTES_MAX, EXHAUSTED, LOAD_SECONDS

if TYPE_CHECKING:
    from robot_runtime.transport.zenoh_transport import ZenohTransport

NICENESS = 5
"""Above the runtime's: control goes first."""
_OOM_SCORE = Path("/proc/self/oom_score_adj")
_OOM_FIRST = "500"
"""Where the computer's memory is exhausted, the kernel ends vision rather than control."""


def main(open_camera: Callable[[], Camera] | None = None) -> int:
    """Run until the runtime closes its end. `open_camera` replaces the configured camera."""
    for number in (signal.SIGINT, signal.SIGTERM):
        # They reach the whole group or service: the runtime closes its end when it is ready to.
        signal.signal(number, signal.SIG_IGN)
    end_with_parent(number=signal.SIGKILL)
    limit_memory(BYTES_MAX)
    # Some containers and sandboxes forbid it; vision is of use all the same.
    with suppress(OSError):
        os.nice(NICENESS)
        _OOM_SCORE.write_text(_OOM_FIRST, "ascii")
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    messages = MessageSocket(socket.socket(fileno=sys.stdin.fileno()))
    try:
        (start, *others) = messages.receive(LOAD_SECONDS)
        loop = PictureLoop(messages, start.table["start"], open_camera)
        for message in others:
            loop.perform(message.table)
        loop.run()
    except (EOFError, ConnectionError):
        return 0
    except MemoryError:
        logging.exception("the memory of the vision process is exhausted")
        return EXHAUSTED
    return 0


class PictureLoop:
    """The vision node and the runtime's messages, one after the other in one thread."""

    def __init__(
        self, messages: MessageSocket, start: dict[str, Any], open_camera: Callable[[], Camera] | None
    ) -> None:
        self._messages = messages
        self._clock = SteadyClock()
        self._robot, self._endpoint = start["robot"], start["endpoint"]
        self._zenoh: ZenohTransport | None = None
        self._watched: list[str] = []
        self._text = STARTING
        self._sent = self._clock.now()
        self._ending = False
        settings = parse(VisionSettings, start["settings"])
        # The profile may have made the picture smaller than a configuration may: its limits were checked.
        config = VisionConfig(**asdict(settings) | {"colours": settings.colours} | start["config"])
        outputs = VisionOutputs(
            detection=lambda detection: self._send({"detection": asdict(detection)}),
            event=lambda event: self._send({"event": asdict(event)}),
            picture=lambda topic, time, jpeg: self._send({"picture": topic.name, "time": time}, jpeg),
            thumbnail=lambda time, jpeg: self._send({"thumbnail": time}, jpeg),
            snapshot=lambda time, jpeg: self._send({"snapshot": time}, jpeg),
            film=lambda time, picture: self._send({"film": time}, picture),
            watched=lambda topic: topic.name in self._watched,
        )
        self._node = VisionNode(config, self._clock, outputs, open_camera, self._connect)
        self._node.film(parse(FilmCommand, start["film"]))
        self._card: str | None = start["card"]

    def run(self) -> None:
        """Take and search pictures. Raise EOFError and ConnectionError at the runtime's end."""
        self._node.start()
        if self._node.missing:
            self._send({"missing": self._node.missing})
            return
        self._send({"loaded": True})
        self._show_card()
        while not self._ending:
            remaining = self._node.tick()
            self._report()
            for message in self._messages.receive(max(remaining, 0.0)):
                self.perform(message.table)
        self._node.close()

    def perform(self, table: dict[str, Any]) -> None:
        """Perform a message of the runtime."""
        if "settings" in table:
            self._node.settings = parse(VisionSettings, table["settings"])
        elif "card" in table:
            self._card = table["card"]
            self._show_card()
        elif "watched" in table:
            self._watched = table["watched"]
        elif "film" in table:
            self._node.film(parse(FilmCommand, table["film"]))
        elif "pick" in table:
            self._answer(table, lambda: self._node.pick(table["pick"]))
        elif "snapshot" in table:
            self._answer(table, self._node.take_snapshot)
        else:
            self._ending = True

    def _answer(self, question: dict[str, Any], answer: Callable[[], dict[str, Any]]) -> None:
        try:
            outcome: dict[str, Any] = {"answer": answer()}
        except (RefusedError, ConfigError) as problem:
            outcome = {"refused": str(problem)}
        self._send({"number": question["number"], **outcome})

    def _show_card(self) -> None:
        # The runtime has checked it; its colour may be gone since.
        if self._card != self._node.card:
            with suppress(RefusedError):
                self._node.show_card(self._card)

    def _report(self) -> None:
        """Send the camera's state where it has changed, or where nothing else was sent for long."""
        text = self._node.text
        if text != self._text or self._clock.now() - self._sent >= ALIVE_SECONDS:
            self._text = text
            self._send({"camera": text})

    def _send(self, table: dict[str, Any], attachment: bytes = b"") -> None:
        self._messages.send(table, attachment)
        self._sent = self._clock.now()

    def _connect(self) -> "ZenohTransport":
        """Open Zenoh, which a real camera does without. Raise CameraError."""
        from robot_runtime.transport.zenoh_transport import ZenohTransport
        from robot_runtime.vision.scene_camera import PATIENCE

        if self._zenoh is None:
            try:
                self._zenoh = ZenohTransport(self._robot, connect=[self._endpoint], client=True)
            except OSError as problem:
                raise CameraError(f"the scene cannot be asked: {problem}", PATIENCE) from problem
        return self._zenoh


if __name__ == "__main__":
    # Threads of libraries, of a camera or of Zenoh, may not keep a process that has nothing to do.
    os._exit(main())
