"""The filter for stick commands between page and runtime: each passes at once, or is dropped and counted.

None is stored for later: a late command would steer a robot that has swum on.
"""

import json
from collections.abc import Callable
from typing import Annotated

from pydantic import ConfigDict, Field, FiniteFloat

from robot_runtime.clock import Clock
from server.driving.schemas import DriveCounts
from server.platform.schema_base import Schema

LATE_SECONDS = 0.3
"""The greatest age of a command, and how far it may lie ahead, on the robot's steady clock."""

Number = Annotated[int, Field(ge=0, le=2**53)]


class DriveCommand(Schema):
    """The position of the sticks: x, y, z, roll, pitch, yaw, each -1 to 1, at `taken` (s, steady clock)."""

    model_config = ConfigDict(strict=True)
    lease: Number
    sequence: Number
    taken: FiniteFloat
    axes: Annotated[list[Annotated[FiniteFloat, Field(ge=-1, le=1)]], Field(min_length=6, max_length=6)]


class DriveFilter:
    """Filter that passes commands to `publish` at once, or drops and counts them."""

    def __init__(self, clock: Clock, publish: Callable[[bytes], None]) -> None:
        self.counts = DriveCounts()
        self._clock = clock
        self._publish = publish
        self._lease = self._sequence = -1

    def take(self, command: DriveCommand, epoch: int | None) -> None:
        """Pass or drop a command. `epoch` is that of the sender's control; None if it has none."""
        counts = self.counts
        age = self._clock.now() - command.taken
        if epoch is None:
            counts.not_in_control += 1
        elif command.lease != epoch:
            counts.other_lease += 1
        elif command.lease == self._lease and command.sequence <= self._sequence:
            counts.not_newer += 1
        elif age > LATE_SECONDS:
            counts.too_old += 1
        elif age < -LATE_SECONDS:
            counts.from_the_future += 1
        else:
            self._lease, self._sequence = command.lease, command.sequence
            counts.passed += 1
            self._publish(json.dumps(command.model_dump()).encode())
