"""Keys, tokens and type hashes against those of ROS 2 itself and of zenoh-ros2-sdk."""

from pathlib import Path

import pytest
from zenoh_ros2_sdk.entity import EndpointEntity, EntityKind, NodeEntity
from zenoh_ros2_sdk.keyexpr import endpoint_liveliness_keyexpr, node_liveliness_keyexpr, topic_keyexpr
from zenoh_ros2_sdk.qos import QosDurability, QosProfile
from zenoh_ros2_sdk.utils import compute_service_type_hash, get_type_hash

from server.features.doors.ros2_messages import TRIGGER, ros2_types
from server.features.doors.ros2_names import Attachment, Endpoint, Ros2Names
from server.features.doors.ros2_session import ros2_endpoints
from server.features.doors.ros_channels import standard_channels
from server.features.doors.twist import TAKEN_IN
from tests.server.features.doors.ros2_rig import TRIGGER_DEFINITIONS, write_definitions

KINDS = sorted({channel.type for channel in standard_channels()} | {*TAKEN_IN.values()})
OF_ROS = {
    "diagnostic_msgs/msg/DiagnosticArray": (
        "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"
    ),
    "geometry_msgs/msg/Twist": "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "nav_msgs/msg/Odometry": "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "sensor_msgs/msg/BatteryState": "RIHS01_4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741",
    "sensor_msgs/msg/Imu": "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "std_msgs/msg/Empty": "RIHS01_20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312",
    "std_srvs/srv/Trigger": "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
}
"""As programs and manuals of ROS 2 publish them."""
SESSION = "1c43397412762d233527b73878fce17f"


@pytest.mark.parametrize(("kind", "expected"), OF_ROS.items())
def test_hashes_are_those_of_ros(kind: str, expected: str) -> None:
    assert ros2_types().hash(kind) == expected


def test_hashes_are_those_that_an_independent_program_computes(tmp_path: Path) -> None:
    for kind in KINDS:
        folder = tmp_path / kind
        write_definitions(kind, folder)
        definitions = {
            str(path.relative_to(folder).with_suffix("")): path.read_text() for path in folder.rglob("*.msg")
        }
        assert ros2_types().hash(kind) == get_type_hash(kind, definitions.pop(kind), definitions), kind
    assert ros2_types().hash(TRIGGER) == compute_service_type_hash(TRIGGER, *TRIGGER_DEFINITIONS)


def test_definitions_are_the_same_in_all_distributions_with_hashes() -> None:
    from rosbags.typesys import Stores, get_typestore

    for name in ("ROS2_IRON", "ROS2_KILTED", "ROS2_LYRICAL"):
        other = get_typestore(Stores[name])
        for kind in KINDS:
            assert ros2_types().hash(kind) == other.hash_rihs01(kind), (name, kind)


@pytest.mark.parametrize("namespace", ["", "/turtle"])
def test_keys_and_tokens_are_those_of_an_independent_program(namespace: str) -> None:
    names = Ros2Names(7, namespace)
    node = NodeEntity(7, SESSION, 0, "mucat", namespace or "/")
    assert names.node_token(SESSION) == node_liveliness_keyexpr(node)
    kinds = {"MP": EntityKind.PUBLISHER, "MS": EntityKind.SUBSCRIPTION, "SS": EntityKind.SERVICE}
    for number, endpoint in enumerate(ros2_endpoints(standard_channels()), 1):
        durability = QosDurability.TRANSIENT_LOCAL if endpoint.latched else QosDurability.VOLATILE
        qos = QosProfile(durability=durability, history_depth=endpoint.depth).encode()
        full = namespace + endpoint.name
        entity = EndpointEntity(
            node, number, kinds[endpoint.kind], full, endpoint.wire_type, endpoint.hash, qos
        )
        assert names.token(SESSION, number, endpoint) == endpoint_liveliness_keyexpr(entity)
        assert names.key(endpoint) == topic_keyexpr(7, full, endpoint.wire_type, endpoint.hash)


def test_a_type_has_the_name_of_dds() -> None:
    endpoint = Endpoint("MP", "/imu/data", "sensor_msgs/msg/Imu", "RIHS01_0")
    assert endpoint.wire_type == "sensor_msgs::msg::dds_::Imu_"


def test_an_attachment_is_33_bytes() -> None:
    sent = Attachment(3, 5, bytes(range(16))).to_bytes()
    assert sent.hex() == "0300000000000000050000000000000010" + bytes(range(16)).hex()
