"""The import of archives, as one feature offers it to others."""

from abc import ABC, abstractmethod
from pathlib import Path


class ArchiveIntake(ABC):
    """Import of the archives of sessions."""

    @abstractmethod
    async def take_merged(self, path: Path) -> int:
        """Import an archive as a lab keeps it: its chunks merged, its origin its own.

        Return the session's number. Raise InvalidError for a file that is no whole archive of a version that
        can be read, RefusedError where the session is here already, FileWriteError, StoreError.
        """

    @abstractmethod
    async def drop_unfinished(self) -> None:
        """Have the rest of imports that broke off removed. Raise StoreError."""
