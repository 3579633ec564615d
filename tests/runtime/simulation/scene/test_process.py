"""The scene's process: requests over the real Zenoh, rendering in a thread of its own."""

import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import cv2
import numpy as np
import pytest

from robot_runtime.clock import SimulatedClock, SteadyClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.documents import Detection, Event, Truth
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.scene_picture import (
    Picture,
    read_picture,
    read_request,
    write_picture,
    write_request,
)
from robot_runtime.contract.topics import BY_NAME, Kind
from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.simulation.scene import process as process_module
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.simulation.scene.process import SceneProcess
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.requests import changes
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.transport.blocks import Block, read_blocks, row
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.interface import VisionOutputs
from robot_runtime.vision.node import VisionNode
from tests.runtime.simulation.scene.harness import truth
from tests.waiting import SECONDS, wait_for

rendered = pytest.mark.skipif(missing() is not None, reason=str(missing()))
SIZE = (160, 120)


class Ends:
    """The scene's process and its Zenoh peer."""

    def __init__(self, process: SceneProcess, other: ZenohTransport) -> None:
        self.process = process
        self.other = other

    def ask(self, name: str, question: dict[str, Any]) -> dict[str, Any]:
        """Ask, and repeat until Zenoh has announced the process."""
        answer: dict[str, Any] = patiently(lambda: self.other.query(f"scene/{name}", question))
        return answer

    def picture(self, card: tuple[int, int, int] | None = None) -> Picture:
        request = write_request(*SIZE, card)
        return read_picture(patiently(lambda: self.other.query_bytes("scene/picture", request, SECONDS)))

    def tell(self, seconds: float, where: Truth) -> None:
        """Publish the robot's pose until the scene has received it."""
        block = Block.of(BY_NAME["truth"], 1, 0, row(seconds, where.to_bytes()))
        end = time.monotonic() + SECONDS
        while self.process._truth is None or self.process._truth[0] != seconds:
            assert time.monotonic() < end
            self.other.publish("truth", block.data)
            time.sleep(0.01)


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """The scene may take as long as the tests wait, not only as long as a camera does."""
    monkeypatch.setattr(process_module, "ANSWER_TIMEOUT", SECONDS)


def patiently(ask: Callable[[], Any]) -> Any:
    while True:
        try:
            return ask()
        except NoAnswerError:
            continue


@contextmanager
def link() -> Iterator[Ends]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        endpoint = f"unixsock-stream/{folder}/zenoh"
        with (
            ZenohTransport("turtle", [endpoint]) as other,
            ZenohTransport("turtle", connect=[endpoint]) as own,
        ):
            process = SceneProcess(own, SteadyClock())
            thread = threading.Thread(target=process.run)
            thread.start()
            try:
                yield Ends(process, other)
            finally:
                process.end()
                thread.join()


@rendered
def test_a_picture_shows_the_newest_truth_and_carries_its_time() -> None:
    with link() as ends:
        with pytest.raises(RefusedError, match="not sent the robot's position yet"):
            ends.picture()
        ends.tell(12.5, truth((0.0, 0.0, 1.0)))
        first = ends.picture()
        assert (first.time, first.pixels.shape) == (12.5, (120, 160, 3))
        ends.tell(13.5, truth((0.0, 0.0, 1.0), yaw=90.0))
        second = ends.picture()
        assert second.time == 13.5
        assert np.abs(first.pixels.astype(int) - second.pixels).mean() > 2


@rendered
def test_floor_walls_and_beacons_are_the_simulators() -> None:
    simulator = Simulator(SimulationParameters(), 1)
    with link() as ends:
        for name, change in changes(simulator).items():
            ends.other.serve(f"simulator/{name}", change)
        ends.tell(1.0, truth((0.0, 0.0, 1.0)))
        ends.picture()
        changes(simulator)["world"]({"depth": 2.0, "length": 8.0, "width": 5.0})
        changes(simulator)["beacons"]({"positions": [[1.0, 0.0, 0.5]]})
        end = time.monotonic() + SECONDS
        while ends.process._contents.basin.length != 8.0:
            assert time.monotonic() < end
            ends.picture()
        assert ends.process._contents.kind == "pool"
        assert ends.process._contents.beacons == ((1.0, 0.0, 0.5),)


