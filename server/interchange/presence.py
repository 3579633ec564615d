"""A robot's presence: what it says of itself to its lab once a second."""

from typing import Annotated

from pydantic import ConfigDict, Field

from robot_runtime.contract.documents import Mode, Severity
from robot_runtime.contract.missions import MissionPhase
from server.platform.schema_base import Schema

ALARMS_MAX = 20
Text = Annotated[str, Field(max_length=500)]


class PresentMission(Schema):
    """The mission that a robot carries out, or has carried out last; `progress` from 0 to 1."""

    title: Text
    phase: MissionPhase
    progress: float


class PresentAlarm(Schema):
    """An active alarm of a robot."""

    severity: Severity
    what: Text


class Presence(Schema):
    """A robot as it is now. A robot that has left the lab says so with its last presence."""

    model_config = ConfigDict(allow_inf_nan=False)
    mode: Annotated[Mode | None, Field(description="null while its runtime is silent")]
    armed: bool
    connected: Annotated[bool, Field(description="true while its board answers")]
    depth: Annotated[float | None, Field(description="m; null without a recent one")]
    battery: Annotated[float | None, Field(description="V; null without a recent one")]
    battery_left: Annotated[float | None, Field(description="s until the low-battery alarm, estimated")]
    mission: Annotated[PresentMission | None, Field(description="null where none is going on")]
    recording: Annotated[Text | None, Field(description="name of the session being recorded")]
    disk_free: Annotated[int, Field(description="bytes")]
    disk_total: Annotated[int, Field(description="bytes")]
    alarms: Annotated[list[PresentAlarm], Field(max_length=ALARMS_MAX)]
    software: Text
    address: Annotated[Text, Field(description="of its own page; empty where that is for its computer alone")]
    fingerprint: Annotated[str, Field(max_length=100, description="of its certificate; empty without TLS")]
    left: bool = False
