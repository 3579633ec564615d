"""The scene as a process: it receives the robot's position, and renders on request or for viewers.

One thread renders, as OpenGL requires. MuJoCo is loaded with the first picture, so that it costs nothing
while none is requested.
"""

import logging
import queue
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import cv2

from robot_runtime.clock import Clock
from robot_runtime.contract.card_colours import Paint
from robot_runtime.contract.documents import Truth
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.scene_picture import Picture, Request, read_request, write_picture
from robot_runtime.contract.topics import OBSERVER, TRUTH
from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.simulation.scene.contents import Contents, SceneWater, Targets
from robot_runtime.simulation.scene.view import ObserverView
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import Basin, check_beacons
from robot_runtime.transport.blocks import Block, read_blocks, read_rows, row
from robot_runtime.transport.zenoh_transport import ZenohTransport

if TYPE_CHECKING:
    from robot_runtime.simulation.scene.scene import SceneRenderer

log = logging.getLogger(__name__)

QUERY_PERIOD = 1.0
"""s between two queries of the simulator's surroundings."""
QUERY_TIMEOUT = 0.3
ANSWER_TIMEOUT = 15.0
"""s; the first picture waits for MuJoCo and all textures."""
OBSERVER_PERIOD = 1 / 12
"""s between two pictures of the observer."""
OBSERVER_SIZE = (640, 360)
CHECK_PERIOD = 0.25
"""s between two checks for viewers of the observer's picture."""
JPEG_QUALITY = 80

Question = dict[str, Any]


