"""The runtime as its own process: a board on a pseudo-terminal below it, Zenoh above it."""

import itertools
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from robot_runtime.contract.calibration import EMULATED
from robot_runtime.contract.packets import (
    CHIP_PARAMETERS,
    Debug,
    Depth,
    Hello,
    Imu,
    Navigation,
    Packet,
    Parameter,
    RequestCalibration,
    Start,
    Status,
    StatusFlag,
    Stop,
)
from robot_runtime.contract.topics import Kind
from robot_runtime.contract.vision_settings import SINCE_0_2, VisionSettings
from robot_runtime.control.pilot import PILOT
from robot_runtime.errors import RefusedError
from robot_runtime.transport.blocks import read_blocks, read_rows
from robot_runtime.transport.lifetime import HEARTBEAT
from robot_runtime.transport.outbox import STREAM
from robot_runtime.transport.zenoh_transport import Answer, ZenohTransport
from tests.runtime.board_end import BoardEnd, hello
from tests.waiting import SECONDS

pytestmark = pytest.mark.stack

ROOT = Path(__file__).resolve().parents[2]


class TelemetryBoard:
    """A board that sends telemetry at 50 Hz, executes START and STOP, and records received packets."""

    def __init__(self, path: Path, *, deaf_to_parameters: bool = False) -> None:
        self.path = path
        self.end = BoardEnd(path)
        self.heard: list[tuple[float, int, bytes]] = []
        self.depth = 0.2
        self.silent = False
        self.deaf_to_parameters = deaf_to_parameters
        self._armed = False
        self._ending = threading.Event()
        self._changed = threading.Condition()
        self._threads = [threading.Thread(target=self._listen), threading.Thread(target=self._report)]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        self._ending.set()
        for thread in self._threads:
            thread.join()
        self.end.vanish()

    def wait(self, condition: Callable[[], bool]) -> None:
        with self._changed:
            assert self._changed.wait_for(condition, SECONDS)

    def count(self, type_: int) -> int:
        return sum(heard == type_ for _, heard, _ in self.heard)

    def values_of(self, name: str) -> list[float]:
        """Values of this parameter that the board received."""
        packets = [
            Parameter.from_bytes(payload) for _, type_, payload in self.heard if type_ == Parameter.type
        ]
        return [packet.value for packet in packets if CHIP_PARAMETERS[packet.number].name == name]

    def _listen(self) -> None:
        while not self._ending.is_set():
            for type_, payload in self.end.listen(0.05):
                self._answer(type_, payload)
                with self._changed:
                    self.heard.append((time.monotonic(), type_, payload))
                    self._changed.notify_all()

    def _answer(self, type_: int, payload: bytes) -> None:
        if type_ == Hello.type:
            self.end.say(hello())
        elif type_ == Start.type:
            self._armed = True
            self.end.say(Debug(time=_micros(), level=1, text="armed"))
        elif type_ == Stop.type:
            self._armed = False
        elif type_ == RequestCalibration.type:
            self.end.say(EMULATED.packet())
        elif type_ == Parameter.type and not self.deaf_to_parameters:
            self.end.say(Parameter.from_bytes(payload))

    def _report(self) -> None:
        # A sensor that hangs shows the same again and again; these are well.
        noises = itertools.cycle((0, 1))
        while not self._ending.wait(0.02):
            if not self.silent:
                noise = next(noises)
                pressure = 103_000 + 10 * noise
                depth = Depth(time=_micros(), depth=self.depth, pressure=pressure, temperature=20.0)
                self.end.say(depth, _level(0.01 * noise), self._status())

    def _status(self) -> Packet:
        flags = StatusFlag.HOST_ALIVE | (StatusFlag.ARMED if self._armed else 0)
        return Status(
            time=_micros(),
            epoch=9,
            flags=flags,
            faults=0,
            reset_cause=1,
            battery=7.4,
            loop_worst=3000,
            missed_ticks=0,
            frames_invalid=0,
            bytes_lost=0,
            debug_lost=0,
            stack_free=600,
        )


