"""The robot's topics as messages of ROS 2, in its axes and units, with UTC stamps."""

from collections.abc import Mapping
from math import isfinite, nan
from typing import Any

from robot_runtime.contract.documents import Control, Truth
from robot_runtime.contract.packets import (
    Beacon,
    Depth,
    Imu,
    Motor,
    Status,
    StatusFlag,
)
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import (
    BALANCED,
    BEACON,
    CONTROL,
    DEBUG,
    DEPTH,
    IMU,
    MASK,
    MOTOR,
    OBSERVER,
    PICTURE,
    STATUS,
    TOPICS,
    TRUTH,
    Kind,
)
from server.features.doors.channels import HEALTH, DoorChannel, Fields, Sample, convert_poses
from server.features.doors.ros_axes import BASE, ODOM, quaternion, vector
from server.interchange.pose_tracker import POSE_TOPICS, Pose

BILLION = 1_000_000_000
FIN_NAMES = ["fin_front_right", "fin_back_right", "fin_back_left", "fin_front_left"]
UNKNOWN_COVARIANCE = [0.0] * 9
"""REP 145: all zeros mean that the covariance is not known."""
LOG_LEVELS = {"info": 20, "caution": 30, "alarm": 40}
DEBUG_LEVELS = (10, 20, 30, 40)
HEALTH_LEVELS = {"ok": 0, "starting": 1, "absent": 0, "failed": 2, "unknown": 3}
PICTURES = {
    PICTURE.name: "camera",
    OBSERVER.name: "observer",
    MASK.name: "camera",
    BALANCED.name: "camera",
}


def stamp(time: int) -> dict[str, int]:
    """Return a time (ns, UTC) as builtin_interfaces/Time."""
    seconds, rest = divmod(time, BILLION)
    return {"sec": seconds, "nanosec": rest}


def header(time: int, frame: str = BASE) -> Fields:
    """Return a std_msgs/Header."""
    return {"stamp": stamp(time), "frame_id": frame}


def type_name(named: str) -> str:
    """Return a type's name as ROS 2 writes it; ROS 1 leaves `msg` out."""
    package, _, rest = named.partition("/")
    return named if "/" in rest else f"{package}/msg/{rest}"


def _transform(time: int, pose: Pose) -> Fields:
    turned = {"translation": vector(pose.position), "rotation": quaternion(pose.attitude)}
    return {"transforms": [{"header": header(time, ODOM), "child_frame_id": BASE, "transform": turned}]}


def _pose(time: int, pose: Pose) -> Fields:
    placed = {"position": vector(pose.position), "orientation": quaternion(pose.attitude)}
    return {"header": header(time, ODOM), "pose": placed}


def _imu(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Imu)
    return {
        "header": header(sample.time),
        "orientation": quaternion(value.attitude),
        "orientation_covariance": UNKNOWN_COVARIANCE,
        "angular_velocity": vector(value.rate),
        "angular_velocity_covariance": UNKNOWN_COVARIANCE,
        "linear_acceleration": vector(value.force),
        "linear_acceleration_covariance": UNKNOWN_COVARIANCE,
    }


def _depth(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Depth)
    return {"data": value.depth}


def _pressure(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Depth)
    return {"header": header(sample.time), "fluid_pressure": float(value.pressure), "variance": 0.0}


def _temperature(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Depth)
    return {"header": header(sample.time), "temperature": value.temperature, "variance": 0.0}


def _battery(sample: Sample) -> Fields:
    """Return a sensor_msgs/BatteryState, in which a value that is not measured is NaN."""
    value = sample.value
    assert isinstance(value, Status)
    low = bool(value.flags & StatusFlag.BATTERY_LOW)
    return {
        "header": header(sample.time),
        "voltage": value.battery,
        **dict.fromkeys(
            ("temperature", "current", "charge", "capacity", "design_capacity", "percentage"), nan
        ),
        "power_supply_status": 2,  # discharging
        "power_supply_health": 5 if low else 1,  # "unspecified failure": it is low; "good"
        "power_supply_technology": 0,
        "present": True,
        "cell_voltage": [],
        "cell_temperature": [],
        "location": "",
        "serial_number": "",
    }


def _joints(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Motor)
    return {
        "header": header(sample.time),
        "name": FIN_NAMES,
        "position": list(value.angle),
        "velocity": [],
        "effort": [],
    }


def _beacon_right(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Beacon)
    return {"data": bool(value.right)}


def _beacon_left(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Beacon)
    return {"data": bool(value.left)}


def _set_point(sample: Sample) -> Fields | None:
    value = sample.value
    assert isinstance(value, Control)
    return {"data": value.set_point} if isfinite(value.set_point) else None


