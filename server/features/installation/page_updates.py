"""The releases from pages, handed to the service that updates this computer.

The server itself may change nothing of the installation. `mucat-update.service` runs as root, begins where
the request appears, and checks the signature.
"""

import asyncio
import json
import time
from collections.abc import AsyncIterable
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

from robot_runtime.durable_files import PART, write_whole
from robot_runtime.errors import RefusedError
from server import VERSION
from server.features.installation.places import InstallPlaces
from server.features.installation.report import Report, UpdateReport
from server.features.installation.schemas import UpdateState
from server.features.installation.updater import RELEASE_BYTES
from server.http.uploads import save_upload
from server.platform.disk_space import FileWriteError, explain_write_error, require_free
from server.platform.settings import DataFolder

BEGIN_SECONDS = 30.0
NOT_INSTALLED = "µ-CAT is not installed as a service here: update it as it was installed."
NOT_BEGUN = "The service that updates has not begun. See: sudo systemctl status mucat-update.path"


class PageUpdates:
    """The updates on pages' requests, of the installation at these paths."""

    def __init__(self, data: DataFolder, places: InstallPlaces) -> None:
        self._places = places
        self._installed = places.data == data.path and places.current.is_symlink()
        self._report = UpdateReport(places.report)
        self._receiving = False

    @property
    def _part(self) -> Path:
        release = self._places.requested
        return release.with_name(release.name + PART)

    def recover(self) -> None:
        """Remove a killed server's unfinished upload; a failure does not prevent the start."""
        if self._installed:
            with suppress(OSError):
                self._part.unlink()

    def state(self) -> UpdateState:
        """Return the state for the pages."""
        asked = self._asked()
        report = asked or self._report.read()
        previous = self._places.version_of(self._places.previous)
        return UpdateState(
            installed=self._installed,
            version=VERSION,
            previous="" if previous == VERSION else previous,
            refusal=self._refusal(),
            phase="asked" if asked else report.phase if report else "none",
            text=report.text if report else "",
            time=datetime.fromtimestamp(report.time, UTC) if report else None,
        )

    async def receive(self, pieces: AsyncIterable[bytes], size: int | None) -> None:
        """Store the ZIP file of a release, of `size` bytes if known.

        Raise RefusedError where there can be no update now, InvalidUploadError, FileWriteError.
        """
        self._require()
        require_free(self._places.data, size or 0)
        self._receiving = True
        try:
            await save_upload(pieces, self._part, RELEASE_BYTES)
            self._part.rename(self._places.requested)
        finally:
            self._receiving = False

    async def begin(self, *, recording: bool) -> None:
        """Request the update to the received release. Raise RefusedError, FileWriteError."""
        self._require()
        if recording:
            raise RefusedError("A session is being recorded. Stop it first.")
        if not self._places.requested.exists():
            raise RefusedError("No release was sent. Choose its ZIP file first.")
        request = self._places.request
        try:
            await asyncio.to_thread(write_whole, request, json.dumps({"time": time.time()}).encode())
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, request)) from problem

    def _require(self) -> None:
        if refusal := self._refusal():
            raise RefusedError(refusal)

    def _refusal(self) -> str:
        if not self._installed:
            return NOT_INSTALLED
        if self._receiving:
            return "A release is being sent. Wait for its end."
        report = self._report.read()
        if self._asked() or (report is not None and report.phase == "running"):
            return "An update is running. Wait for its end."
        return ""

    def _asked(self) -> Report | None:
        """Return the request that the service has not taken yet; None without one."""
        try:
            since = self._places.request.stat().st_mtime
        except OSError:
            return None
        late = time.time() - since > BEGIN_SECONDS
        return Report("running", NOT_BEGUN if late else "", since)