class RuntimeListener:
    """Subscribes to everything that the runtime publishes."""

    def __init__(self, messages: ZenohTransport) -> None:
        self.documents: list[tuple[str, dict[str, Any]]] = []
        self.rows: list[tuple[str, float, Any]] = []
        self.messages: list[tuple[float, list[tuple[str, int, int]]]] = []
        """Arrival of each, s, and its blocks: topic, first number, samples."""
        self._changed = threading.Condition()
        self._subscription = messages.subscribe(STREAM, self._take)

    def wait(self, condition: Callable[[], bool]) -> None:
        with self._changed:
            assert self._changed.wait_for(condition, SECONDS), self.documents[-5:]

    def newest_state(self) -> dict[str, Any]:
        states = [document for name, document in self.documents if name == "state"]
        return states[-1] if states else {}

    def texts(self, name: str) -> list[str]:
        return [document["text"] for topic, document in self.documents if topic == name]

    def _take(self, _: str, data: bytes) -> None:
        with self._changed:
            blocks = read_blocks(data)
            numbers = [(block.topic.name, block.first, block.count) for block in blocks]
            self.messages.append((time.monotonic(), numbers))
            for block in blocks:
                name = block.topic.name
                if block.topic.kind is Kind.DOCUMENTS:
                    self.documents += [(name, document) for document in json.loads(block.payload)]
                else:
                    self.rows += [(name, time_, record) for time_, record in read_rows(block)]
            self._changed.notify_all()


class RuntimeRig:
    """A runtime process, its board, and another process's view of it."""

    def __init__(self, folder: Path, *options: str) -> None:
        tty = folder / "board.tty"
        self.board = TelemetryBoard(tty)
        command = [sys.executable, "-m", "robot_runtime", "--config", str(ROOT / "robot.toml")]
        command += ["--data", str(folder), "--port", str(tty), "--with-parent", *options]
        self.process = subprocess.Popen(command, cwd=ROOT)
        run = folder / "run"
        run.mkdir(exist_ok=True)
        server, runtime = (f"unixsock-stream/{run}/{name}.sock" for name in ("server", "runtime"))
        self.messages = ZenohTransport("turtle", [server], [runtime])
        self.listener = RuntimeListener(self.messages)

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(SECONDS)
        self.messages.close()
        self.board.close()

    @contextmanager
    def saying(self, name: str, axes: list[float] | None = None) -> Iterator[None]:
        """Send this ten times a second meanwhile, as a server does; with axes, as driving commands."""
        ending = threading.Event()

        def say() -> None:
            sequence = 0
            while not ending.wait(0.1):
                sequence += 1
                text = {"lease": 0, "sequence": sequence, "taken": time.monotonic(), "axes": axes}
                self.messages.publish(name, json.dumps(text).encode())

        thread = threading.Thread(target=say)
        thread.start()
        try:
            yield
        finally:
            ending.set()
            thread.join()

    def newest_parameters(self) -> dict[str, dict[str, Any]]:
        notices = [document for name, document in self.listener.documents if name == "parameters"]
        return {parameter["name"]: parameter for parameter in notices[-1]["parameters"]} if notices else {}

    def settled_state(self) -> dict[str, Any]:
        """Return the state but for its time, once nothing speaks against arming.

        For a moment a board that is late does, as this one is where this process is held.
        """
        end = time.monotonic() + SECONDS
        while (state := self.query("query/state"))["refusals"]:
            assert time.monotonic() < end, state["refusals"]
        return {**state, "time": 0}

    def alarms(self) -> list[str]:
        """Return the faults of the newest state's alarms."""
        return [alarm["fault"] for alarm in self.listener.newest_state().get("alarms", [])]

    def newest_parameter(self, name: str) -> dict[str, Any]:
        return self.newest_parameters().get(name, {})

    def ready(self) -> None:
        self.listener.wait(lambda: self.listener.newest_state().get("refusals") == [])

    def arm(self) -> None:
        self.ask("arm")
        self.listener.wait(lambda: bool(self.listener.newest_state()["armed"]))

    def ask(self, name: str, /, **question: Any) -> None:
        self.query(f"command/{name}", question)

    def query(self, name: str, question: Mapping[str, Any] | None = None) -> Answer:
        return self.messages.query(name, question or {}, SECONDS)


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[RuntimeRig]:
    rig = RuntimeRig(tmp_path)
    yield rig
    rig.close()


