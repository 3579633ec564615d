"""The vision node: it takes pictures, searches them, and publishes detections."""

import importlib
import logging
from base64 import b64encode
from collections.abc import Callable
from dataclasses import asdict, fields, replace
from math import inf
from typing import TYPE_CHECKING, Any

from robot_runtime.clock import Clock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.commands import FilmCommand, FilmQuality
from robot_runtime.contract.documents import Detection, Event, Severity
from robot_runtime.contract.limits import VISION_RATE
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.topics import BALANCED, CAMERA, MASK, PICTURE, Topic
from robot_runtime.errors import RefusedError
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame, SensorControls
from robot_runtime.vision.interface import NO_PICTURE, STARTING, Vision, VisionOutputs
from robot_runtime.vision.sightings import Sightings
from robot_runtime.vision.stream_quality import BYTES_MAX, STEPS, StreamQuality

if TYPE_CHECKING:
    from robot_runtime.transport.zenoh_transport import ZenohTransport
    from robot_runtime.vision.cards import CameraCard
    from robot_runtime.vision.detector import Detector, Sight
    from robot_runtime.vision.film import FilmCoder
    from robot_runtime.vision.picture import Picture
    from robot_runtime.vision.repetition import PictureRepetition

log = logging.getLogger(__name__)

RETRY = 2.0
"""s between two attempts to open a camera that failed."""
THUMBNAIL_SECONDS = 2.0
"""s between two small pictures, which are always published for recordings."""
REAL_CAMERAS = ("pi", "usb")
"""Cameras with noise: one that repeats its picture hangs. A still file or calm drawn water may repeat one."""
SNAPSHOT_AGE = 2.0
"""s; an older picture is no snapshot of what is seen now."""
_OPENCV_MEMORY = -4
"""OpenCV's code where an allocation fails."""


