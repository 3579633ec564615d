"""How everything was before a live scenario: on the disk until it is put back, perhaps by the next server."""

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
        """What a server that was killed has left; None where nothing is left, or it cannot be read."""
        try:
            return SavedState(**json.loads(self._path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None

    def forget(self) -> None:
        """Everything is as it was."""
        self._path.unlink(missing_ok=True)
