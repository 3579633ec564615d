"""The events that are published to other programs, by MQTT (docs/use/events.md)."""

from dataclasses import dataclass, field
from typing import Literal

from robot_runtime.contract.documents import Severity

PublishedKind = Literal[
    "alarm_began",
    "alarm_ended",
    "session_began",
    "session_ended",
    "comm_test_ended",
    "scenario_ended",
    "tuning_ended",
    "mission_ended",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedEvent:
    """An event of the robot, as other programs receive it."""

    robot: str = field(metadata={"meaning": "its name"})
    event: PublishedKind
    run: str = field(metadata={"meaning": "16 hexadecimal digits, new at every start of the server"})
    number: int = field(metadata={"meaning": "from 1 in this run; a hole shows that events were lost"})
    time: str = field(metadata={"meaning": "UTC by ISO 8601, with milliseconds"})
    subject: str = field(
        metadata={"meaning": "the fault in one word, or the name of session, test, scenario or mission"}
    )
    id: int | str | None = field(
        metadata={"meaning": "the number of session, test, tuning run or mission; text of a scenario's run"}
    )
    session: int | None = field(metadata={"meaning": "the session that recorded it, where it is known"})
    state: str = field(
        metadata={
            "meaning": "`active`, `over`, `recording`, `ended`; of a test or run `complete`, `cancelled`, "
            "`stopped`, `failed`; of a mission `succeeded`, `failed`, `ended`"
        }
    )
    severity: Severity
    text: str = field(metadata={"meaning": "for a person: what happened, and what to do"})