@rendered
def test_targets_and_water_change_what_is_seen() -> None:
    with link() as ends:
        ends.tell(1.0, truth((0.0, 0.0, 1.0)))
        ends.ask("targets", {"targets": []})
        empty = ends.picture().pixels
        target = {"colour": "red", "position": [0.8, 0, 1], "size": 0.2}
        ends.ask("targets", {"targets": [target]})
        assert np.abs(ends.picture().pixels[50:70, 70:90].astype(int) - empty[50:70, 70:90]).mean() > 30
        ends.ask("world", {"kind": "pool", "turbidity": 1.0})
        assert ends.picture().pixels[60, 80].tolist() != pytest.approx([35, 30, 215], abs=60)


def test_the_contents_are_reported_as_the_requests_that_create_them() -> None:
    with link() as ends:
        target = {"colour": "red", "position": [0.8, 0.0, 1.0], "size": 0.2, "shape": "box"}
        request: dict[str, dict[str, Any]] = {
            "world": {"kind": "pool", "turbidity": 0.5},
            "targets": {"targets": [target]},
        }
        for name, question in request.items():
            ends.ask(name, question)
        report = ends.ask("contents", {})
        assert {name: report[name] for name in request} == request


@pytest.mark.parametrize(
    ("name", "question", "message"),
    [
        ("world", {"kind": "lake"}, "must be one of 'pool', 'natural'"),
        ("world", {"turbidity": 2}, "must lie between 0 and 1"),
        ("world", {"depth": 2}, "'depth' is not known here"),
        ("targets", {}, "targets is missing"),
        ("targets", {"targets": [{"colour": "pink", "position": [1, 0, 1]}]}, "must be one of red, yellow"),
        ("targets", {"targets": [{"colour": "red", "position": [1, 0]}]}, "must be a list of 3 numbers"),
        ("targets", {"targets": [{"colour": "red", "position": [1, 0, 1], "size": 9}]}, "0.02 and 2"),
        ("view", {"name": "below"}, "must be one of 'follow', 'side', 'top'"),
        ("view", {"elevation": 100}, "must lie between -60 and 89"),
    ],
)
def test_bad_requests_are_refused_with_the_reason(name: str, question: dict[str, Any], message: str) -> None:
    with link() as ends, pytest.raises(RefusedError, match=message):
        ends.ask(name, question)


