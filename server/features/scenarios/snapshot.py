"""A file with the state before a live scenario, on the disk until that state is restored."""

import json
from dataclasses import asdict
from pathlib import Path

from robot_runtime.durable_files import write_whole
from server.features.scenarios.live_setup import SavedState


class ScenarioSnapshot:
    """A file that is there while a scenario has the robot and its water in its hands."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def save(self, before: SavedState) -> None:
        """Write it down, so that not even a power cut loses it. Raises OSError."""
        write_whole(self._path, json.dumps(asdict(before)).encode())

    def read(self) -> SavedState | None:
        """The state saved by a server that was killed; None where there is none or it is not readable."""
        try:
            return SavedState(**json.loads(self._path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None

    def forget(self) -> None:
        """Everything is as it was."""
        self._path.unlink(missing_ok=True)
