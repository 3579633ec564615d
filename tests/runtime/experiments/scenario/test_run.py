"""Scenarios in simulated time, with the robot's own firmware."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from math import dist
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np
import pytest

from robot_runtime.contract.craft import Craft, CraftDocument
from robot_runtime.contract.packets import DeviceFault, StatusFlag
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.run import AFTERWARDS, ScenarioRun
from robot_runtime.simulation.scene.availability import missing
from server.library.film import decode_film
from tests.runtime.experiments.scenario.staging import ROOT, Output, document, perform

SHIPPED = sorted((ROOT / "robot_runtime/experiments/scenario/shipped").glob("*.toml"))
ARM = 'at = 0.5; do = "arm"'
HEADER = Struct("<IB")


def run_process(text: str, *options: str, hashes: str = "0") -> tuple[int, bytes]:
    """Return the exit status and the output of the process."""
    command = [sys.executable, "-m", "robot_runtime.experiments.scenario", *options]
    environment = {**os.environ, "PYTHONHASHSEED": hashes}
    done = subprocess.run(command, cwd=ROOT, input=text.encode(), stdout=subprocess.PIPE, env=environment)
    return done.returncode, done.stdout


def read_messages(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield each message's kind and bytes."""
    at = 0
    while at < len(data):
        size, kind = HEADER.unpack_from(data, at)
        at += HEADER.size + size
        yield kind, data[at - size : at]
    assert at == len(data)


def read_events(data: bytes) -> list[dict[str, Any]]:
    """Return the events beside the blocks."""
    return [json.loads(message) for kind, message in read_messages(data) if kind == 0]


def read_blocks_of(data: bytes) -> bytes:
    """Return all blocks, one after the other."""
    return b"".join(message for kind, message in read_messages(data) if kind == 1)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_the_shipped_scenarios_arm_and_dive_towards_their_set_point(path: Path) -> None:
    whole = read_scenario(path.read_text())
    events = tuple(event for event in whole.events if event.at <= 8)
    report = perform(replace(whole, duration=8.0, events=events))
    assert report.ended == {"event": "ended", "time": 8 + AFTERWARDS, "state": "complete", "problem": None}
    assert report.time_of("event", "Armed.") < 1.3
    depths = [record.depth for record in report.between("depth", 7, 8)]
    assert min(depths) > 0.3
    assert len(report.between("imu", 1, 8)) == pytest.approx(700, abs=2)
    assert len(report.between("truth", 1, 8)) == pytest.approx(140, abs=1)
    assert report.documents["state"][-1]["armed"] is False


def test_the_beacon_approach_reaches_both_lights() -> None:
    report = perform((ROOT / "robot_runtime/experiments/scenario/shipped/beacon_approach.toml").read_text())
    for light, start, end in (((-1.0, 3.0), 0.0, 45.0), ((3.0, 0.0), 45.0, 119.0)):
        nearest = min(dist(light, truth.position[:2]) for truth in report.between("truth", start, end))
        assert nearest < 0.3


def test_the_same_seed_gives_the_same_bytes_and_another_gives_others() -> None:
    events = (
        ARM,
        'at = 1; do = "card"; colour = "yellow"',
        'at = 1.5; do = "line"; direction = "from_board"; kind = "bit_errors"; rate = 0.001',
        'at = 2; do = "fault"; sensor = "gyroscope"; kind = "spike"; share = 0.1; size = 1.0',
    )
    once = run_process(document(3, *events), hashes="1")
    assert once[0] == 0
    assert len(once[1]) > 30_000
    assert run_process(document(3, *events), hashes="2") == once
    first, second = (perform(document(3, *events, seed=seed)).bytes for seed in (7, 8))
    assert first != second
    assert first == read_blocks_of(once[1])


def test_the_emulated_board_gives_the_same_bytes_too() -> None:
    first, second = (perform(document(1, ARM), "emulated").bytes for _ in range(2))
    assert first == second


