"""Unmodified clients of other people at the doors of the whole emulated robot."""

import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest

from tests.server.features.doors.ros2_rig import start_peer
from tests.server.ports import reserved_port
from tests.stack import Stack

CLIENTS = Path(__file__).parents[3] / "clients"
SECONDS = 120

pytestmark = pytest.mark.stack


@pytest.fixture(scope="module")
def _robot() -> Iterator[Stack]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as name, reserved_port() as port:
        config = Path(name) / "robot.toml"
        ros2 = f'ros2 = true\nros2_listen = "tls/127.0.0.1:{port}"\n'
        config.write_text(f"[doors]\nrosbridge = true\nfoxglove = true\n{ros2}", encoding="utf-8")
        with Stack(Path(name) / "data", "--config", str(config)) as stack:
            yield stack


@pytest.fixture
def robot(_robot: Stack) -> Stack:
    _robot.calm()
    return _robot


def token(robot: Stack, scope: str) -> str:
    name = f"{scope} {len(robot.api.get('/access/devices').json())}"
    answer = robot.api.post("/access/tokens", json={"name": name, "scope": scope})
    return str(answer.raise_for_status().json()["token"])


def address(robot: Stack, door: str, scope: str) -> str:
    return f"ws://127.0.0.1:{robot.port}/{door}?token={token(robot, scope)}"


def run(*command: str) -> dict[str, Any]:
    """Return the object that a client prints."""
    done = subprocess.run(command, cwd=CLIENTS, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    message = json.loads(done.stdout.splitlines()[-1])
    assert isinstance(message, dict)
    return message


@pytest.mark.parametrize("version", ["roslib-1", "roslib"])
def test_roslib_subscribes_to_everything_drives_with_control_and_stops(robot: Stack, version: str) -> None:
    answer = run(
        "node",
        "roslib.mjs",
        version,
        address(robot, "rosbridge", "operate"),
        address(robot, "rosbridge", "read"),
    )
    assert "/imu/data" in answer["topics"]["topics"]
    assert {"/mucat/stop", "/rosapi/topics"} <= set(answer["services"])
    assert answer["type"] == "sensor_msgs/msg/Imu"
    assert any("depth" in parameter for parameter in answer["parameters"])
    assert answer["imu"]["linear_acceleration"]["z"] == pytest.approx(9.8, abs=1.5)
    assert answer["imu"]["header"]["frame_id"] == "base_link"
    assert -0.2 < answer["cbor"]["depth"] < 3
    assert 90_000 < answer["png"]["fluid_pressure"] < 140_000
    assert "operator" in answer["refused"]["problem"]
    assert "control" in answer["before"]["problem"]
    assert answer["taken"]["values"]["success"]
    assert answer["armed"]["values"]["success"]
    assert answer["driven"]["x"] == pytest.approx(0.5, abs=0.01)
    assert answer["driven"]["yaw"] == pytest.approx(-0.25, abs=0.01)
    assert answer["stopped"] == "disarmed"


def test_roslibpy_reads_commands_and_stops(robot: Stack) -> None:
    answer = run(sys.executable, "roslibpy_client.py", address(robot, "rosbridge", "operate"))
    assert "/imu/data" in answer["topics"]
    assert answer["type"] == "sensor_msgs/msg/Imu"
    assert answer["imu"]["linear_acceleration"]["z"] == pytest.approx(9.8, abs=1.5)
    assert answer["taken"]["success"]
    assert answer["armed"]["success"]
    assert answer["stopped"]["success"]
    assert "set_point" in answer["refused"]


def test_foxgloves_own_client_shows_sets_drives_and_stops(robot: Stack) -> None:
    answer = run(
        "node", "foxglove.mjs", address(robot, "foxglove", "operate"), address(robot, "foxglove", "read")
    )
    assert answer["info"]["supportedEncodings"] == ["json"]
    latest = answer["latest"]
    for channel in answer["channels"]:
        assert json.loads(channel["schema"])["type"] == "object", channel["topic"]
        if channel["topic"] in latest:
            jsonschema_rs.validate(json.loads(channel["schema"]), latest[channel["topic"]])
    assert latest["/imu"]["force"][2] == pytest.approx(-9.8, abs=1.5)
    assert latest["/tf"]["parent_frame_id"] == "ned"
    assert latest["/tf_static"]["rotation"] == {"w": 0.0, "x": 1.0, "y": 0.0, "z": 0.0}
    assert latest["/pose"]["pose"]["position"]["z"] == pytest.approx(latest["/depth"]["depth"], abs=0.1)
    assert latest["/camera"]["format"] == "jpeg"
    assert {status["name"] for status in latest["/diagnostics"]["status"]} >= {
        "mucat: runtime",
        "mucat: board",
    }
    assert answer["parameters"]
    assert "operator" in answer["refused"]["refused"]
    assert "control" in answer["before"]["refused"]
    assert answer["taken"]["success"]
    assert answer["changed"] == answer["parameters"]["vision.rate"] + 1
    assert answer["armed"]["success"]
    assert answer["driven"]["x"] == pytest.approx(0.5, abs=0.01)
    assert answer["driven"]["yaw"] == pytest.approx(-0.25, abs=0.01)
    assert answer["stopped"]["success"]


def test_zenoh_ros2_sdk_reads_drives_and_stops(robot: Stack, tmp_path: Path) -> None:
    robot.api.post("/control/release")
    folder = tmp_path / "lab"
    config = robot.data.parent / "robot.toml"
    command = [str(robot.program), "certificate", "ros2", "lab", "--scope", "operate", "--to", str(folder)]
    command += ["--data", str(robot.data), "--config", str(config)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True, timeout=SECONDS).stdout
    (values,) = re.findall(r"ZENOH_CONFIG_OVERRIDE='(.*)' ros2 run", printed)
    peer = start_peer(
        tmp_path / "messages", values.replace("ADDRESS", "127.0.0.1").replace('"lab/', f'"{folder}/')
    )
    try:
        peer.subscribe("/imu/data", "sensor_msgs/msg/Imu")
        _, measured = peer.received.get(timeout=SECONDS)
        assert measured.linear_acceleration.z == pytest.approx(9.8, abs=1.5)
        assert measured.header.frame_id == "base_link"
        wheel = peer.publisher("/cmd_vel", "geometry_msgs/msg/Twist")
        assert peer.call("/mucat/arm")[0] is False
        assert peer.call("/mucat/take_control") == (True, "You have control.")
        assert peer.call("/mucat/arm")[0] is True
        peer.subscribe("/joint_states", "sensor_msgs/msg/JointState")
        vector = peer.type("geometry_msgs/msg/Vector3")
        sticks = {"linear": vector(x=0.5, y=0.0, z=0.0), "angular": vector(x=0.0, y=0.0, z=0.0)}
        end, swung = time.monotonic() + SECONDS, 0.0
        while swung < 0.1:
            assert time.monotonic() < end, "the fins do not move"
            wheel.publish(**sticks)
            topic, message = peer.received.get(timeout=SECONDS)
            if topic == "/joint_states":
                swung = max(abs(message.position))
        assert peer.call("/mucat/stop")[0] is True
        while robot.api.get("/robot").json()["armed"]:
            assert time.monotonic() < end, "the robot stays armed"
            time.sleep(0.02)
    finally:
        peer.close()
