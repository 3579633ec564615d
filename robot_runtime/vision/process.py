"""Vision in a process of its own: a decoder that crashes, hangs or eats memory never touches control.

The process is started with one end of a pair of sockets as its standard input, and nothing else of this
process. It ends when the other end is closed, and in every case with this process.
"""

import itertools
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import asdict, replace
from functools import partial
from math import inf
from pathlib import Path
from signal import SIGKILL, Signals
from socket import socketpair
from typing import Any

from robot_runtime.backoff import Backoff, describe_pause, is_killed
from robot_runtime.clock import Clock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.commands import FilmCommand
from robot_runtime.contract.documents import Detection, Event, Severity
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.topics import WATCHABLE
from robot_runtime.errors import RefusedError
from robot_runtime.vision.interface import NO_PICTURE, STARTING, Vision, VisionOutputs
from robot_runtime.vision.messages import MessageError, MessageSocket, VisionMessage

log = logging.getLogger(__name__)

PROGRAM = (sys.executable, "-m", "robot_runtime.vision")
BYTES_MAX = 300_000_000
"""Of the vision process's own memory."""
EXHAUSTED = 3
"""Exit status of the vision process where an allocation failed."""
ALIVE_SECONDS = 2.0
"""s after which the vision process reports the camera, if it has sent nothing else."""
SILENT_SECONDS = 8.0
"""s of silence after which the camera counts as failing."""
HUNG_SECONDS = 20.0
"""s of silence after which the process is ended; the first picture of a scene may take 16 s."""
LOAD_SECONDS = 300.0
"""s that loading OpenCV may take on a slow card."""
STEADY_SECONDS = 10.0
"""s of life after which a crash counts as past."""
ANSWER_SECONDS = 1.5
"""s that a picked colour or a snapshot may take; the server waits for 2 s."""
_END_SECONDS = 2.0
"""s that the process has for its end."""
_PICTURES = {topic.name: topic for topic in WATCHABLE.values() if topic.sender == "runtime"}
_ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}
"""NumPy's matrices are not used: their threads would take 90 MB of room for each processor, and time."""


