"""The doors and their clients, for the page System."""

from typing import Literal

from pydantic import Field

from server.platform.schema_base import Schema


class DoorClientDetails(Schema):
    """A program that is connected."""

    name: str = Field(description="of its token")
    role: Literal["viewer", "operator"]
    address: str
    since: float = Field(description="s, steady clock")
    topics: list[str] = Field(description="that it subscribes to")
    sent: int = Field(description="messages so far")
    refused: int = Field(description="messages and calls of a ROS 2 program that were refused")
    in_control: bool


class DoorDetails(Schema):
    """A door for other programs."""

    name: Literal["rosbridge", "foxglove", "ros2"]
    path: str = Field(description="below the server's address; for ROS 2 the endpoint of Zenoh")
    open: bool = Field(description="`[doors]` in robot.toml says so")
    clients: list[DoorClientDetails]