def test_the_two_boards_agree() -> None:
    text = document(8, ARM, 'at = 6; do = "set_points"; default = 0.4')
    host, emulated = perform(text), perform(text, "emulated")
    assert host.texts("event") == emulated.texts("event")
    assert host.time_of("event", "Armed.") == pytest.approx(emulated.time_of("event", "Armed."), abs=0.11)
    for (time, here), (same, there) in zip(host.rows["truth"], emulated.rows["truth"], strict=True):
        assert time == same
        assert here.position[2] == pytest.approx(there.position[2], abs=0.06), time
    for topic in ("imu", "depth", "motor", "status", "beacon"):
        # The boards are greeted some milliseconds apart; what they send at once is from before the start.
        here, there = (sum(time >= 0 for time, _ in run.rows[topic]) for run in (host, emulated))
        assert here == pytest.approx(there, abs=2), topic


def test_arming_is_refused_while_a_sensor_fails() -> None:
    report = perform(
        document(3, 'at = 0.2; do = "fault"; sensor = "pressure"; kind = "bus"', 'at = 2; do = "arm"')
    )
    assert report.markers[-1][1].startswith("Arm: refused. The pressure sensor does not answer.")
    assert "At 2 s: Arm: refused." in report.ended["problem"]
    assert report.ended["state"] == "complete"
    assert "navigation" not in report.rows


@pytest.mark.parametrize("board", ["host", "emulated"])
def test_a_board_can_have_mistakes(board: str) -> None:
    text = document(4, 'at = 1; do = "arm"')
    report = perform('mistakes = ["leads-reversed:back-left", "beacons-inverted"]\n' + text, board)
    faults = {status.faults for _, status in report.rows["status"]}
    assert faults == {0, DeviceFault.TRACKING_BACK_LEFT}
    assert all(beacon.right and beacon.left for beacon in report.between("beacon", 0.0, 1.0))


@pytest.mark.parametrize("controller", ["pid", "predictive"])
def test_stiff_fins_swim_and_hold_the_depth(controller: str) -> None:
    text = document(30, ARM).replace('"pid"', f'"{controller}"')
    report = perform('mistakes = ["stiction:18"]\n' + text)
    assert {status.faults for _, status in report.rows["status"]} == {0}
    sensed = [depth.depth for depth in report.between("depth", 20, 30)]
    assert max(abs(depth - 0.6) for depth in sensed) < 0.03


def test_a_cut_line_stops_the_fins_and_disarms() -> None:
    cut = [
        f'at = 3; do = "line"; direction = "{way}"; kind = "cut"; on = true'
        for way in ("to_board", "from_board")
    ]
    whole = [line.replace("at = 3", "at = 5").replace("true", "false") for line in cut]
    report = perform(document(7, ARM, *cut, *whole))
    assert any(any(record.drive) for record in report.between("motor", 2, 3))
    assert report.between("motor", 3.1, 4.9) == []
    # Its limit counts from the last depth, which came up to 0.02 s before the cut.
    assert 3.38 <= report.time_of("event", "The depth is too old") < 3.7
    assert not any(any(record.drive) for record in report.between("motor", 5.1, 7))
    assert any("disarmed" in text for text in report.texts("debug"))
    # The fins in the water while the link was cut: at rest half a second after the last command.
    fins = [record.fins for record in report.between("truth", 3.8, 7)]
    assert max(abs(fin[0] - fins[0][0]) for fin in fins) < 0.01


def test_the_water_and_the_trim_change_as_events_say() -> None:
    report = perform(
        document(
            6,
            'at = 1; do = "current"; north = 0.3',
            'at = 2; do = "trim"; buoyancy = 0.98; forward = 0.0; right = 0.0; above = 0.01',
            'at = 2; do = "beacons"; positions = [[1.5, 1.0, 0.2]]',
            'at = 3; do = "marker"; text = "Here"',
        )
    )
    first, last = report.rows["truth"][0][1], report.rows["truth"][-1][1]
    assert last.position[0] > first.position[0] + 0.2
    assert last.position[2] > first.position[2] + 0.2
    assert not any(record.right for record in report.between("beacon", 0, 2))
    assert any(record.right for record in report.between("beacon", 2.2, 3))
    assert report.markers == [
        (1.0, "Current of 0.3 m/s"),
        (2.0, "Trim: buoyancy 0.98"),
        (2.0, "A light beacon"),
        (3.0, "Here"),
    ]