class VisionProcess(Vision):
    """The vision node in a process of its own, which a thread starts, watches and replaces.

    `endpoint` of the robot's Zenoh is where the process reaches the camera "scene".
    """

    def __init__(
        self,
        config: VisionConfig,
        clock: Clock,
        outputs: VisionOutputs,
        robot: str,
        endpoint: str,
        program: Sequence[str] = PROGRAM,
    ) -> None:
        super().__init__(config, outputs)
        self._clock = clock
        self._zenoh = {"robot": robot, "endpoint": endpoint}
        self._program = program
        self._camera = STARTING
        self._failure = ""
        self._failure_reported = False
        self._loading = False
        self._load_seconds = 0.0
        self._numbers = itertools.count()
        self._asked: dict[int, Future[dict[str, Any]]] = {}
        self._watched: list[str] = []
        self._film, self._film_until = FilmCommand(seconds=0.0), -inf
        self._lock = threading.Lock()
        self._child: subprocess.Popen[bytes] | None = None
        self._messages: MessageSocket | None = None
        self._ending = threading.Event()
        # The kernel ends the process with the thread that has started it.
        self._thread = threading.Thread(target=self._run, name="vision", daemon=True)

    @property
    def text(self) -> str:
        """The description of the camera, or of its failure."""
        return f"{NO_PICTURE}{self._failure}" if self._failure else self._camera

    @property
    def pid(self) -> int | None:
        """The process's number; None while there is none."""
        child = self._child
        return None if child is None else child.pid

    def pick(self, question: dict[str, Any]) -> dict[str, Any]:
        """Return the colour range around a point of the newest picture, after the white balance."""
        return self._ask({"pick": question}, "There is no picture to pick a colour in")

    def take_snapshot(self) -> dict[str, Any]:
        """Send the newest picture at full size to the outputs; return its `time` (s, steady clock)."""
        return self._ask({"snapshot": True}, "There is no picture to take")

    def film(self, command: FilmCommand) -> None:
        """Film for `command.seconds` from now on, also by a process that is started meanwhile."""
        with self._lock:
            self._film, self._film_until = command, self._clock.now() + command.seconds
        self._tell({"film": asdict(command)})

    def refusals(self) -> list[str]:
        """Return the reason against arming while OpenCV is loaded: a slow computer is then held up."""
        return ["The camera's software is being loaded. Wait a moment."] if self._loading else []

    def start(self) -> None:
        """Start the thread, and with it the process."""
        self._loading = True
        self._thread.start()

    def close(self) -> None:
        """End the process."""
        self._ending.set()
        self._tell({"end": True})
        if not self._thread.is_alive():
            return
        self._thread.join(_END_SECONDS)
        if (child := self._child) is not None:
            child.kill()
        self._thread.join(_END_SECONDS)

    def _ask(self, question: dict[str, Any], without: str) -> dict[str, Any]:
        """Return the process's answer. Raise RefusedError; `without` says what there is no picture for."""
        if self._failure:
            raise RefusedError(f"{without}. Camera: {self.text}.")
        number, answer = next(self._numbers), Future[dict[str, Any]]()
        self._asked[number] = answer
        try:
            if not self._tell({**question, "number": number}):
                raise RefusedError(f"{without}. Camera: {self.text}.")
            return answer.result(ANSWER_SECONDS)
        except TimeoutError as problem:
            raise RefusedError("The camera does not answer. Try again.") from problem
        finally:
            del self._asked[number]

    def _apply_settings(self) -> None:
        self._tell({"settings": self._settings.table()})

    def _apply_card(self) -> None:
        self._tell({"card": self.card})

    def _run(self) -> None:
        backoff = Backoff()
        while not self._ending.is_set():
            began = self._clock.now()
            why, status = self._run_once()
            self._loading = False
            for answer in list(self._asked.values()):
                answer.set_exception(RefusedError(f"There is no picture: {why}."))
            if self._ending.is_set() or self.missing:
                break
            lived = self._clock.now() - began
            pause = backoff.after(lived, killed=is_killed(status))
            # A start that takes long leaves half of the time to others.
            pause = max(pause, self._load_seconds or lived) if pause else 0.0
            self._fail(why, f"It is started again {describe_pause(pause)}; control goes on.")
            self._ending.wait(pause)

    def _run_once(self) -> tuple[str, int]:
        """Run the process to its end; return the reason of its end as text, and its exit status."""
        try:
            messages, child = self._start()
        except OSError as problem:
            return f"the vision process cannot be started ({problem})", 1
        if self._ending.is_set():
            self._tell({"end": True})
        why = ""
        try:
            self._listen(messages)
        except EOFError:
            pass
        except MessageError as problem:
            why = f"the vision process sent what nobody can read ({problem})"
        except TimeoutError:
            why = f"{self._activity} took more than {HUNG_SECONDS:g} s; its process was ended"
        with self._lock:
            self._messages = None
            messages.close()
        if why:
            child.kill()
        with suppress(subprocess.TimeoutExpired):
            child.wait(_END_SECONDS)
        child.kill()
        status = child.wait()
        self._child = None
        return why or self._describe(status), status

    def _start(self) -> tuple[MessageSocket, subprocess.Popen[bytes]]:
        ours, theirs = socketpair()
        messages = MessageSocket(ours)
        with theirs:
            try:
                self._child = subprocess.Popen(
                    self._program, stdin=theirs.fileno(), env=os.environ | _ENVIRONMENT
                )
            except OSError:
                messages.close()
                raise
        self._camera, self._watched, self._load_seconds = STARTING, [], 0.0
        self._started = self._clock.now()
        fixed = ("camera", "file", "width", "height", "stream_width", "stream_rate")
        config = {name: getattr(self._config, name) for name in fixed}
        # Settings that change meanwhile come after these.
        with self._lock:
            film = replace(self._film, seconds=max(self._film_until - self._clock.now(), 0.0))
            start = {
                "config": config,
                "settings": self._settings.table(),
                "card": self.card,
                "film": asdict(film),
                **self._zenoh,
            }
            self._messages = messages
            messages.send_at_once({"start": start})
        return messages, self._child

    def _listen(self, messages: MessageSocket) -> None:
        """Take the messages of the process. Raise EOFError at its end, TimeoutError where it hangs."""
        while True:
            patience = SILENT_SECONDS if self._load_seconds else LOAD_SECONDS
            received = messages.receive(patience)
            if not received and self._load_seconds:
                self._fail(f"{self._activity} takes more than {SILENT_SECONDS:g} s", "Control goes on.")
                received = messages.receive(HUNG_SECONDS - SILENT_SECONDS)
                self._failure = "" if received else self._failure
            if not received:
                raise TimeoutError
            for message in received:
                act = self._read(message)
                try:
                    act()
                except Exception:
                    log.exception("what vision found could not be passed on")
            self._watch()
            self._recover()

    def _read(self, message: VisionMessage) -> Callable[[], None]:
        """Return the function that handles a message. Raise MessageError."""
        table = message.table
        try:
            if "detection" in table:
                return partial(self._outputs.detection, parse(Detection, table["detection"]))
            if "event" in table:
                return partial(self._outputs.event, parse(Event, table["event"]))
            if "picture" in table:
                topic = _PICTURES[str(table["picture"])]
                return partial(self._outputs.picture, topic, float(table["time"]), message.attachment)
            if "thumbnail" in table:
                return partial(self._outputs.thumbnail, float(table["thumbnail"]), message.attachment)
            if "snapshot" in table:
                return partial(self._outputs.snapshot, float(table["snapshot"]), message.attachment)
            if "film" in table:
                return partial(self._outputs.film, float(table["film"]), message.attachment)
            if "camera" in table:
                return partial(self._take_camera, str(table["camera"]))
            if "missing" in table:
                return partial(self._take_missing, str(table["missing"]))
            if "loaded" in table:
                return self._take_loaded
            return partial(self._take_answer, int(table["number"]), table)
        except (ValueError, TypeError, KeyError) as problem:
            raise MessageError(str(problem)) from problem

    def _take_loaded(self) -> None:
        self._load_seconds = max(self._clock.now() - self._started, 1e-3)
        self._loading = False

    def _take_missing(self, text: str) -> None:
        self.missing = self._failure = text
        self._loading = False

    def _take_camera(self, text: str) -> None:
        self._camera = text
        if text != STARTING:
            self._failure = ""

    def _take_answer(self, number: int, table: dict[str, Any]) -> None:
        answer = self._asked.get(number)
        if answer is None or answer.done():
            return
        if "refused" in table:
            answer.set_exception(RefusedError(str(table["refused"])))
        else:
            answer.set_result(table["answer"])

    def _watch(self) -> None:
        """Tell the process which pictures are watched; called when a picture comes, so nothing polls."""
        watched = [name for name, topic in _PICTURES.items() if self._outputs.watched(topic)]
        if watched != self._watched:
            self._watched = watched
            self._tell({"watched": watched})

    def _tell(self, table: dict[str, Any]) -> bool:
        """Send a message to the process without waiting; return False where there is no process."""
        with self._lock:
            if self._messages is None:
                return False
            with suppress(OSError):
                if self._messages.send_at_once(table):
                    return True
            # It hangs, or ends: the next one is told all.
            if self._child is not None:
                self._child.kill()
            return False

    def _fail(self, why: str, then: str) -> None:
        self._failure = why
        if not self._failure_reported:
            self._failure_reported = True
            self._report("caution", f"Camera: {why}. {then}")

    def _recover(self) -> None:
        """Report the end of a failure once it is past, so that a series of crashes is reported once."""
        if not self._failure_reported or self.text.startswith((NO_PICTURE, STARTING)):
            return
        if self._clock.now() - self._started >= STEADY_SECONDS:
            self._failure_reported = False
            self._report("info", f"Camera: {self.text}.")

    def _report(self, severity: Severity, text: str) -> None:
        event = Event(time=self._clock.now(), kind="camera", severity=severity, text=text)
        try:
            self._outputs.event(event)
        except Exception:
            log.exception("an event of the camera could not be published")

    @property
    def _activity(self) -> str:
        """The present work of the process, as text."""
        if not self._load_seconds:
            return "loading OpenCV"
        file = self._config.file
        if self._config.camera == "file":
            return f"reading {Path(file).name}"
        if self._config.camera == "usb":
            return f"reading the USB camera {file}".rstrip()
        if self._config.camera == "pi":
            return "reading the Pi camera"
        return f"reading the camera {self._config.camera!r}"

    def _describe(self, status: int) -> str:
        """Return the end of the process as text."""
        what = "the decoder" if self._config.camera == "file" and self._load_seconds else "its process"
        if status == EXHAUSTED:
            return f"{self._activity} needed more memory than its {BYTES_MAX / 1e6:.0f} MB"
        if status == -SIGKILL:
            return f"{self._activity} ended: its process was killed (SIGKILL), perhaps for want of memory"
        if status < 0:
            return f"{self._activity} crashed {what} ({Signals(-status).name})"
        return f"{self._activity} ended its process (status {status}); the runtime's log says more"
