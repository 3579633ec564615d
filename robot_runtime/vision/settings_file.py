"""Storage of the vision settings, which survive a restart."""

import json
from pathlib import Path

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import read_value
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.text_input import TextError, read_json
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.durable_files import write_whole


class VisionSettingsFile:
    """The JSON file of the vision settings, written atomically."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> VisionSettings | None:
        """Read the stored settings; None if there are none. Raise ConfigError if they cannot be used."""
        try:
            table = read_json(self._path.read_bytes())
            settings: VisionSettings = read_value(VisionSettings, table, DocumentEntry(self._path.name))
        except FileNotFoundError:
            return None
        except ConfigError:
            raise
        except OSError as problem:
            raise ConfigError(f"{self._path} cannot be read: {problem}") from problem
        except TextError as problem:
            raise ConfigError(f"{self._path} cannot be read: it {problem}") from problem
        return settings

    def write(self, settings: VisionSettings) -> None:
        """Store the settings. Raise OSError; then the older ones remain."""
        write_whole(self._path, json.dumps(settings.table(), indent=1).encode())

    def forget(self) -> None:
        """Remove the stored settings. Raise OSError."""
        self._path.unlink(missing_ok=True)
