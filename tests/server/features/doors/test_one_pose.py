"""A dive with a known truth has the same roll, pitch, yaw and depth through every door and in every file.

The attitude is built from the angles here, by rotations about the axes one after the other, so that no two
doors can agree on the same mistake.
"""

import asyncio
import json
import math
import tempfile
import zipfile
from collections.abc import Sequence
from contextlib import AsyncExitStack
from dataclasses import asdict, replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import pandas
import pytest
from mcap.reader import make_reader

from mucat import FolderSessions, Robot, Sessions
from robot_runtime.config import RobotConfig
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import BY_NAME
from server.features.doors.config import DoorsConfig
from server.features.exports.formats import KINDS
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.health.monitor import HealthMonitor
from server.platform.authority import Authority
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Reader
from server.recording.session import find_row
from tests.server.blocks import state_block
from tests.server.features.doors import ros2_rig
from tests.server.features.doors.rig import (
    RosbridgeClient,
    imu,
    make_token,
    open_rosbridge,
    rows_block,
    truth,
)
from tests.server.features.doors.test_foxglove import next_message, open_foxglove, subscribe
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS, until

Pose = tuple[float, float, float, float]
"""Roll, pitch, yaw (rad; right side down, nose up, to the right) and depth (m, downwards)."""
Quaternion = tuple[float, float, float, float]
TRUTH: tuple[Pose, ...] = (
    (0.0, 0.0, 0.0, 0.25),
    (0.3, 0.0, 0.0, 0.5),
    (0.0, 0.4, 0.0, 0.75),
    (0.0, 0.0, 0.9, 1.0),
    (-0.5, 0.25, -2.5, 1.25),
)
ROS_TOPICS = {
    "/imu/data": "sensor_msgs/msg/Imu",
    "/depth": "std_msgs/msg/Float64",
    "/truth/odometry": "nav_msgs/msg/Odometry",
    "/pose": "geometry_msgs/msg/PoseStamped",
    "/tf": "tf2_msgs/msg/TFMessage",
}
ROS_DOORS = ("rosbridge", "ROS 2")
WAYS = (
    *(f"{door}: /imu/data and /depth" for door in ROS_DOORS),
    *(f"{door}: {topic}" for door in ROS_DOORS for topic in ("/truth/odometry", "/pose", "/tf")),
    "Foxglove: /imu and /depth",
    "Foxglove: /pose",
    "Foxglove: /tf",
    "Python: live",
    "Python: session of the server",
    "Python: data folder",
    "CSV",
    "MCAP: /imu and /depth",
    "MCAP: /pose",
)


def multiply(first: Quaternion, other: Quaternion) -> Quaternion:
    """Hamilton's product."""
    a, b, c, d = first
    e, f, g, h = other
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )


def turn(axis: int, angle: float) -> Quaternion:
    """Return a rotation about one axis."""
    values = [math.cos(angle / 2), 0.0, 0.0, 0.0]
    values[1 + axis] = math.sin(angle / 2)
    return (values[0], values[1], values[2], values[3])


def attitude_of(pose: Pose) -> Quaternion:
    """Yaw about down, then pitch about the right side, then roll about forward."""
    roll, pitch, yaw, _ = pose
    return multiply(multiply(turn(2, yaw), turn(1, pitch)), turn(0, roll))


def pose_of(attitude: Sequence[float], depth: float) -> Pose:
    """Return the pose of an attitude (w, x, y, z) in our axes."""
    w, x, y, z = attitude
    return (
        math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x)))),
        math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        depth,
    )


def ros_pose(orientation: dict[str, float], depth: float) -> Pose:
    """Return the pose of a message in ROS's axes: there a nose up and a turn to the right are negative."""
    roll, pitch, yaw, _ = pose_of([orientation[axis] for axis in "wxyz"], 0.0)
    return roll, -pitch, -yaw, depth


def foxglove_pose(message: dict[str, Any]) -> Pose:
    """Return the pose of a foxglove.PoseInFrame in the frame `ned`."""
    assert message["frame_id"] == "ned"
    pose = message["pose"]
    return pose_of([pose["orientation"][axis] for axis in "wxyz"], pose["position"]["z"])


def foxglove_transform(message: dict[str, Any]) -> Pose:
    """Return the pose of a foxglove.FrameTransform from the frame `ned`."""
    assert (message["parent_frame_id"], message["child_frame_id"]) == ("ned", "turtle")
    return pose_of([message["rotation"][axis] for axis in "wxyz"], message["translation"]["z"])