def _level(noise: float) -> Imu:
    rate, force = (noise, 0.0, 0.0), (noise, 0.0, -9.81)
    return Imu(time=_micros(), attitude=(1.0, 0.0, 0.0, 0.0), rate=rate, force=force)


def _micros() -> int:
    return time.monotonic_ns() // 1000 & 0xFFFFFFFF


def test_in_the_lean_profile_every_sample_comes_with_a_tick_and_a_command(tmp_path: Path) -> None:
    config = tmp_path / "lean.toml"
    config.write_text((ROOT / "robot.toml").read_text().replace('profile = "auto"', 'profile = "lean"'))
    rig = RuntimeRig(tmp_path, "--config", str(config))
    with closing(rig):
        rig.ready()
        rig.ask("arm", mode="automatic")
        rig.listener.wait(lambda: rig.board.count(Navigation.type) > 5)
        began = len(rig.listener.messages)
        rig.listener.wait(lambda: len(rig.listener.messages) >= began + 20)
        times = [time_ for time_, _ in rig.listener.messages[began:]]
        assert (times[-1] - times[0]) / (len(times) - 1) > 0.08
        depths = [blocks for _, blocks in rig.listener.messages[began:]]
        numbers = [(first, count) for blocks in depths for name, first, count in blocks if name == "depth"]
        assert all(first + count == after for (first, count), (after, _) in pairwise(numbers))
        assert len(numbers) >= 18
        navigations = [name for blocks in depths for name, *_ in blocks if name == "navigation"]
        assert len(navigations) >= 18


def test_arms_controls_at_its_rate_and_stops(rig: RuntimeRig) -> None:
    def since_stop() -> list[int]:
        types = [type_ for _, type_, _ in rig.board.heard]
        return types[types.index(Stop.type, types.index(Start.type)) :] if Stop.type in types else []

    def times() -> list[float]:
        # The runtime's own: this process may be held, and reads many at once then.
        return [at for name, at, _ in rig.listener.rows if name == "navigation"]

    rig.ready()
    rig.arm()
    rig.board.wait(lambda: rig.board.count(Navigation.type) >= 21)
    rig.listener.wait(lambda: len(times()) >= 21)
    gaps = [after - before for before, after in pairwise(times())]
    # A busy computer is late now and then: the median does not see it.
    assert median(gaps) == pytest.approx(0.1, rel=0.1)
    newest = [payload for _, type_, payload in rig.board.heard if type_ == Navigation.type][-1]
    assert Navigation.from_bytes(newest).z == pytest.approx(1.0)
    rig.ask("stop")
    rig.listener.wait(lambda: not rig.listener.newest_state()["armed"])
    rig.board.wait(lambda: len(since_stop()) > 5)
    # The tick during which STOP went out may have ended after it.
    assert since_stop().count(Navigation.type) <= 1
    # After some seconds, that there is no scene for the camera is an event as well.
    events = [text for text in rig.listener.texts("event") if not text.startswith("Camera: ")]
    assert events[-1] == "Stopped by the operator."


def test_packets_of_the_board_are_published_unchanged(rig: RuntimeRig) -> None:
    rig.ready()
    rig.arm()
    rig.listener.wait(lambda: "armed" in rig.listener.texts("debug"))
    rig.listener.wait(lambda: any(name == "control" for name, _, _ in rig.listener.rows))
    depths = [(at, record) for name, at, record in rig.listener.rows if name == "depth"]
    assert {record.depth for _, record in depths} == {0.2}
    # This board's clock is the host's, so that the estimate can be judged: never early, hardly late. A busy
    # machine delays the first packets by any time; the first that arrives at once mends the rest. After four
    # seconds the clocks' drift is estimated, too, and delays are taken for some.
    began = depths[0][0]
    late = [(at - record.time * 1e-6) % (2**32 * 1e-6) for at, record in depths if at < began + 3]
    assert max(late) < 2**31 * 1e-6
    assert min(late) < 0.05


