"""The door for ROS 2 at the server's start: what it lacks is said in words."""

import stat
from dataclasses import replace

import pytest

from robot_runtime.contract.limits import ConfigError
from server.features.doors.config import DoorsConfig
from server.features.doors.ros2_certificates import check_ros2
from server.features.doors.ros2_messages import NO_ROSBAGS
from server.platform.authority import Authority
from server.platform.settings import Settings, SetupError


def test_without_certificates_the_start_is_refused(settings: Settings) -> None:
    with pytest.raises(SetupError, match=r"lacks authority\.pem, certificate\.pem, key\.pem"):
        check_ros2(settings)
    Authority(settings).prepare()
    check_ros2(settings)
    (settings.data.zenoh / "key.pem").write_text("damaged")
    with pytest.raises(SetupError, match="cannot be used"):
        check_ros2(settings)
    (settings.data.zenoh / "key.pem").unlink()
    with pytest.raises(SetupError, match=r"lacks key\.pem"):
        check_ros2(settings)


def test_without_rosbags_the_start_is_refused(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("server.features.doors.ros2_messages.find_spec", lambda _: None)
    with pytest.raises(SetupError, match="pip install") as refused:
        check_ros2(settings)
    assert str(refused.value) == NO_ROSBAGS


@pytest.mark.parametrize("endpoint", ["tcp/0.0.0.0:7448", "tls/0.0.0.0:7448?verify=0", "tls/0.0.0.0", ""])
def test_an_endpoint_without_certificates_is_refused(endpoint: str) -> None:
    with pytest.raises(ConfigError, match="without a certificate of this robot"):
        DoorsConfig(ros2=True, ros2_listen=endpoint)


@pytest.mark.parametrize("namespace", ["turtle", "/", "/a/", "/1", "/a b", "/*", "/a" * 5])
def test_a_namespace_is_one_of_ros(namespace: str) -> None:
    with pytest.raises(ConfigError, match="ros2_namespace"):
        DoorsConfig(ros2_namespace=namespace)


def test_the_endpoint_may_have_any_address() -> None:
    assert DoorsConfig().ros2_address == ("127.0.0.1", 7448)
    assert replace(DoorsConfig(), ros2_listen="tls/[::1]:7").ros2_address == ("::1", 7)


def test_other_users_of_this_computer_reach_neither_sockets_nor_keys(settings: Settings) -> None:
    Authority(settings).prepare()
    for position in (
        settings.data.run,
        settings.data.zenoh / "key.pem",
        settings.data.zenoh / "authority.key",
    ):
        assert not position.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO), position
