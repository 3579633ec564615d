"""The vision node: a thread that takes pictures, searches them, and publishes detections."""

import importlib
import logging
import threading
from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Any

from robot_runtime.clock import Clock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.card_colours import MARKER_CARD, PAINTS
from robot_runtime.contract.documents import Detection, Event, Severity
from robot_runtime.contract.limits import VISION_RATE
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings, marker_name
from robot_runtime.errors import RefusedError
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame

if TYPE_CHECKING:
    from robot_runtime.vision.cards import CameraCard
    from robot_runtime.vision.colour_picker import ColourProposal
    from robot_runtime.vision.detector import Detector, Sight
    from robot_runtime.vision.picture import Picture

log = logging.getLogger(__name__)

RETRY = 2.0
"""s between two attempts to open a camera that failed."""
THUMBNAIL_SECONDS = 2.0
"""s between two small pictures, which are always published for recordings."""


class RateTimer:
    """A periodic timer of `rate` Hz, which may change at any time. Late periods are skipped."""

    def __init__(self, clock: Clock, rate: float) -> None:
        self._clock = clock
        self.rate = rate
        self._last = clock.now() - 1 / self.rate

    @property
    def rate(self) -> float:
        """Hz. Setting it raises ValueError outside VISION_RATE."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        low, high = VISION_RATE.minimum, VISION_RATE.maximum
        if not low <= rate <= high:
            raise ValueError(f"a vision rate of {rate} Hz is not between {low:g} and {high:g} Hz")
        self._rate = rate

    def remaining(self) -> float:
        """Returns s until the next period is due; 0 or less if it is due now."""
        return self._last + 1 / self._rate - self._clock.now()

    def begin(self) -> None:
        """Records that the due period begins now."""
        period, now = 1 / self._rate, self._clock.now()
        self._last = self._last + period if now < self._last + 2 * period else now


class VisionNode:
    """Searches pictures at a settable rate, in a thread of its own that survives failures of the camera.

    Every picture gives one Detection: of the target colour, else of a target with an action, else of the
    largest patch of another colour, else an empty one. While `watched` is true of "picture", "mask" or
    "balanced", that picture is passed on with its time (s) as a JPEG file; a small picture is passed on
    every `THUMBNAIL_SECONDS`. All callbacks run on the node's thread. The camera "scene" is queried through
    `messages`.
    """

    def __init__(
        self,
        config: VisionConfig,
        clock: Clock,
        on_detection: Callable[[Detection], None],
        on_picture: Callable[[str, float, bytes], None],
        watched: Callable[[str], bool],
        on_event: Callable[[Event], None],
        open_camera: Callable[[], Camera] | None = None,
        messages: ZenohTransport | None = None,
        on_thumbnail: Callable[[float, bytes], None] | None = None,
    ) -> None:
        self.shown_card: CameraCard | None = None
        """The card that is shown to the camera."""
        self._config = config
        self._settings = config.settings
        self._clock = clock
        self._on_detection = on_detection
        self._on_picture = on_picture
        self._on_thumbnail = on_thumbnail
        self._thumbnail_due = -inf
        self._watched = watched
        self._frame: CameraFrame | None = None
        self._on_event = on_event
        self._messages = messages
        self._open_camera = open_camera or self._configured_camera
        self._timer = RateTimer(clock, config.rate)
        self._detector: Detector | None = None
        self._camera: Camera | None = None
        self._failure: str | None = None
        self._missing = ""
        self._loading = False
        self._failing_since: float | None = None
        self._retry_at = clock.now()
        self._ending = False
        self._wake = threading.Event()
        self._thread = threading.Thread(target=self._run, name="vision", daemon=True)

    @property
    def settings(self) -> VisionSettings:
        """The settings in force; new ones apply, all together, from the next picture on."""
        return self._settings

    @settings.setter
    def settings(self, settings: VisionSettings) -> None:
        self._settings = settings
        self._timer.rate = settings.rate
        self._wake.set()

    @property
    def card(self) -> str | None:
        """The name of the card that is shown to the camera."""
        return self.shown_card.name if self.shown_card else None

    @property
    def cards(self) -> list[str]:
        """The names of the cards that can be shown to the camera."""
        if self._config.camera not in ("card", "scene"):
            return []
        return [*dict.fromkeys([*PAINTS, *self._settings.colours]), marker_name(MARKER_CARD)]

    @property
    def text(self) -> str:
        """Description of the camera, or of its failure."""
        if self._failure is not None:
            return f"no picture: {self._failure}"
        return str(self._camera) if self._camera else "starting"

    def show_card(self, colour: str | None) -> None:
        """Shows this card, or none. Raises RefusedError for another camera or an unknown card."""
        if self._config.camera not in ("card", "scene"):
            raise RefusedError(
                f"the camera is {self._config.camera!r}; cards are shown to the cameras 'scene' and 'card' "
                "alone: choose one in robot.toml, [vision] camera"
            )
        if colour is not None and colour not in self.cards:
            raise RefusedError(f"there is no card of colour {colour!r}; there are {', '.join(self.cards)}")
        if colour is None:
            self.shown_card = None
        elif self._missing:
            raise RefusedError(f"there is no picture: {self._missing}")
        else:
            from robot_runtime.vision.pipeline import make_card

            self.shown_card = make_card(colour, self._settings.colours)

    def pick(self, question: dict[str, Any]) -> "ColourProposal":
        """Returns the colour range around a point of the newest picture, after the white balance.

        `question` is a `PickPoint` as a table. No setting changes. Raises RefusedError, ConfigError.
        """
        if self._missing:
            raise RefusedError(f"There is no picture to pick a colour in. Camera: {self.text}.")
        from robot_runtime.vision.pipeline import BALANCES, PickPoint, propose

        place = parse(PickPoint, question)
        frame = self._frame
        if frame is None:
            raise RefusedError(f"There is no picture to pick a colour in. Camera: {self.text}.")
        return propose(BALANCES[self._settings.white_balance](frame.picture), place)

    def refusals(self) -> list[str]:
        """Returns the reason against arming while OpenCV is loaded: a slow computer then holds up control."""
        return ["The camera's software is being loaded. Wait a moment."] if self._loading else []

    def start(self) -> None:
        """Starts the thread."""
        self._loading = True
        self._thread.start()

    def close(self) -> None:
        """Ends the thread and releases the camera."""
        self._ending = True
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(timeout=RETRY)

    def process_picture(self) -> None:
        """Takes, searches and publishes one picture; a failing camera is reported and retried later."""
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
        """Processes a picture if one is due and returns 0; otherwise returns the s until then."""
        remaining = self._timer.remaining()
        if remaining > 0:
            return remaining
        self._timer.begin()
        try:
            self.process_picture()
        except Exception:
            log.exception("a picture could not be processed")
        return 0.0

    def _run(self) -> None:
        is_loaded = self._load()
        self._loading = False
        if not is_loaded:
            return
        while not self._ending:
            remaining = self.tick()
            if remaining > 0:
                self._wake.wait(remaining)
                self._wake.clear()
        self._drop_camera()

    def _load(self) -> bool:
        """Imports OpenCV before the first picture, so that this one is not late; False where it cannot."""
        try:
            importlib.import_module("robot_runtime.vision.pipeline")
        except Exception as problem:  # a NumPy that does not fit raises ValueError or AttributeError
            log.warning("OpenCV cannot be loaded", exc_info=True)
            self._missing = (
                f"NumPy and OpenCV cannot be loaded ({problem}); install them (Debian: sudo apt install "
                "python3-opencv), then start again. All but the camera works without"
            )
            self._failure = self._missing
            self._report("caution", f"Camera: {self._missing}.")
            return False
        return True

    def _take(self) -> CameraFrame | None:
        """Returns the newest picture; None until a failed camera is to be tried again."""
        if self._camera is not None and self._camera.rate not in (None, self._settings.rate):
            self._drop_camera()
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

    def _examine(self, frame: CameraFrame) -> None:
        # Imports NumPy and OpenCV, the slowest part of the start; the robot is under control before that.
        from robot_runtime.vision import pipeline

        settings = self._settings
        if self._detector is None or self._detector.settings is not settings:
            self._detector = pipeline.Detector(settings)
        begun = self._clock.now()
        sight = self._detector.search(frame.picture)
        ended = self._clock.now()
        self._frame = frame
        patch = sight.patch
        self._on_detection(
            Detection(
                time=ended,
                taken=frame.taken,
                colour=sight.colour,
                box=patch.box if patch else None,
                area=patch.area if patch else 0.0,
                processing=ended - begun,
                candidates=list(sight.target_patches.candidates),
                markers=sight.markers,
                target=sight.target,
                set_point=sight.set_point,
            )
        )
        self._pass_on(frame, sight)
        if self._on_thumbnail is not None and frame.taken >= self._thumbnail_due:
            self._thumbnail_due = frame.taken + THUMBNAIL_SECONDS
            self._on_thumbnail(frame.taken, pipeline.as_thumbnail(frame.picture))

    def _pass_on(self, frame: CameraFrame, sight: "Sight") -> None:
        from robot_runtime.vision import pipeline

        made: dict[str, Callable[[], Picture]] = {
            "picture": lambda: frame.picture,
            "mask": lambda: pipeline.draw_mask(sight.target_patches),
            "balanced": lambda: sight.balanced,
        }
        for topic, make in made.items():
            if self._watched(topic):
                self._on_picture(topic, frame.taken, pipeline.as_jpeg(make()))

    def _fail(self, text: str, patience: float = 0.0) -> None:
        self._drop_camera()
        self._frame = None
        now = self._clock.now()
        self._retry_at = now + RETRY
        if self._failing_since is None:
            self._failing_since = now
        if text != self._failure and now - self._failing_since >= patience:
            self._failure = text
            self._report("caution", f"Camera: {text}. It is tried again every {RETRY:g} s.")

    def _report(self, severity: Severity, text: str) -> None:
        self._on_event(Event(time=self._clock.now(), kind="camera", severity=severity, text=text))

    def _drop_camera(self) -> None:
        camera, self._camera = self._camera, None
        if camera is not None:
            try:
                camera.close()
            except Exception:
                log.exception("a camera could not be closed")

    def _configured_camera(self) -> Camera:
        from robot_runtime.vision.pipeline import open_camera

        def report_missing(why: str) -> None:
            self._report("caution", f"Camera: the scene cannot be rendered: {why}. A drawn card stands in.")

        config = replace(self._config, rate=self._settings.rate)
        return open_camera(config, self._clock, self._messages, lambda: self.shown_card, report_missing)
