"""The section [doors] of robot.toml."""

import re
from dataclasses import dataclass
from typing import Annotated

from robot_runtime.config import NETWORK_ENDPOINT
from robot_runtime.contract.limits import ConfigError, Range

ROS2_NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]{0,63}){0,4}")


@dataclass(frozen=True, slots=True, kw_only=True)
class DoorsConfig:
    """The doors for other programs: `/rosbridge` and `/foxglove` of the server, ROS 2; closed unless true.

    For ROS 2: the endpoint, the domain, and the namespace, "" or as "/name".
    """

    rosbridge: bool = False
    foxglove: bool = False
    ros2: bool = False
    ros2_listen: str = "tls/127.0.0.1:7448"
    ros2_domain: Annotated[int, Range(0, 232)] = 0
    ros2_namespace: str = ""

    def __post_init__(self) -> None:
        if not NETWORK_ENDPOINT.fullmatch(self.ros2_listen):
            raise ConfigError(
                f"doors.ros2_listen is {self.ros2_listen!r}, which would let in programs without a "
                'certificate of this robot; use "tls/ADDRESS:PORT"'
            )
        if not ROS2_NAMESPACE.fullmatch(self.ros2_namespace):
            raise ConfigError(
                f'doors.ros2_namespace is {self.ros2_namespace!r}; use a name of ROS 2 such as "/turtle", or '
                '"" for none'
            )

    @property
    def ros2_address(self) -> tuple[str, int]:
        """The host and port of the door for ROS 2."""
        host, _, port = self.ros2_listen.removeprefix("tls/").rpartition(":")
        return host.strip("[]"), int(port)
