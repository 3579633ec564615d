"""The plug of the recorder: the services that record, which a lab has as well and never uses."""

import json
from typing import ClassVar

from robot_runtime.clock import Clock
from server.feature import Plug
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.provenance import ProvenanceWatch
from server.recording.recorder import Recorder
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.hub import Hub


def make_provenance(settings: Settings, bridge: Bridge, notices: Notices) -> ProvenanceWatch:
    """Return the watch of the robot's provenance."""
    return ProvenanceWatch(settings, lambda: bridge.query("provenance"), notices)


def make_recorder(
    store: Store, clock: Clock, notices: Notices, hub: Hub, provenance: ProvenanceWatch
) -> Recorder:
    """Return the recorder, which sends every change of the recording session to the pages."""
    recorder = Recorder(store, clock, notices, lambda: announce(recorder, hub), provenance)
    return recorder


def announce(recorder: Recorder, hub: Hub) -> None:
    """Send the recording session to the pages."""
    session = recorder.session
    hub.notify({"op": "session", "recording": session and json.loads(session.model_dump_json())})


class RecorderPlug(Plug):
    """The plug that offers the recorder to features of the robot's and of the library."""

    makers: ClassVar[tuple[Maker, ...]] = (make_provenance, make_recorder)
