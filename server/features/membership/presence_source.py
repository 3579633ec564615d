"""The robot's presence, from what the server knows of it."""

import shutil
import socket
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

from robot_runtime.contract.topics import DEPTH, STATUS
from robot_runtime.control.alarms import Alarms
from server import VERSION
from server.health.monitor import HealthMonitor
from server.interchange.presence import ALARMS_MAX, Presence, PresentAlarm, PresentMission
from server.platform.certificate import read_fingerprint
from server.platform.settings import Settings, is_loopback
from server.recording.recorder import Recorder

RECENT_SECONDS = 2.0
GOING_ON = ("running", "paused")
EVERYWHERE = ("0.0.0.0", "::")
"""Hosts of a server that listens at all addresses of its computer, also at those that it gets later."""


class PresenceSource:
    """The source of presences."""

    def __init__(
        self, settings: Settings, monitor: HealthMonitor, recorder: Recorder, alarms: Alarms
    ) -> None:
        self._settings = settings
        self._monitor = monitor
        self._recorder = recorder
        self._alarms = alarms
        self._fingerprint: str | None = None

    @property
    def fingerprint(self) -> str:
        """The fingerprint of the robot's certificate; empty without TLS. Raise OSError."""
        if self._fingerprint is None:
            tls = self._settings.server.tls
            self._fingerprint = read_fingerprint(self._settings.data) if tls else ""
        return self._fingerprint

    def address_for(self, lab: str) -> str:
        """Return the address of the robot's page for a lab at this address; empty where it has none there.

        Blocks while the lab's name is looked up.
        """
        host = urlsplit(lab).hostname or ""
        if is_loopback(host):
            return self._settings.base_urls()[0]
        if self._settings.only_here:
            return ""
        everywhere = self._settings.server.host in EVERYWHERE
        return self._settings.base_url(_own_address(host) if everywhere else "")

    def presence(self, address: str, *, left: bool = False) -> Presence:
        """Return the presence, with this address of the robot's page. Raise OSError."""
        state = None if self._monitor.silence() is not None else self._monitor.state()
        state = state or {}
        depth = self._monitor.record(DEPTH, RECENT_SECONDS)
        status = self._monitor.record(STATUS, RECENT_SECONDS)
        disk = shutil.disk_usage(self._settings.data.path)
        session = self._recorder.session
        return Presence(
            mode=state.get("mode"),
            armed=bool(state.get("armed")),
            connected=bool(state.get("connected")),
            depth=depth and round(depth.depth, 3),
            battery=status and round(status.battery, 2),
            battery_left=state.get("battery_left"),
            mission=self._mission(),
            recording=None if session is None else session.name,
            disk_free=disk.free,
            disk_total=disk.total,
            alarms=list(self._list_alarms(state))[:ALARMS_MAX],
            software=VERSION,
            address=address,
            fingerprint=self.fingerprint,
            left=left,
        )

    def _mission(self) -> PresentMission | None:
        mission = self._monitor.mission()
        if mission is None or mission["phase"] not in GOING_ON:
            return None
        return PresentMission(
            title=mission["title"] or mission["name"], phase=mission["phase"], progress=mission["progress"]
        )

    def _list_alarms(self, state: dict[str, Any]) -> Iterator[PresentAlarm]:
        for alarm in state.get("alarms", []):
            if alarm["active"]:
                yield PresentAlarm(severity=alarm["severity"], what=alarm["what"][:500])
        for own in self._alarms.listed():
            if own.active:
                yield PresentAlarm(severity=own.severity, what=own.what[:500])


def _own_address(towards: str) -> str:
    """Return this computer's address in the network that leads to a host; empty where there is none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((towards, 9))  # which sends nothing
        except OSError:
            return ""
        return str(probe.getsockname()[0])