def frame_poses(imus: pandas.DataFrame, depths: pandas.DataFrame) -> list[Pose]:
    """Return the poses in two tables."""
    attitudes = imus[[f"attitude_{position}" for position in range(4)]].to_numpy().tolist()
    return [pose_of(attitude, depth) for attitude, depth in zip(attitudes, depths["depth"], strict=True)]


def ros_poses(door: str, result: dict[str, list[Any]]) -> dict[str, list[Pose]]:
    """Return the poses by ROS's messages of these topics."""
    measured = zip(result["/imu/data"], result["/depth"], strict=True)
    odometry = [message["pose"]["pose"] for message in result["/truth/odometry"]]
    poses = [message["pose"] for message in result["/pose"]]
    transforms = [message["transforms"][0]["transform"] for message in result["/tf"]]
    return {
        f"{door}: /imu/data and /depth": [
            ros_pose(attitude["orientation"], depth["data"]) for attitude, depth in measured
        ],
        f"{door}: /truth/odometry": [
            ros_pose(message["orientation"], -message["position"]["z"]) for message in odometry
        ],
        f"{door}: /pose": [ros_pose(pose["orientation"], -pose["position"]["z"]) for pose in poses],
        f"{door}: /tf": [
            ros_pose(transform["rotation"], -transform["translation"]["z"]) for transform in transforms
        ],
    }


def is_whole(result: dict[Any, list[Any]]) -> bool:
    """Return True where all messages have come."""
    return all(len(messages) >= len(TRUTH) for messages in result.values())


async def from_rosbridge(client: RosbridgeClient) -> dict[str, list[Pose]]:
    results: dict[str, list[Any]] = {topic: [] for topic in ROS_TOPICS}
    while not is_whole(results):
        message = await client.next("publish")
        results[message["topic"]].append(message["msg"])
    return ros_poses("rosbridge", results)


async def from_ros2(peer: ros2_rig.Ros2Peer) -> dict[str, list[Pose]]:
    results: dict[str, list[Any]] = {topic: [] for topic in ROS_TOPICS}
    while not is_whole(results):
        topic, message = await asyncio.to_thread(peer.received.get, timeout=SECONDS)
        results[topic].append(asdict(message))
    return ros_poses("ROS 2", results)


async def from_foxglove(socket: Any, numbers: dict[str, int]) -> dict[str, list[Pose]]:
    results: dict[int, list[Any]] = {number: [] for number in numbers.values()}
    while not is_whole(results):
        number, _, message = await next_message(socket)
        results[number].append(message)
    measured = zip(results[numbers["/imu"]], results[numbers["/depth"]], strict=True)
    return {
        "Foxglove: /imu and /depth": [
            pose_of(message["attitude"], depth["depth"]) for message, depth in measured
        ],
        "Foxglove: /pose": [*map(foxglove_pose, results[numbers["/pose"]])],
        "Foxglove: /tf": [*map(foxglove_transform, results[numbers["/tf"]])],
    }


async def from_python(robot: Robot, reading: asyncio.Event) -> dict[str, list[Pose]]:
    attitudes: list[Any] = []
    depths: list[float] = []
    async for sample in robot.live_async("imu", "depth", "state"):
        if sample.topic == "state":
            reading.set()
        elif sample.topic == "imu":
            attitudes.append(sample["attitude"])
        else:
            depths.append(sample["depth"])
        if len(attitudes) == len(depths) == len(TRUTH):
            break
    return {
        "Python: live": [pose_of(attitude, depth) for attitude, depth in zip(attitudes, depths, strict=True)]
    }


def from_files(served: Served, token: str, session: int, folder: Path) -> dict[str, list[Pose]]:
    """Return the poses of a session by the Python package, and of the files of two exports."""
    sessions = Sessions(f"http://127.0.0.1:{served.settings.server.port}", token)
    results = {}
    for way, tables in (
        ("Python: session of the server", sessions.load(session)),
        ("Python: data folder", FolderSessions(served.settings.data.path).load(session)),
    ):
        results[way] = frame_poses(tables.pandas("imu"), tables.pandas("depth"))
    return results | from_exports(served.settings, session, folder)


def from_exports(settings: Settings, session: int, folder: Path) -> dict[str, list[Pose]]:
    store = Reader(settings.data.database)
    row = find_row(store, session)
    for kind in ("csv", "mcap"):
        options = ExportOptions.model_validate({"format": kind})
        with (folder / kind).open("wb") as output:
            KINDS[options.format].write(store, ExportSelection(store, row, options), output)
    with zipfile.ZipFile(folder / "csv") as files:
        imus, depths = (pandas.read_csv(files.open(f"{name}.csv")) for name in ("imu", "depth"))
    depths = depths.rename(columns={"depth [m]": "depth"})
    messages: dict[str, list[Any]] = {"/imu": [], "/depth": [], "/pose": []}
    with (folder / "mcap").open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages(topics=[*messages]):
            messages[channel.topic].append(json.loads(message.data))
    measured = zip(messages["/imu"], messages["/depth"], strict=True)
    return {
        "CSV": frame_poses(imus, depths),
        "MCAP: /imu and /depth": [
            pose_of(message["attitude"], depth["depth"]) for message, depth in measured
        ],
        "MCAP: /pose": [*map(foxglove_pose, messages["/pose"])],
    }