class RateTimer:
    """A periodic timer of `rate` Hz, which may change at any time. Late periods are skipped."""

    def __init__(self, clock: Clock, rate: float) -> None:
        self._clock = clock
        self.rate = rate
        self._last = clock.now() - 1 / self.rate

    @property
    def rate(self) -> float:
        """The rate, Hz. Setting it raises ValueError outside VISION_RATE."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        low, high = VISION_RATE.minimum, VISION_RATE.maximum
        if not low <= rate <= high:
            raise ValueError(f"a vision rate of {rate} Hz is not between {low:g} and {high:g} Hz")
        self._rate = rate

    def remaining(self) -> float:
        """Return s until the next period is due; 0 or less if it is due now."""
        return self._last + 1 / self._rate - self._clock.now()

    def begin(self) -> None:
        """Record that the due period begins now."""
        period, now = 1 / self._rate, self._clock.now()
        self._last = self._last + period if now < self._last + 2 * period else now


class VisionNode(Vision):
    """The search of pictures at a settable rate, and the camera's stream while somebody watches it.

    It survives a failing camera. Its owner calls `tick`. Every searched picture gives one Detection: of the
    target colour, else of a target with an action, else of the largest patch of another colour, else an empty
    one. A thumbnail follows every `THUMBNAIL_SECONDS`. The camera "scene" is queried through what `connect`
    opens, which may raise CameraError; `open_camera` replaces the configured one.
    """

    def __init__(
        self,
        config: VisionConfig,
        clock: Clock,
        outputs: VisionOutputs,
        open_camera: Callable[[], Camera] | None = None,
        connect: "Callable[[], ZenohTransport] | None" = None,
    ) -> None:
        super().__init__(config, outputs)
        self.shown_card: CameraCard | None = None
        """The card that is shown to the camera."""
        self._clock = clock
        self._thumbnail_due = -inf
        self._frame: CameraFrame | None = None
        self._newest: CameraFrame | None = None
        self._snapshot_taken = -inf
        self._connect = connect
        self._open_camera = open_camera or self._configured_camera
        self._timer = RateTimer(clock, config.rate)
        self._stream_timer = RateTimer(clock, config.stream_rate)
        self._quality = StreamQuality(config.stream_rate)
        self._film_timer = RateTimer(clock, config.stream_rate)
        self._film_until = -inf
        self._filmed = -inf
        self._film_quality: FilmQuality = "medium"
        self._film_coder: FilmCoder | None = None
        self._detector: Detector | None = None
        self._sightings = Sightings()
        self._repetition: PictureRepetition | None = None
        self._camera: Camera | None = None
        self._opened_for = self._device_settings
        self._failure: str | None = None
        self._failing_since: float | None = None
        self._retry_at = clock.now()

    @property
    def text(self) -> str:
        """The description of the camera, or of its failure."""
        if self._failure is not None:
            return f"{NO_PICTURE}{self._failure}"
        return str(self._camera) if self._camera else STARTING

    def pick(self, question: dict[str, Any]) -> dict[str, Any]:
        """Return the colour range around a point of the newest picture, after the white balance.

        With its `share` of the picture, and the `mask` that it would have: a JPEG file, in base64.
        """
        if self.missing:
            raise RefusedError(f"There is no picture to pick a colour in. Camera: {self.text}.")
        from robot_runtime.vision.pipeline import BALANCES, PickPoint, as_jpeg, draw_preview, propose

        point = parse(PickPoint, question)
        frame = self._frame
        if frame is None:
            raise RefusedError(f"There is no picture to pick a colour in. Camera: {self.text}.")
        balanced = BALANCES[self._settings.white_balance](frame.picture)
        proposal = propose(balanced, point)
        mask = as_jpeg(draw_preview(balanced, proposal.colour, self._settings))
        return {**asdict(proposal), "mask": b64encode(mask).decode()}

    def take_snapshot(self) -> dict[str, Any]:
        """Send the newest picture at full size to the outputs; return its `time` (s, steady clock)."""
        frame = self._newest
        if self.missing or frame is None:
            raise RefusedError(f"There is no picture to take. Camera: {self.text}.")
        from robot_runtime.vision.pipeline import as_snapshot

        age = self._clock.now() - frame.taken
        if age > max(SNAPSHOT_AGE, 2 / self._settings.rate):
            raise RefusedError(
                f"The camera's newest picture is {age:.0f} s old. Take the snapshot when new ones come."
            )
        if frame.taken == self._snapshot_taken:
            raise RefusedError("This picture is a snapshot already, and the camera has sent no newer one.")
        self._snapshot_taken = frame.taken
        self._outputs.snapshot(frame.taken, frame.original or as_snapshot(frame.picture))
        return {"time": frame.taken}

    def film(self, command: FilmCommand) -> None:
        """Film for `command.seconds` from now on, at its rate, which is the stream's at most, and quality."""
        rate = min(command.rate, self._config.stream_rate)
        self._film_until = self._clock.now() + command.seconds
        if (rate, command.quality) != (self._film_timer.rate, self._film_quality):
            self._film_timer = RateTimer(self._clock, rate)
            self._film_quality = command.quality
            self._film_coder = None

    def refusals(self) -> list[str]:
        """Return nothing: a camera is no reason against arming."""
        return []

    def start(self) -> None:
        """Import OpenCV before the first picture, so that the first picture is not late."""
        try:
            importlib.import_module("robot_runtime.vision.pipeline")
        except MemoryError:
            raise
        except Exception as problem:  # a NumPy that does not fit raises ValueError or AttributeError
            log.warning("OpenCV cannot be loaded", exc_info=True)
            self.missing = self._failure = (
                f"NumPy and OpenCV cannot be loaded ({problem}); install them (Debian: sudo apt install "
                "python3-opencv), then start again. All but the camera works without"
            )
            self._report("caution", f"Camera: {self.missing}.")

    def close(self) -> None:
        """Release the camera."""
        self._drop_camera()

    def process_picture(self, search: bool = True, stream: bool = False, film: bool = False) -> None:
        """Take a picture to search, stream or film, or drop it.

        A failing camera is reported and retried later.

        Raise MemoryError where memory is exhausted: trying again does not help.
        """
        began = self._clock.now()
        try:
            frame = self._take(search, stream, film)
        except CameraError as problem:
            self._fail(str(problem), problem.patience)
        except Exception as problem:
            if _lacks_memory(problem):
                raise MemoryError(str(problem)) from problem
            log.exception("the camera failed")
            self._fail(f"the camera failed ({problem}); the log says more")
        else:
            if self._camera is not None and self._camera.rate is not None:
                # Waiting for a device's next picture is no work.
                began = self._clock.now()
            if frame is not None and search:
                self._examine(frame)
            if frame is not None and stream:
                self._send_stream(frame, began)
            if frame is not None and film:
                self._send_film(frame)

    def tick(self) -> float:
        """Process a picture if it is due and return 0; otherwise return the time (s) until then.

        Raise MemoryError.
        """
        stream = self._outputs.watched(CAMERA)
        film = self._clock.now() < self._film_until
        if not film:
            # The next film begins with a key picture.
            self._film_coder = None
        # A device keeps its oldest pictures, if nobody takes them.
        device = self._camera is not None and self._camera.rate is not None
        timers = [self._timer]
        timers += [self._stream_timer] if stream or device else []
        timers += [self._film_timer] if film else []
        remaining = min(timer.remaining() for timer in timers)
        if remaining > 0:
            return remaining
        # One picture serves both where they are nearly due together.
        slack = 0.5 / max(timer.rate for timer in timers)
        due = [timer for timer in timers if timer.remaining() <= slack]
        for timer in due:
            timer.begin()
        try:
            self.process_picture(
                self._timer in due, stream and self._stream_timer in due, self._film_timer in due
            )
        except Exception as problem:
            if _lacks_memory(problem):
                raise MemoryError(str(problem)) from problem
            log.exception("a picture could not be processed")
        return 0.0

    def _size(self, stream: bool, film: bool) -> tuple[int, int]:
        """Return the width and height of a picture for these, or for the search alone."""
        width, height = self._config.stream_size
        scale = 1.0 if film else self._quality.step.scale if stream else 0.0
        return max(self._config.size, (round(width * scale), round(height * scale)))

    def _take(self, search: bool, stream: bool, film: bool) -> CameraFrame | None:
        """Return the newest picture, turned; None if it is dropped, or a failed camera is not tried yet.

        It is large enough for stream and film, or of the size that is searched.
        """
        is_device = self._camera is not None and self._camera.rate is not None
        if is_device and self._opened_for != self._device_settings:
            self._drop_camera()
        if self._camera is None:
            if self._clock.now() < self._retry_at:
                return None
            self._opened_for = self._device_settings
            self._camera = self._open_camera()
        if not (search or stream or film):
            self._camera.skip()
            return None
        from robot_runtime.vision import pipeline

        settings, size = self._settings, self._size(stream, film)
        self._camera.size = pipeline.before_turn(size, settings.turn)
        frame = self._camera.read()
        self._check_repetition(frame)
        if settings.turn or settings.mirror:
            frame = CameraFrame(pipeline.turn(frame.picture, settings.turn, settings.mirror), frame.taken)
        elif search or film or not self._own_jpeg(frame):
            # Decoded here: a damaged picture is a failure of the camera.
            _ = frame.picture
        self._failing_since = None
        if self._failure is not None:
            self._failure = None
            self._report("info", f"Camera: {self.text}.")
        self._newest = frame
        return frame

    def _send_stream(self, frame: CameraFrame, began: float) -> None:
        """Send a picture of the stream, which was begun at `began` (s)."""
        from robot_runtime.vision import pipeline

        jpeg = self._own_jpeg(frame) or pipeline.as_stream(
            frame.picture, self._config.stream_size, self._quality.step
        )
        self._outputs.picture(CAMERA, frame.taken, jpeg)
        now = self._clock.now()
        self._quality.take(now, now - began, len(jpeg))

    def _send_film(self, frame: CameraFrame) -> None:
        """Send a picture of the film, unless the camera has given it already."""
        if frame.taken <= self._filmed:
            return
        self._filmed = frame.taken
        if self._film_coder is None:
            from robot_runtime.vision.film import open_coder

            rate, size = self._film_timer.rate, self._config.stream_size
            self._film_coder = open_coder(rate, self._film_quality, size)
        self._outputs.film(frame.taken, self._film_coder.code(frame.taken, frame.picture))

    def _own_jpeg(self, frame: CameraFrame) -> bytes | None:
        """Return the camera's own JPEG file of a picture if the stream can send it unchanged, else None."""
        fits = self._camera is not None and self._camera.size == self._config.stream_size
        if frame.jpeg is None or not fits or self._quality.step != STEPS[0]:
            return None
        return frame.jpeg if len(frame.jpeg) <= BYTES_MAX else None

    @property
    def _device_settings(self) -> tuple[float, bool, SensorControls]:
        """Rate, shape and controls that a device is opened for; where they change, it is opened again."""
        now = self._settings
        controls = SensorControls(now.exposure, now.gain, now.colour_temperature)
        return max(now.rate, self._config.stream_rate), now.turn in (90, 270), controls

    def _check_repetition(self, frame: CameraFrame) -> None:
        """Raise CameraError where a real camera repeats one picture for ever, also after a reopening."""
        if self._config.camera not in REAL_CAMERAS:
            return
        if self._repetition is None:
            from robot_runtime.vision.repetition import PictureRepetition

            self._repetition = PictureRepetition()
        if self._repetition.repeats(frame, self._clock.now()):
            raise CameraError("the camera repeats one picture: it hangs, or its lens is covered")

    def _examine(self, frame: CameraFrame) -> None:
        # Imports NumPy and OpenCV, the slowest part of the start.
        from robot_runtime.vision import pipeline

        frame = CameraFrame(pipeline.fit(frame.picture, *self._config.size), frame.taken)
        settings = self._settings
        if self._detector is None or self._detector.settings is not settings:
            self._detector = pipeline.Detector(settings)
        begun = self._clock.now()
        sight = self._detector.search(frame.picture)
        ended = self._clock.now()
        self._frame = frame
        self._sightings.add(sight.names, frame.taken)
        confirmed = self._sightings.confirmed(*settings.confirmation)
        target = pipeline.choose_target(settings, confirmed)
        patch = sight.patch
        self._outputs.detection(
            Detection(
                time=ended,
                taken=frame.taken,
                colour=sight.colour,
                box=patch.box if patch else None,
                area=patch.area if patch else 0.0,
                processing=ended - begun,
                candidates=list(sight.target_patches.candidates),
                markers=sight.markers,
                confirmed=confirmed,
                target=target,
                set_point=None if target is None else settings.actions.get(target),
            )
        )
        self._pass_on(frame, sight)
        if frame.taken >= self._thumbnail_due:
            self._thumbnail_due = frame.taken + THUMBNAIL_SECONDS
            self._outputs.thumbnail(frame.taken, pipeline.as_thumbnail(frame.picture))

    def _pass_on(self, frame: CameraFrame, sight: "Sight") -> None:
        from robot_runtime.vision import pipeline

        made: dict[Topic[bytes], Callable[[], Picture]] = {
            PICTURE: lambda: frame.picture,
            MASK: lambda: pipeline.draw_mask(sight.target_patches),
            BALANCED: lambda: sight.balanced,
        }
        for topic, make in made.items():
            if self._outputs.watched(topic):
                self._outputs.picture(topic, frame.taken, pipeline.as_jpeg(make()))

    def _fail(self, text: str, patience: float = 0.0) -> None:
        self._drop_camera()
        self._frame = self._newest = None
        now = self._clock.now()
        self._retry_at = now + RETRY
        if self._failing_since is None:
            self._failing_since = now
        if text != self._failure and now - self._failing_since >= patience:
            self._failure = text
            self._report("caution", f"Camera: {text}. It is tried again every {RETRY:g} s.")

    def _report(self, severity: Severity, text: str) -> None:
        self._outputs.event(Event(time=self._clock.now(), kind="camera", severity=severity, text=text))

    def _drop_camera(self) -> None:
        camera, self._camera = self._camera, None
        if camera is not None:
            try:
                camera.close()
            except Exception:
                log.exception("a camera could not be closed")

    def _apply_settings(self) -> None:
        self._timer.rate = self._settings.rate

    def _apply_card(self) -> None:
        from robot_runtime.vision.pipeline import make_card

        self.shown_card = None if self.card is None else make_card(self.card, self._settings.colours)

    def _configured_camera(self) -> Camera:
        from robot_runtime.vision.pipeline import open_camera

        def report_missing(why: str) -> None:
            self._report("caution", f"Camera: the scene cannot be rendered: {why}. A drawn card stands in.")

        settings = {field.name: getattr(self._settings, field.name) for field in fields(self._settings)}
        config = replace(self._config, **settings)
        return open_camera(config, self._clock, self._connect, lambda: self.shown_card, report_missing)


def _lacks_memory(problem: Exception) -> bool:
    """Return True for an allocation that failed, in Python, NumPy or OpenCV."""
    return isinstance(problem, MemoryError) or getattr(problem, "code", None) == _OPENCV_MEMORY
