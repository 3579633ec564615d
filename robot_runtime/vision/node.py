"""The vision node: a thread that looks, searches for the wanted colour, and tells what it found."""

import importlib
import logging
import threading
from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING

from robot_runtime.clock import Clock
from robot_runtime.config import ConfigError, VisionConfig
from robot_runtime.errors import Refused
from robot_runtime.messages import Messages
from robot_runtime.samples import Detection, Event, Severity
from robot_runtime.vision.camera import Camera, CameraError, Frame
from robot_runtime.vision.colours import parse_colours
from robot_runtime.vision.pace import Pace

if TYPE_CHECKING:
    from robot_runtime.vision.detector import Detector

log = logging.getLogger(__name__)

RETRY = 2.0
"""s between two attempts to open a camera that failed."""
THUMBNAIL_SECONDS = 2.0
"""s between two small pictures for recordings. The runtime does not know whether anything records."""


class Vision:
    """Looks at a settable rate, in a thread of its own that no camera can end.

    Every picture gives one Detection: of the wanted colour if it is there, else of the largest patch of
    another colour, else of none. Only while `picture_wanted` says that somebody watches is the picture itself
    handed on, with its time (s), as a JPEG file; a small one is every `THUMBNAIL_SECONDS`. All callbacks run
    on the node's thread. The camera "scene" is asked through `messages`. Raises ConfigError where the
    configuration's colours cannot be used.
    """

    def __init__(
        self,
        config: VisionConfig,
        clock: Clock,
        on_detection: Callable[[Detection], None],
        on_picture: Callable[[float, bytes], None],
        picture_wanted: Callable[[], bool],
        tell: Callable[[Event], None],
        open_camera: Callable[[], Camera] | None = None,
        messages: Messages | None = None,
        on_thumbnail: Callable[[float, bytes], None] | None = None,
    ) -> None:
        self.colours = parse_colours(config.colours)
        if config.colour not in self.colours:
            raise ConfigError(
                f"vision: colour is {config.colour!r}; it must be one of {', '.join(self.colours)}"
            )
        self.colour = config.colour
        """The wanted colour, one of `colours`."""
        self.area_min = config.area_min
        """Share of the picture that a patch must have."""
        self.card: str | None = None
        """The colour of the card before the camera."""
        self._config = config
        self._clock = clock
        self._on_detection = on_detection
        self._on_picture = on_picture
        self._on_thumbnail = on_thumbnail
        self._thumbnail_due = -inf
        self._picture_wanted = picture_wanted
        self._tell = tell
        self._messages = messages
        self._open_camera = open_camera or self._configured_camera
        self._pace = Pace(clock, config.rate)
        self._detector: Detector | None = None
        self._camera: Camera | None = None
        self._failure: str | None = None
        self._failing_since: float | None = None
        self._retry_at = clock.now()
        self._ending = False
        self._wake = threading.Event()
        self._thread = threading.Thread(target=self._run, name="vision", daemon=True)

    @property
    def rate(self) -> float:
        """Pictures a second. Raises ValueError when it is set below 0.2 or above 30."""
        return self._pace.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._pace.rate = rate
        self._wake.set()

    @property
    def text(self) -> str:
        """The camera in words, or what is wrong with it."""
        if self._failure is not None:
            return f"no picture: {self._failure}"
        return str(self._camera) if self._camera else "starting"

    def show_card(self, colour: str | None) -> None:
        """Show a card of this colour, or none. Raises Refused where that cannot be."""
        if self._config.camera not in ("card", "scene"):
            raise Refused(
                f"the camera is {self._config.camera!r}; cards are shown to the cameras 'scene' and 'card' "
                "alone: choose one in robot.toml, [vision] camera"
            )
        if colour is not None and colour not in self.colours:
            raise Refused(f"there is no card of colour {colour!r}; there are {', '.join(self.colours)}")
        self.card = colour

    def start(self) -> None:
        """Begin to look."""
        self._thread.start()

    def close(self) -> None:
        """Stop looking and give the camera back."""
        self._ending = True
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(timeout=RETRY)

    def look(self) -> None:
        """Take one picture, search it, and tell; report a camera that gives none, and try it again later."""
        try:
            frame = self._take()
        except CameraError as problem:
            self._fail(str(problem), problem.patience)
        except Exception as problem:
            log.exception("the camera failed")
            self._fail(f"the camera failed ({problem}); the log says more")
        else:
            if frame is not None:
                self._examine(frame)

    def tick(self) -> float:
        """Look where that is due; s until it will be, 0 where it was."""
        remaining = self._pace.remaining()
        if remaining > 0:
            return remaining
        self._pace.begin()
        try:
            self.look()
        except Exception:
            log.exception("a picture could not be searched")
        return 0.0

    def _run(self) -> None:
        # Here, so that the first picture is not late for it.
        importlib.import_module("robot_runtime.vision.looking")
        while not self._ending:
            remaining = self.tick()
            if remaining > 0:
                self._wake.wait(remaining)
                self._wake.clear()
        self._drop_camera()

    def _take(self) -> Frame | None:
        """The newest picture; None while a camera that failed is left alone."""
        if self._camera is None:
            if self._clock.now() < self._retry_at:
                return None
            self._camera = self._open_camera()
        frame = self._camera.read()
        self._failing_since = None
        if self._failure is not None:
            self._failure = None
            self._report("info", f"Camera: {self.text}.")
        return frame

    def _examine(self, frame: Frame) -> None:
        # Loads NumPy and OpenCV, which takes longest of all at a start; the robot is in hand before that.
        from robot_runtime.vision import looking

        if self._detector is None:
            self._detector = looking.Detector(self.colours, self.area_min)
        self._detector.area_min = self.area_min
        begun = self._clock.now()
        patch = self._detector.find(frame.picture, self.colour)
        ended = self._clock.now()
        self._on_detection(
            Detection(
                time=ended,
                taken=frame.taken,
                colour=patch.colour if patch else None,
                box=patch.box if patch else None,
                area=patch.area if patch else 0.0,
                processing=ended - begun,
            )
        )
        if self._picture_wanted():
            self._on_picture(frame.taken, looking.as_jpeg(frame.picture))
        if self._on_thumbnail is not None and frame.taken >= self._thumbnail_due:
            self._thumbnail_due = frame.taken + THUMBNAIL_SECONDS
            self._on_thumbnail(frame.taken, looking.as_thumbnail(frame.picture))

    def _fail(self, text: str, patience: float = 0.0) -> None:
        self._drop_camera()
        now = self._clock.now()
        self._retry_at = now + RETRY
        if self._failing_since is None:
            self._failing_since = now
        if text != self._failure and now - self._failing_since >= patience:
            self._failure = text
            self._report("caution", f"Camera: {text}. It is tried again every {RETRY:g} s.")

    def _report(self, severity: Severity, text: str) -> None:
        self._tell(Event(time=self._clock.now(), kind="camera", severity=severity, text=text))

    def _drop_camera(self) -> None:
        camera, self._camera = self._camera, None
        if camera is not None:
            try:
                camera.close()
            except Exception:
                log.exception("a camera could not be closed")

    def _configured_camera(self) -> Camera:
        from robot_runtime.vision.looking import open_camera

        def tell_missing(why: str) -> None:
            self._report("caution", f"Camera: the scene cannot be rendered: {why}. A drawn card stands in.")

        return open_camera(
            self._config, self._clock, self._messages, self.colours, lambda: self.card, tell_missing
        )