def has_come(served: Served, topic: str, position: int) -> bool:
    """Return True where the sample of this place has come."""
    newest = served.get(HealthMonitor)._newest.get(BY_NAME[topic])
    return newest is not None and newest[1].first == position


async def dive(served: Served, folder: Path) -> dict[str, list[Pose]]:
    """Record the poses while a program is at each door; return what each of them got."""
    token = await make_token(served)
    async with AsyncExitStack() as stack:
        client = RosbridgeClient(await stack.enter_async_context(open_rosbridge(served, token)))
        credentials = ros2_rig.tls_settings(served, await ros2_rig.issue(served, "read"))
        peer = await stack.enter_async_context(ros2_rig.ros2_peer(served, credentials))
        for topic, kind in ROS_TOPICS.items():
            await client.say(op="subscribe", topic=topic)
            await asyncio.to_thread(peer.subscribe, topic, kind)
        await until(lambda: ros2_rig.subscribed(served) == ROS_TOPICS.keys(), "the subscriptions")
        await client.call("/rosapi/get_time")
        socket = await stack.enter_async_context(open_foxglove(served, token))
        numbers = await subscribe(socket, "/imu", "/depth", "/pose", "/tf")
        reading = asyncio.Event()
        robot = Robot(f"http://127.0.0.1:{served.settings.server.port}", token)
        programs = [
            asyncio.create_task(work)
            for work in (
                from_rosbridge(client),
                from_ros2(peer),
                from_foxglove(socket, numbers),
                from_python(robot, reading),
            )
        ]
        started = await served.api.post("/sessions", json={"name": "Known truth"})
        session = started.raise_for_status().json()["id"]
        states = count()
        while not reading.is_set():
            served.runtime.publish(state_block(next(states)))
            await asyncio.sleep(0.02)
        now = served.container.clock.now()
        for index, pose in enumerate(TRUTH):
            time, attitude = now + index / 5, attitude_of(pose)
            depth = Depth(time=0, depth=pose[3], pressure=101_325, temperature=18.0)
            # The pose has the newest position when an attitude comes.
            before = time - 0.01
            served.runtime.publish(rows_block("truth", index, (before, truth((1.0, 2.0, pose[3]), attitude))))
            served.runtime.publish(rows_block("depth", index, (before, depth)))
            while not has_come(served, "truth", index):
                # A message of the simulator waits in the server for the robot's next one.
                served.runtime.publish(state_block(next(states)))
                await asyncio.sleep(0.02)
            served.runtime.publish(rows_block("imu", index, (time, imu(attitude))))
            await until(partial(has_come, served, "imu", index), "the attitude")
        results: dict[str, list[Pose]] = {}
        for gathered in await asyncio.gather(*programs):
            results |= gathered
    (await served.api.post(f"/sessions/{session}/stop")).raise_for_status()
    return results | await asyncio.to_thread(from_files, served, token, session, folder)


@pytest.fixture(scope="module")
def poses() -> dict[str, list[Pose]]:
    """The poses by the way in which they came."""
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder = DataFolder(Path(name) / "data")
        make_folders(folder)
        config = Path(name) / "robot.toml"
        config.write_text('[robot]\nname = "tested"\n', encoding="utf-8")

        doors = replace(ros2_rig.OPEN, foxglove=True)
        settings = Settings(
            data=folder, config=config, robot=RobotConfig(name="tested"), sections={DoorsConfig: doors}
        )
        Authority(settings).prepare()

        async def perform() -> dict[str, list[Pose]]:
            async with serve(settings) as served:
                return await dive(served, Path(name))

        return asyncio.run(perform())


@pytest.mark.parametrize("way", WAYS)
def test_every_way_gives_the_roll_pitch_yaw_and_depth_of_the_truth(
    poses: dict[str, list[Pose]], way: str
) -> None:
    assert len(poses[way]) == len(TRUTH)
    for result, true in zip(poses[way], TRUTH, strict=True):
        # The wire has 15 bits of a quaternion's number, and depth in mm.
        assert result == pytest.approx(true, abs=3e-4)
