"""The doctor of a running server: it examines the computer at the start and on request."""

import asyncio
import logging
import time
from contextlib import suppress

from server.features.doctor.checks import examine
from server.features.doctor.findings import Finding
from server.features.doctor.machine import read_machine
from server.health.monitor import HealthMonitor
from server.platform.notices import Notices
from server.platform.settings import Settings

log = logging.getLogger(__name__)

START_SECONDS = 30.0
"""For which a lab's parts may be starting before it is examined."""
LOOK_SECONDS = 0.5


class Examination:
    """The newest findings of this server's computer."""

    def __init__(self, settings: Settings, monitor: HealthMonitor, notices: Notices) -> None:
        self._settings = settings
        self._monitor = monitor
        self._notices = notices
        self._busy = asyncio.Lock()
        self._findings: list[Finding] = []

    async def at_start(self) -> None:
        """Perform the quick checks, and report problems."""
        if self._settings.lab:
            # Its router has only just been started.
            with suppress(TimeoutError):
                async with asyncio.timeout(START_SECONDS):
                    while self._monitor.health().status == "starting":
                        await asyncio.sleep(LOOK_SECONDS)
        for finding in await self._examine(thorough=False):
            # The link has only just been opened: its own alarm comes when it fails.
            if finding.verdict == "wrong" and finding.name != "board":
                log.warning("%s: %s Remedy: %s", finding.title, finding.text, finding.mend)
                self._notices.notify(
                    "doctor", "caution", f"{finding.title}: {finding.text} Remedy: {finding.mend}"
                )

    async def repeat(self) -> list[Finding]:
        """Perform all checks again; one examination at a time."""
        return await self._examine(thorough=True)

    def newest(self) -> list[Finding]:
        """Return the newest findings."""
        return self._findings

    async def _examine(self, *, thorough: bool) -> list[Finding]:
        async with self._busy:
            parts = self._monitor.health().parts
            heard = {str(part.name): (str(part.state), part.text) for part in parts}
            machine = await asyncio.to_thread(
                read_machine, self._settings, time.time(), heard, thorough=thorough
            )
            self._findings = examine(machine)
            return self._findings