def test_a_start_under_water_is_a_dive_from_the_surface() -> None:
    report = perform(document(2, more="[start]\ndown = 1.0\nnorth = -1.5\nheading = 1.0"))
    depths = [record.depth for record in report.between("depth", 0.5, 0.7)]
    # The pressure sensor is on the back, 5 cm above the centre of mass.
    assert sum(depths) / len(depths) == pytest.approx(0.95, abs=0.03)
    assert report.rows["truth"][0][1].position[0] == pytest.approx(-1.5, abs=0.01)


def test_a_card_before_the_camera_changes_the_set_point() -> None:
    report = perform(document(4, ARM, 'at = 2; do = "card"; colour = "yellow"', 'at = 3; do = "card"'))
    seen = [
        detection["taken"] for detection in report.documents["detection"] if detection["colour"] == "yellow"
    ]
    assert 2.0 <= seen[0] <= 2.3
    assert 2.7 <= seen[-1] <= 3.0
    assert "Set point 1.00 m: yellow is seen." in report.texts("event")


@pytest.mark.skipif(missing() is not None, reason="the scene cannot be rendered here")
def test_the_rendered_scene_is_filmed_in_the_scenarios_time() -> None:
    target = '\n[[scene.targets]]\ncolour = "red"\nposition = [0.9, 0.0, 0.2]\nsize = 0.3'
    scene = 'kind = "natural"\ndepth = 3.0' + target
    report = perform(document(1, scene=scene, more='[vision]\ncamera = "scene"\nfilm = true'))
    times = [time for time, _ in report.film]
    assert times[0] == pytest.approx(0.0, abs=0.01)
    # One that is searched as well may come half a period early.
    assert np.diff(times) == pytest.approx(1 / 15, abs=0.5 / 15)
    # The robot is watched for half a second after the end.
    assert times[-1] == pytest.approx(1 + AFTERWARDS, abs=0.1)
    pictures = [frame.to_ndarray(format="bgr24") for _, frame in decode_film(report.film)]
    assert len(pictures) == len(times)
    assert {picture.shape for picture in pictures} == {(480, 640, 3)}
    blue, _, red = pictures[0].reshape(-1, 3).astype(int).T
    # The ball fills some of the picture of blue water.
    assert 0.01 < (red > blue + 60).mean() < 0.5


def test_a_card_is_filmed_the_same_way_twice() -> None:
    card = document(1, 'at = 0.2; do = "card"; colour = "yellow"', more="[vision]\nfilm = true")
    first, second = perform(card), perform(card)
    assert len(first.film) in range(21, 25)
    assert first.film == second.film


@pytest.mark.skipif(missing() is not None, reason="the scene cannot be rendered here")
def test_the_rendered_scene_is_seen() -> None:
    target = '\n[[scene.targets]]\ncolour = "red"\nposition = [0.9, 0.0, 0.2]\nsize = 0.3'
    vision = '[vision]\ncamera = "scene"\ncolour = "red"\nrate = 2'
    report = perform(document(1, scene='kind = "natural"\ndepth = 3.0' + target, more=vision))
    assert [detection["colour"] for detection in report.documents["detection"]] == ["red"] * 3
    assert report.documents["state"][-1]["camera"] == "rendered scene"


def test_a_cancelled_run_disarms_and_ends_in_order() -> None:
    report = Output()
    run = ScenarioRun(read_scenario(document(60, ARM)), boards()["host"], report)
    report.on_event = lambda event: run.cancel() if event.get("time") == 3.0 else None
    run.perform(lambda _: {})
    assert report.ended["state"] == "cancelled"
    assert report.ended["time"] == pytest.approx(3 + AFTERWARDS, abs=0.2)
    assert "The scenario was cancelled." in report.texts("event")
    assert any("disarmed: STOP" in text for text in report.texts("debug"))


def test_sigterm_cancels_the_process() -> None:
    command = [sys.executable, "-m", "robot_runtime.experiments.scenario", "--board", "host"]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(document(3000, ARM).encode())
        process.stdin.close()
        head = process.stdout.read(HEADER.size)
        process.send_signal(signal.SIGTERM)
        data = head + process.stdout.read()
    assert process.returncode == 0
    assert read_events(data)[-1]["state"] == "cancelled"


