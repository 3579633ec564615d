"""Programs at the doors of rosbridge and Foxglove."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from struct import Struct
from time import monotonic, sleep

from bench.connected_programs import END_SECONDS, steady_time
from bench.hub_ends import TOPICS
from bench.hub_viewers import Drain, TimedReading, TimedViewer
from server.platform.settings import Settings
from tests.shell import shell_headers

_START_SECONDS = 240.0
_FOXGLOVE = Struct("<BIQ")
"""Before a message: an opcode, the subscription, the time (ns)."""

Open = Callable[[bool], TimedViewer]
"""Opens a program that subscribes to attitude and depth, or with True to all topics."""


class WebSocketDoor:
    """A door, and how a program is opened there."""

    def __init__(self, open_one: Open) -> None:
        self._open_one = open_one

    def wait(self) -> None:
        """Wait until a program gets samples. Raise OSError where none does."""
        end = monotonic() + _START_SECONDS
        while True:
            try:
                viewer = self._open_one(False)
                if any(viewer.times(message) for message in viewer.messages()):
                    return viewer.close()
            except OSError:
                if monotonic() > end:
                    raise
                sleep(0.2)

    @contextmanager
    def programs(self, many: int) -> Iterator["WebSocketPrograms"]:
        """Return so many programs."""
        with (
            TimedReading(self._open_one(False)) as timed,
            Drain(lambda: self._open_one(False), many - 1) as drain,
        ):
            yield WebSocketPrograms(timed, drain)

    @contextmanager
    def stalled(self) -> Iterator[None]:
        """Run another program, which subscribes to more and reads nothing.

        Raise ConnectionError where it is not disconnected.
        """
        stalled = self._open_one(True)
        yield
        end = monotonic() + END_SECONDS
        for _ in stalled.messages():
            if monotonic() > end:
                raise ConnectionError("a program that reads nothing is still connected")
        stalled.close()


class WebSocketPrograms:
    """The messages of programs: those of the first are timed, the bytes of the others counted."""

    def __init__(self, timed: TimedReading, drain: Drain) -> None:
        self._timed, self._drain = timed, drain
        self._drained = 0

    def begin(self) -> None:
        """Count from now on."""
        self._timed.begin()
        self._drained = self._drain.bytes

    def end(self) -> tuple[list[float], float]:
        """Return the delay of each message of the first since `begin`, s, and the number of all.

        Raise ConnectionError where one was disconnected.
        """
        samples, size, latencies = self._timed.end()
        drained = self._drain.bytes - self._drained
        self._drain.check()
        return latencies, samples * (1 + drained / size)


def rosbridge_door(settings: Settings) -> WebSocketDoor:
    """Return the door of rosbridge."""

    def open_one(all_topics: bool) -> TimedViewer:
        viewer = TimedViewer(_address(settings, "rosbridge"), _stamps, shell_headers(settings.data))
        more = [f"/mucat/{topic}" for topic in TOPICS if topic != "depth"] if all_topics else []
        for topic in ("/imu/data", "/mucat/depth", *more):
            viewer.send(json.dumps({"op": "subscribe", "topic": topic}))
        return viewer

    return WebSocketDoor(open_one)


def foxglove_door(settings: Settings) -> WebSocketDoor:
    """Return the door of Foxglove."""

    def open_one(all_topics: bool) -> TimedViewer:
        headers = shell_headers(settings.data) | {"sec-websocket-protocol": "foxglove.websocket.v1"}
        viewer = TimedViewer(_address(settings, "foxglove"), _times, headers)
        topics = TOPICS if all_topics else ("imu", "depth")
        channels = _channels(viewer)
        asked = [{"id": number, "channelId": channels[f"/{topic}"]} for number, topic in enumerate(topics)]
        viewer.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
        return viewer

    return WebSocketDoor(open_one)


def _address(settings: Settings, door: str) -> str:
    return f"ws://127.0.0.1:{settings.server.port}/{door}"


def _channels(viewer: TimedViewer) -> dict[str, int]:
    """Return the numbers of the channels. Raise OSError where the connection ends before."""
    for message in viewer.messages():
        if isinstance(message, str) and (advertisement := json.loads(message))["op"] == "advertise":
            return {channel["topic"]: channel["id"] for channel in advertisement["channels"]}
    raise ConnectionError("the door was closed before it listed its channels")


def _stamps(message: str | bytes) -> list[float]:
    document = json.loads(message)
    if document["op"] != "publish":
        return []
    stamp = document["msg"].get("stamp") or document["msg"]["header"]["stamp"]
    return [steady_time(stamp["sec"] + stamp["nanosec"] / 1e9)]


def _times(message: str | bytes) -> list[float]:
    if isinstance(message, str) or message[0] != 1:
        return []
    return [steady_time(_FOXGLOVE.unpack_from(message)[2] / 1e9)]