@pytest.mark.parametrize(
    ("name", "question", "why"),
    [
        ("controller", {"name": "fuzzy"}, "no controller 'fuzzy'"),
        ("controller", {"name": "pid", "gains": [3]}, "gains is \\[3\\]; it must be a table"),
        ("controller", {}, "name is missing"),
        ("set_points", {"default": 11}, "must lie between 0 and 10"),
        ("card", {"colour": "plaid"}, "no card of colour 'plaid'"),
        ("vision", {"rate": 1000}, "must lie between 2 and 30"),
        ("parameters", {"values": {"depth.pid.kp": 51}}, "kp is 51; it must lie between 0 and 50 1/m"),
        ("parameters", {"values": {"depth.pid.kp": 4, "nothing": 1}}, "no parameter 'nothing'"),
        ("parameters", {"values": {"vision.rate": 5}, "expected": {"vision.rate": 6}}, "not 6 any more"),
    ],
)
def test_bad_commands_are_refused_with_the_reason(
    shared: RuntimeRig, name: str, question: dict[str, Any], why: str
) -> None:
    before = shared.settled_state()
    with pytest.raises(RefusedError, match=why):
        shared.ask(name, **question)
    assert shared.settled_state() == before


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RuntimeRig]:
    folder = tmp_path_factory.mktemp("shared")
    # The state soon becomes constant; a camera "scene" reports a missing scene only after ten seconds.
    config = folder / "robot.toml"
    config.write_text((ROOT / "robot.toml").read_text().replace('camera = "scene"', 'camera = "card"'))
    rig = RuntimeRig(folder, "--config", str(config))
    rig.ready()
    rig.listener.wait(lambda: rig.listener.newest_state()["camera"] != "starting")
    yield rig
    rig.close()


def test_vision_settings_survive_a_restart_of_the_runtime(tmp_path: Path) -> None:
    usual = VisionSettings()
    changed = replace(
        usual, colour="buoy", colours={"buoy": usual.colours["green"]}, actions={"marker 7": 1.5}
    )
    first = RuntimeRig(tmp_path)
    first.ready()
    first.ask("vision_settings", **changed.table())
    assert first.query("query/vision")["settings"] == changed.table()
    with pytest.raises(RefusedError, match="colour is 'yellow'; it must be one of buoy"):
        first.ask("vision", colour="yellow")
    first.close()

    second = RuntimeRig(tmp_path)
    second.ready()
    report = second.query("query/vision")
    assert (report["settings"], report["configured"]) == (changed.table(), usual.table())
    assert second.listener.newest_state()["vision_colour"] == "buoy"
    # A client of version 0.2 does not know how the picture is turned, which stays.
    second.ask("vision_settings", **replace(usual, turn=90, gain=2.0, confirmation=(3, 4)).table())
    older = {name: value for name, value in changed.table().items() if name not in SINCE_0_2}
    second.ask("vision_settings", **older)
    stored = replace(changed, turn=90, gain=2.0, confirmation=(3, 4))
    assert second.query("query/vision")["settings"] == stored.table()
    second.ask("vision_settings", **usual.table())
    assert not (tmp_path / "vision.json").exists()
    second.close()


def test_the_last_frames_are_returned_on_request(rig: RuntimeRig) -> None:
    rig.ready()
    answer = rig.query("query/frames")
    assert answer["fault"] is None
    kinds = {(frame["sent"], kind) for frame in answer["frames"] for kind in frame["kinds"]}
    assert {(True, "Hello"), (False, "Depth"), (False, "Status")} <= kinds
    rig.board.close()
    rig.listener.wait(lambda: not rig.listener.newest_state()["connected"])
    fault = rig.query("query/frames")["fault"]
    assert fault["text"] == "the port went away"
    assert any("Depth" in frame["kinds"] for frame in fault["frames"])
    rig.board = TelemetryBoard(rig.board.path)


def test_garbage_on_the_line_does_not_disturb_the_control(rig: RuntimeRig) -> None:
    rig.ready()
    rig.arm()
    rig.board.wait(lambda: rig.board.count(Navigation.type) >= 3)
    os.write(rig.board.end.master, bytes(range(1, 256)) * 20 + b"\0")
    before = rig.board.count(Navigation.type)
    rig.board.wait(lambda: rig.board.count(Navigation.type) >= before + 10)
    assert rig.process.poll() is None
    assert rig.listener.newest_state()["armed"]