@pytest.mark.parametrize(
    ("question", "message"),
    [
        (b'{"width": 5000, "height": 100}', "must lie between 16 and 1280"),
        (b'{"width": 100, "height": 100, "card": [0, 0, 300]}', "must be 0 to 255"),
        (b'{"width": 100}', "height is missing"),
        (b"[]", "must be a JSON object"),
        (b"\xff", "must be JSON"),
    ],
)
def test_bad_requests_for_pictures_are_refused_with_the_reason(question: bytes, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        read_request(question)


@pytest.mark.parametrize("size", [0, 15, 33])
def test_a_file_that_is_no_picture_is_refused(size: int) -> None:
    whole = write_picture(Picture(1.0, np.zeros((2, 3, 3), np.uint8)))
    assert len(whole) == 34
    with pytest.raises(ValueError, match="picture"):
        read_picture(whole[:size])


@rendered
def test_a_client_that_disconnects_does_not_affect_others() -> None:
    with link() as ends:
        ends.tell(1.0, truth((0.0, 0.0, 1.0)))
        ends.picture()
        with pytest.raises(NoAnswerError):
            # Gone long before there can be an answer.
            ends.other.query_bytes("scene/picture", write_request(1280, 960, None), timeout=0.001)
        assert ends.picture().time == 1.0


@rendered
def test_the_bystander_view_is_rendered_only_for_subscribers() -> None:
    seen: list[Block] = []
    with link() as ends:
        ends.tell(5.0, truth((0.0, 0.0, 1.0)))
        ends.picture()
        assert ends.process._observer_number == 0
        subscription = ends.other.subscribe("observer", lambda _, data: seen.extend(read_blocks(data)))
        wait_for(lambda: len(seen) == 1)
        ends.ask("view", {"name": "side", "azimuth": 90, "elevation": 0, "distance": 1})
        wait_for(lambda: len(seen) == 2)
        subscription.close()
        wait_for(lambda: ends.process._observed is None)
        ends.tell(6.0, truth((0.0, 0.0, 1.5)))
        assert len(seen) == ends.process._observer_number == 2
    assert all(block.topic.kind is Kind.PICTURE for block in seen)
    pictures = [cv2.imdecode(np.frombuffer(block.payload[8:], np.uint8), cv2.IMREAD_COLOR) for block in seen]
    assert [picture is not None and picture.shape for picture in pictures] == [(360, 640, 3)] * 2
    assert np.abs(pictures[0].astype(int) - pictures[1]).mean() > 2  # type: ignore[union-attr]


@rendered
def test_a_bystanders_picture_that_fails_does_not_end_the_scene(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with link() as ends:
        ends.tell(5.0, truth((0.0, 0.0, 1.0)))
        ends.picture()
        with monkeypatch.context() as patch:
            patch.setattr("robot_runtime.simulation.scene.model.build", lambda *_: 1 / 0)
            ends.ask("targets", {"targets": []})
            subscription = ends.other.subscribe("observer", lambda *_: None)
            wait_for(lambda: "no picture for the observer" in caplog.text)
            subscription.close()
        assert ends.picture().time == 5.0


def look(messages: ZenohTransport, until: Callable[[VisionNode], bool], config: VisionConfig) -> list[Event]:
    """Run a vision node on the camera "scene" until the condition holds; return its events."""
    events: list[Event] = []
    results: list[Detection] = []
    outputs = VisionOutputs(detection=results.append, event=events.append)
    vision = VisionNode(config, SteadyClock(), outputs, connect=lambda: messages)
    vision.show_card("yellow")
    try:
        end = time.monotonic() + SECONDS
        while not until(vision):
            assert time.monotonic() < end
            vision.process_picture()
    finally:
        vision.close()
    assert results[-1].colour == "yellow"
    return events


@rendered
def test_the_vision_node_sees_the_card_in_the_scene() -> None:
    with link() as ends:
        ends.tell(1.0, truth((0.0, 0.0, 1.0)))
        ends.picture()
        events = look(ends.other, lambda vision: "rendered" in vision.text, VisionConfig(camera="scene"))
        assert events == []


def test_without_mujoco_a_drawn_card_replaces_the_scene_with_one_notice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(process_module, "missing", lambda: "MuJoCo is not installed; do this")
    with link() as ends:
        ends.ask("ready", {})
        ends.tell(1.0, truth())
        with pytest.raises(RefusedError, match="do this"):
            ends.picture()
        events = look(ends.other, lambda vision: "drawn" in vision.text, VisionConfig(camera="scene"))
        assert [event.severity for event in events] == ["caution"]
        assert "MuJoCo is not installed; do this. A drawn card stands in." in events[0].text


def test_a_missing_scene_gives_no_picture_and_is_reported_after_a_while() -> None:
    events: list[Event] = []
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        clock = SimulatedClock()
        with ZenohTransport("turtle", [f"unixsock-stream/{folder}/zenoh"]) as alone:
            outputs = VisionOutputs(detection=lambda _: None, event=events.append)
            config = VisionConfig(camera="scene")
            vision = VisionNode(config, clock, outputs, connect=lambda: alone)
            vision.process_picture()
            assert (vision.text, events) == ("starting", [])
            clock.forward(9.0)
            vision.process_picture()
    assert "no scene answers" in vision.text
    assert [event.severity for event in events] == ["caution"]