def _odometry(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Truth)
    return {
        "header": header(sample.time, ODOM),
        "child_frame_id": BASE,
        "pose": {
            "pose": {"position": vector(value.position), "orientation": quaternion(value.attitude)},
            "covariance": [0.0] * 36,
        },
        "twist": {
            "twist": {"linear": vector(value.velocity), "angular": vector(value.rate)},
            "covariance": [0.0] * 36,
        },
    }


def _picture(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, bytes)
    return {"header": header(sample.time, PICTURES[sample.source]), "format": "jpeg", "data": value}


def _log(sample: Sample) -> Fields:
    value = sample.value
    assert isinstance(value, Mapping)
    if sample.source == DEBUG.name:
        level = DEBUG_LEVELS[max(0, min(3, int(value["level"])))]
    else:
        level = LOG_LEVELS.get(str(value.get("severity", "")), LOG_LEVELS["info"])
    return {
        "stamp": stamp(sample.time),
        "level": level,
        "name": str(value.get("kind", sample.source)),
        "msg": str(value["text"]),
        "file": sample.source,
        "function": "",
        "line": 0,
    }


def diagnostics(sample: Sample) -> Fields:
    """Return a diagnostic_msgs/DiagnosticArray of the health of the robot's parts."""
    value = sample.value
    assert isinstance(value, Mapping)
    return {
        "header": header(sample.time, ""),
        "status": [
            {
                "level": HEALTH_LEVELS.get(part["state"], 3),
                "name": f"mucat: {part['name']}",
                "message": part["text"],
                "hardware_id": "mucat",
                "values": [{"key": "state", "value": part["state"]}],
            }
            for part in value["parts"]
        ],
    }


def _own(sample: Sample) -> Fields:
    """Return a topic of ours unchanged: our axes and names, with a stamp."""
    value = sample.value
    assert not isinstance(value, bytes)
    values = _fields(value) if isinstance(value, Record) else dict(value)
    values.pop("time", None)
    return {"stamp": stamp(sample.time), **values}


def _fields(record: Record) -> dict[str, Any]:
    values = {name: getattr(record, name) for name in record.wires}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}


DIAGNOSTICS, IMAGE = "diagnostic_msgs/msg/DiagnosticArray", "sensor_msgs/msg/CompressedImage"
LINES = tuple(topic.name for topic in TOPICS if topic.lines)


def standard_channels() -> list[DoorChannel]:
    """Return the channels whose types are ROS's own."""
    standard = [
        DoorChannel("/imu/data", "sensor_msgs/msg/Imu", (IMU.name,), _imu),
        DoorChannel("/depth", "std_msgs/msg/Float64", (DEPTH.name,), _depth),
        DoorChannel("/pressure", "sensor_msgs/msg/FluidPressure", (DEPTH.name,), _pressure),
        DoorChannel("/temperature", "sensor_msgs/msg/Temperature", (DEPTH.name,), _temperature),
        DoorChannel("/battery", "sensor_msgs/msg/BatteryState", (STATUS.name,), _battery),
        DoorChannel("/joint_states", "sensor_msgs/msg/JointState", (MOTOR.name,), _joints),
        DoorChannel("/beacon/right", "std_msgs/msg/Bool", (BEACON.name,), _beacon_right),
        DoorChannel("/beacon/left", "std_msgs/msg/Bool", (BEACON.name,), _beacon_left),
        DoorChannel("/depth/set_point", "std_msgs/msg/Float64", (CONTROL.name,), _set_point),
        DoorChannel("/pose", "geometry_msgs/msg/PoseStamped", POSE_TOPICS, convert_poses(_pose)),
        DoorChannel("/tf", "tf2_msgs/msg/TFMessage", POSE_TOPICS, convert_poses(_transform)),
        DoorChannel("/truth/odometry", "nav_msgs/msg/Odometry", (TRUTH.name,), _odometry),
        DoorChannel("/rosout", "rcl_interfaces/msg/Log", LINES, _log, lossless=True),
        DoorChannel(
            "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", (HEALTH,), diagnostics, latched=True
        ),
    ]
    pictures = [
        DoorChannel(
            f"/{_picture_name(name)}/compressed", "sensor_msgs/msg/CompressedImage", (name,), _picture
        )
        for name in PICTURES
    ]
    return [*standard, *pictures]


def ros_channels() -> list[DoorChannel]:
    """Return all channels of the rosbridge door."""
    own = [
        DoorChannel(
            f"/mucat/{topic.name}",
            f"mucat/msg/{topic.name.capitalize()}",
            (topic.name,),
            _own,
            latched=topic.newest_only,
            lossless=topic.lines,
        )
        for topic in TOPICS
        if topic.kind in (Kind.ROWS, Kind.DOCUMENTS)
    ]
    return [*standard_channels(), *own]


def _picture_name(topic: str) -> str:
    return {PICTURE.name: "camera/image", OBSERVER.name: "observer/image"}.get(topic, f"camera/{topic}")
