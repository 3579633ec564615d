"""People and programs that ask for control, with a simulated clock."""

import json
from typing import Any

from robot_runtime.clock import SimulatedClock
from server.driving.arbiter import ControlArbiter
from server.driving.drive_filter import DriveCommand
from server.http.sign_in.identity import Identity

ANNA = Identity(1, "Anna", "operator", "browser")
BEN = Identity(2, "Ben", "operator", "browser")
VERA = Identity(4, "Vera", "viewer", "browser")


class ArbiterRig:
    """An arbiter with its notifications and the driving commands that it passed."""

    def __init__(self) -> None:
        self.clock = SimulatedClock(1000.0)
        self.messages: list[dict[str, Any]] = []
        self.driven: list[dict[str, Any]] = []
        self.noted: list[str] = []
        self.lost: list[tuple[str, str]] = []
        self.arbiter = ControlArbiter(
            self.clock, self.messages.append, self._drive, self.noted.append, self._lose
        )

    def _drive(self, data: bytes) -> None:
        self.driven.append(json.loads(data))

    def _lose(self, identity: Identity, why: str) -> None:
        self.lost.append((identity.name, why))

    def drive(self, **changes: Any) -> DriveCommand:
        """Return a valid driving command, but for the changes."""
        whole = {
            "lease": self.arbiter.lease.epoch,
            "sequence": 1,
            "taken": self.clock.now(),
            "axes": [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        }
        return DriveCommand.model_validate(whole | changes)