def test_a_bad_scenario_is_refused_with_all_problems() -> None:
    text = (
        document(5, 'at = 9; do = "arm"').replace('kind = "pool"', 'kind = "bath"') + "[robot]\nmass = -3.0\n"
    )
    status, data = run_process(text)
    (event,) = read_events(data)
    assert status == 2
    assert event["event"] == "refused"
    for message in ("bath", "mass", "9 s"):
        assert any(message in problem for problem in event["problems"]), message


def test_the_run_reports_its_firmware_and_software(tmp_path: Path) -> None:
    out = tmp_path / "run"
    status, nothing = run_process(document(1), "--out", str(out))
    assert (status, nothing) == (0, b"")
    started = read_events(out.read_bytes())[0]
    assert started.pop("firmware") != started.pop("software")
    assert started == {"event": "started", "time": 0.0, "scenario": "test", "seed": 7, "board": "host"}


def test_a_missing_build_of_the_board_is_reported(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "robot_runtime.experiments.scenario"]
    environment = {**os.environ, "MUCAT_BUILD": str(tmp_path)}
    done = subprocess.run(
        command, cwd=ROOT, input=document(1), capture_output=True, text=True, env=environment
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert "`make firmware` builds it" in done.stderr


@pytest.mark.parametrize(
    ("more", "title", "mass"),
    [
        ("", "Default craft", 3.0),
        ("[robot]\nmass = 3.5\n", "Default craft, changed", 3.5),
        ("[trim]\nbuoyancy = 1.01\nforward = 0\nright = 0\nabove = 0.01\n", "Default craft, changed", 3.0),
        ('craft = "robot"\n', "Turtle 2", 2.5),
    ],
)
def test_a_run_says_which_craft_swims(more: str, title: str, mass: float) -> None:
    robot = CraftDocument(title="Turtle 2", craft=Craft(mass=2.5))
    report = Output()
    own = more.startswith("craft")
    text = more + document(1) if own else document(1, more=more)
    scenario = read_scenario(text, robot.craft)
    ScenarioRun(scenario, boards()["host"], report, robot).perform(lambda _: {})
    (craft,) = report.documents["craft"]
    assert (craft["title"], craft["craft"]["mass"]) == (title, mass)
    assert 0 <= craft["time"] < 0.1


@pytest.mark.parametrize("board", ["host", "emulated"])
def test_a_leak_at_80_cm_stops_the_robot_and_it_surfaces(board: str) -> None:
    report = perform(
        document(
            80,
            'at = 1; do = "set_points"; default = 0.8; detected = 0.8',
            'at = 1; do = "arm"',
            'at = 25; do = "fault"; sensor = "leak"; kind = "wet"',
            'at = 60; do = "acknowledge"',
            'at = 61; do = "arm"',
        ),
        board,
    )
    assert report.between("depth", 24.9, 25.0)[0].depth == pytest.approx(0.8, abs=0.05)
    armed = [(time, bool(row.flags & StatusFlag.ARMED)) for time, row in report.rows["status"]]
    off = next(time for time, on in armed if time > 25.0 and not on)
    assert off < 25.4, "0.2 s of contact, and a status each 0.1 s"
    assert not any(on for time, on in armed if time >= off), "until the next start of the chip"
    first, *_ = (event for event in report.documents["event"] if event["time"] > 25.0)
    assert (first["kind"], first["severity"]) == ("leak", "alarm"), "and no other cause is named"
    assert "board_disarmed" not in {event["kind"] for event in report.documents["event"]}
    assert first["time"] < 25.6
    modes = {state["mode"] for state in report.documents["state"] if 25.7 < state["time"] < 59.9}
    assert modes == {"failsafe"}
    assert {drive for row in report.between("motor", off + 0.1, 1e9) for drive in row.drive} == {0.0}
    assert report.rows["depth"][-1][1].depth < 0.1
    texts = [text for _, text in report.markers]
    assert "Leak: wet" in texts
    assert any("water in the hull" in text for text in texts), "armed again it is refused"