def test_a_port_that_vanishes_disarms_and_its_return_does_not_arm(rig: RuntimeRig) -> None:
    rig.ready()
    rig.arm()
    rig.board.close()
    rig.listener.wait(lambda: not rig.listener.newest_state()["armed"])
    with pytest.raises(RefusedError, match="no connection"):
        rig.ask("arm")
    rig.board = TelemetryBoard(rig.board.path)
    rig.listener.wait(lambda: len(rig.listener.newest_state()["refusals"]) == 1)
    assert rig.listener.newest_state()["mode"] == "failsafe"
    with pytest.raises(RefusedError, match="Acknowledge the alarms"):
        rig.ask("arm")
    rig.ask("acknowledge")
    rig.ready()
    assert rig.listener.newest_state()["mode"] == "disarmed"
    assert rig.board.count(Start.type) == 0


def test_a_silent_board_is_a_fault_that_stops_the_robot(rig: RuntimeRig) -> None:
    rig.ready()
    rig.arm()
    rig.board.silent = True
    rig.board.wait(lambda: rig.board.count(Stop.type) >= 1)
    # A state that is put together while the robot is stopped may hold the alarm and be armed still.
    rig.listener.wait(lambda: "board_silent" in rig.alarms() and not rig.listener.newest_state()["armed"])


def test_without_the_server_s_heartbeat_an_armed_robot_is_stopped(tmp_path: Path) -> None:
    rig = RuntimeRig(tmp_path, "--heartbeat", "1.5")

    def armed_for() -> float:
        state = rig.listener.newest_state()
        return float(state["time"] - state["armed_since"])

    try:
        with rig.saying(HEARTBEAT):
            rig.ready()
            rig.arm()
            rig.listener.wait(lambda: armed_for() > 2.5)
        # The alarm may be told just before the mode.
        rig.listener.wait(lambda: rig.listener.newest_state()["mode"] == "failsafe")
        assert rig.alarms() == ["server_silent"]
        rig.board.wait(lambda: rig.board.count(Stop.type) >= 1)
    finally:
        rig.close()


def test_a_server_that_has_just_started_is_sent_everything_at_once(rig: RuntimeRig) -> None:
    def link_times() -> list[float]:
        return [at for name, at, _ in rig.listener.rows if name == "link"]

    rig.ready()
    # Otherwise there is one a second.
    for _ in range(2):
        known = len(link_times())
        rig.listener.wait(lambda known=known: len(link_times()) > known)  # type: ignore[misc]
    known = len(link_times())
    rig.messages.publish(HEARTBEAT, b"")
    # Where this process was held, the one that was due comes first.
    rig.listener.wait(lambda: any(b - a < 0.9 for a, b in pairwise(link_times()[known - 1 :])))


def test_the_pilot_s_input_reaches_the_board_and_its_end_stops_the_robot(rig: RuntimeRig) -> None:
    def newest_yaw() -> float:
        payloads = [payload for _, kind, payload in rig.board.heard if kind == Navigation.type]
        return Navigation.from_bytes(payloads[-1]).yaw if payloads else 0.0

    rig.ready()
    rig.ask("lease", epoch=0)
    rig.ask("arm", mode="manual")
    with rig.saying(PILOT, axes=[0.0, 0.0, 0.0, 0.0, 0.0, -1.0]):
        rig.board.wait(lambda: newest_yaw() == -1.0)
    rig.listener.wait(lambda: rig.listener.newest_state()["mode"] == "failsafe")
    kinds = {alarm["fault"] for alarm in rig.listener.newest_state()["alarms"]}
    assert {"pilot_quiet", "pilot_lost"} <= kinds
    assert newest_yaw() == 0.0
    dropped = rig.listener.newest_state()["pilot_dropped"]
    rig.messages.publish(PILOT, b"{}")
    rig.listener.wait(lambda: rig.listener.newest_state()["pilot_dropped"] == dropped + 1)