class SceneProcess:
    """The scene's service, which answers and publishes until `end`; `run` renders in its caller's thread."""

    def __init__(self, messages: ZenohTransport, clock: Clock) -> None:
        self._messages = messages
        self._clock = clock
        self._contents = Contents()
        self._view = ObserverView()
        self._card: Paint | None = None
        self._lock = threading.Lock()
        self._truth: tuple[float, Truth] | None = None
        self._scene: SceneRenderer | None = None
        self._problem = missing()
        self._jobs: queue.Queue[tuple[Request, Future[Picture]]] = queue.Queue()
        self._queried = float("-inf")
        self._observe_due = clock.now()
        self._observed: tuple[float, ObserverView] | None = None
        self._observer_number = 0
        self._ending = False
        if self._problem:
            log.warning("nothing can be rendered: %s", self._problem)
        messages.subscribe(TRUTH.name, self._see_truth)
        handlers: dict[str, Callable[[Question], Mapping[str, Any] | None]] = {
            "ready": lambda _: {"missing": self._problem},
            "world": self._set_water,
            "targets": self._set_targets,
            "view": self._set_view,
            "contents": self._describe_contents,
        }
        for name, handler in handlers.items():
            messages.serve(f"scene/{name}", handler)
        messages.serve_bytes("scene/picture", self._answer_picture)

    def run(self) -> None:
        """Render until `end` is called."""
        try:
            while not self._ending:
                try:
                    request, future = self._jobs.get(timeout=self._observe())
                except queue.Empty:
                    continue
                try:
                    future.set_result(self._render(request))
                except Exception as problem:
                    future.set_exception(problem)
        finally:
            if self._scene is not None:
                self._scene.close()

    def end(self) -> None:
        """Make `run` return soon; may be called from a signal handler or any thread."""
        self._ending = True

    def _see_truth(self, _: str, data: bytes) -> None:
        try:
            time, truth = read_rows(read_blocks(data)[-1])[-1]
        except (LayoutError, TypeError, IndexError) as problem:
            log.warning("an invalid truth was dropped: %s", problem)
            return
        if isinstance(truth, Truth):
            self._truth = (time, truth)

    def _set_water(self, question: Question) -> None:
        water = parse(SceneWater, question)
        with self._lock:
            self._contents = replace(self._contents, water=water)

    def _set_targets(self, question: Question) -> None:
        targets = parse(Targets, question).targets
        with self._lock:
            self._contents = replace(self._contents, targets=targets)

    def _describe_contents(self, _: Question) -> Question:
        """Return the requests that restore the present water and targets."""
        with self._lock:
            contents = self._contents
        water = {name: value for name, value in asdict(contents.water).items() if value is not None}
        return {"world": water, "targets": {"targets": [asdict(target) for target in contents.targets]}}

    def _set_view(self, question: Question) -> None:
        self._view = parse(ObserverView, question)

    def _answer_picture(self, data: bytes) -> bytes:
        request = read_request(data)
        future: Future[Picture] = Future()
        self._jobs.put((request, future))
        try:
            return write_picture(future.result(ANSWER_TIMEOUT))
        except TimeoutError:
            raise RefusedError(f"the scene takes longer than {ANSWER_TIMEOUT:g} s for a picture") from None

    def _render(self, request: Request) -> Picture:
        """Render the picture of the newest truth.

        Raise RefusedError if there is none, or if nothing can be rendered.
        """
        if self._truth is None:
            raise RefusedError("the simulator has not sent the robot's position yet")
        time, truth = self._truth
        self._card = request.card
        pixels = self._ready_scene().render_camera(
            time, truth, request.width, request.height, request.card, request.marked
        )
        return Picture(time, pixels)

    def _observe(self) -> float:
        """Publish the observer's picture if it is viewed and due. Return the s until the next one."""
        now = self._clock.now()
        if now < self._observe_due:
            return self._observe_due - now
        period = CHECK_PERIOD
        if not self._messages.watched(OBSERVER.name):
            self._observed = None
        elif self._truth is not None and self._problem is None:
            period = OBSERVER_PERIOD
            try:
                self._publish_observer(*self._truth)
            except RefusedError as problem:
                log.warning("no picture for the observer: %s", problem)
            except Exception:
                log.exception("no picture for the observer")
                period = QUERY_PERIOD
        done = self._clock.now()
        # Slow rendering of the observer's pictures takes at most half of the time.
        self._observe_due = max(self._observe_due + period, done + (done - now))
        return self._observe_due - done

    def _publish_observer(self, time: float, truth: Truth) -> None:
        if self._observed == (time, self._view):
            return
        self._observed = (time, self._view)
        pixels = self._ready_scene().render_observer(time, truth, self._view, *OBSERVER_SIZE, self._card)
        _, jpeg = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
        payload = row(time, jpeg.tobytes())
        block = Block.of(OBSERVER, 1, self._observer_number, payload)
        self._observer_number += 1
        self._messages.publish(OBSERVER.name, block.data)

    def _ready_scene(self) -> "SceneRenderer":
        """Return the renderer with the present contents. Raise RefusedError if nothing can be rendered."""
        self._query_surroundings()
        if self._problem is not None:
            raise RefusedError(self._problem)
        with self._lock:
            contents = self._contents
        if self._scene is None:
            self._scene = self._make(contents)
        elif self._scene.contents != contents:
            self._scene.fill(contents)
        return self._scene

    def _make(self, contents: Contents) -> "SceneRenderer":
        try:
            # Imported here, because it loads MuJoCo and OpenGL.
            from robot_runtime.simulation.scene.scene import SceneRenderer

            return SceneRenderer(contents, SimulationParameters())
        except Exception as problem:
            # PyOpenGL and MuJoCo raise ImportError, AttributeError, RuntimeError and others.
            log.exception("the scene cannot be rendered")
            self._problem = (
                f"OpenGL does not start ({problem}); "
                "“sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri” adds what renders on a CPU"
            )
            raise RefusedError(self._problem) from problem

    def _query_surroundings(self) -> None:
        """Query floor, walls and beacons from the simulator; without an answer they stay as they are."""
        now = self._clock.now()
        if now - self._queried < QUERY_PERIOD:
            return
        self._queried = now
        try:
            answer = self._messages.query("simulator/surroundings", {}, QUERY_TIMEOUT)
            basin = parse(Basin, answer["world"])
            beacons = tuple((north, east, down) for north, east, down in answer["beacons"]["positions"])
            check_beacons(beacons)
        except (NoAnswerError, RefusedError):
            return
        except (ConfigError, KeyError, TypeError, ValueError) as problem:
            log.warning("the simulator sent invalid surroundings: %s", problem)
            return
        with self._lock:
            self._contents = replace(self._contents, basin=basin, beacons=beacons)
