"""Free space on the disk that holds the data folder."""

import shutil

from robot_runtime.errors import RefusedError
from server.platform.settings import DataFolder

DIVE_BYTES = 20_000_000
"""An hour of recording without pictures; with less free space a dive cannot be recorded."""


def check_room(folder: DataFolder) -> None:
    """Raises RefusedError where there is no room to record a dive."""
    free = shutil.disk_usage(folder.path).free
    if free < DIVE_BYTES:
        raise RefusedError(
            f"The disk is full: {free / 1e6:.0f} MB are free, and a dive that is recorded needs "
            f"{DIVE_BYTES / 1e6:.0f} MB. Remove sessions or exports."
        )
