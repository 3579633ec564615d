"""Driving: what may pass from the driver's page to the runtime, and what is dropped and counted.

Nothing is kept for later: a command that comes too late would steer a robot that has swum on.
"""

import json
from collections.abc import Callable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from robot_runtime.clock import Clock
from server.features.lease.schemas import Driven

LATE_SECONDS = 0.3
"""By which a command may be older than now, or seem younger, on the robot's steady clock."""

Number = Annotated[int, Field(ge=0, le=2**53)]


class Drive(BaseModel):
    """Where the sticks are: x, y, z, roll, pitch, yaw, each -1 to 1; `taken` in s on the steady clock."""

    model_config = ConfigDict(strict=True)
    lease: Number
    sequence: Number
    taken: FiniteFloat
    axes: Annotated[list[Annotated[FiniteFloat, Field(ge=-1, le=1)]], Field(min_length=6, max_length=6)]


class Driving:
    """Passes commands on to `publish`, at once or never."""

    def __init__(self, clock: Clock, publish: Callable[[bytes], None]) -> None:
        self.counts = Driven()
        self._clock = clock
        self._publish = publish
        self._lease = self._sequence = -1

    def take(self, command: Drive, epoch: int | None) -> None:
        """`epoch` is that of the control which the sender has; None where it has none."""
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
