"""The doors and their clients, for the page System."""

from typing import Literal

from pydantic import BaseModel, Field


class DoorClientDetails(BaseModel):
    """A program that is connected."""

    name: str = Field(description="of its token")
    role: Literal["viewer", "operator"]
    address: str
    since: float = Field(description="s, steady clock")
    topics: list[str] = Field(description="that it subscribes to")
    sent: int = Field(description="messages so far")
    in_control: bool


class DoorDetails(BaseModel):
    """A door for other programs."""

    name: Literal["rosbridge", "foxglove"]
    path: str
    open: bool = Field(description="`[doors]` in robot.toml says so")
    clients: list[DoorClientDetails]