def test_ending_the_runtime_stops_the_board(rig: RuntimeRig) -> None:
    rig.ready()
    rig.arm()
    rig.board.wait(lambda: rig.board.count(Navigation.type) >= 1)
    for _ in range(20):  # an impatient user asks several times
        rig.process.send_signal(signal.SIGTERM)
    rig.board.wait(lambda: rig.board.count(Stop.type) >= 1)
    assert rig.process.wait(SECONDS) == 0


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("rate = 1000", "rate is 1000; it must lie between 10 and 50"),
        ('controller = "pidd"', "there is no controller 'pidd'"),
        ("gains = {pid = {kp = 1e6}}", "kp is 1000000.0; it must be a number between 0"),
    ],
)
def test_a_bad_configuration_is_one_clear_line(tmp_path: Path, entry: str, message: str) -> None:
    config = tmp_path / "robot.toml"
    config.write_text(f"[control]\n{entry}\n")
    command = [sys.executable, "-m", "robot_runtime", "--config", str(config), "--data", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert message in done.stderr


def test_parameters_are_changed_together_listed_and_sent_to_the_board(rig: RuntimeRig) -> None:
    rig.ready()
    rig.ask("controller", name="pid", gains={"kp": 7.0})
    answer = rig.query(
        "command/parameters", {"values": {"fins.amplitude": 0.8, "depth.pid.kp": 4, "vision.rate": 4.0}}
    )
    assert answer["changed"] == {"depth.pid.kp": [7.0, 4.0], "fins.amplitude": [1.6, 0.8]}
    rig.board.wait(lambda: rig.board.values_of("fins.amplitude")[-1] == pytest.approx(0.8))
    rig.listener.wait(lambda: rig.newest_parameter("fins.amplitude").get("value") == 0.8)
    rig.listener.wait(lambda: rig.newest_parameter("fins.amplitude").get("pending") is False)
    listed = rig.newest_parameters()
    assert (listed["depth.pid.kp"]["value"], listed["depth.pid.kp"]["default"]) == (4.0, 3.0)
    assert listed["depth.controller"]["value"] == "pid"
    partly = {"values": {"nothing": 1, "depth.pid.kp": 5, "vision.rate": 99}, "partly": True}
    answer = rig.query("command/parameters", partly)
    assert answer["changed"] == {"depth.pid.kp": [4.0, 5.0]}
    assert answer["left_out"].keys() == {"nothing", "vision.rate"}


def test_a_restarted_board_gets_its_parameters_again_before_arming(rig: RuntimeRig) -> None:
    rig.ready()
    rig.ask("parameters", values={"fins.amplitude": 0.8})
    rig.board.close()
    rig.listener.wait(lambda: not rig.listener.newest_state()["connected"])
    rig.board = TelemetryBoard(rig.board.path, deaf_to_parameters=True)
    rig.listener.wait(lambda: any("fins.amplitude" in why for why in rig.listener.newest_state()["refusals"]))
    with pytest.raises(RefusedError, match="not confirmed"):
        rig.ask("arm")
    rig.board.deaf_to_parameters = False
    rig.ready()
    assert rig.board.values_of("fins.amplitude")[-1] == pytest.approx(0.8)


SLOW_OPENCV = """
import sys
with open({pipe!r}) as pipe:
    pipe.read()
sys.path.remove({folder!r})
del sys.modules["cv2"]
import cv2
"""
"""Loads the real one once somebody has written to the pipe."""


def test_while_opencv_is_loaded_it_is_not_armed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    slow, pipe = tmp_path / "slow", tmp_path / "signal"
    slow.mkdir()
    os.mkfifo(pipe)
    (slow / "cv2.py").write_text(SLOW_OPENCV.format(pipe=str(pipe), folder=str(slow)))
    monkeypatch.setenv("PYTHONPATH", str(slow))
    text = "The camera's software is being loaded. Wait a moment."
    with closing(RuntimeRig(tmp_path)) as rig:
        rig.listener.wait(lambda: rig.listener.newest_state().get("refusals") == [text])
        with pytest.raises(RefusedError, match="being loaded"):
            rig.ask("arm")
        pipe.write_text("go on")
        rig.ready()
        rig.arm()
