"""The topics: every stream of samples between the processes, each declared once with its rules.

From a row come the stream's sender, its recording, the history for pages that connect, replay, exports, the
page's types and docs/reference/topics.md. `robot_runtime.transport.blocks` packs the samples.
"""

from dataclasses import dataclass
from enum import IntEnum
from struct import Struct
from typing import Literal

from robot_runtime.contract import documents, packets
from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.packets.layout import Record

TIME = Struct("<d")
"""The time at the start of a row: s, steady clock."""

Sender = Literal["runtime", "simulator", "scene", "server"]


class Kind(IntEnum):
    """The kind of payload that a block holds."""

    ROWS = 0
    DOCUMENTS = 1
    PICTURE = 2


@dataclass(frozen=True, slots=True)
class Topic:
    """One stream of samples, and its rules.

    `record` is the class of its rows or documents. `sender` names the process that sends it. `newest_only`:
    each document states everything, so a page that connects is sent the newest only. `lines`: each document
    is a line for a person, which pages list and exports put into the log. `charted`: s before the shown time
    that a replaying page needs for its charts.
    """

    id: int
    name: str
    kind: Kind
    record: type[Record] | type[documents.Document] | None
    meaning: str
    sender: Sender = "runtime"
    recorded: bool = True
    newest_only: bool = False
    lines: bool = False
    charted: float = 0.0

    @property
    def row_bytes(self) -> int:
        """Bytes of one row with its time. Raises TypeError where the topic has no rows."""
        if self.record is None or not issubclass(self.record, Record):
            raise TypeError(f"topic {self.name} has no rows")
        return TIME.size + self.record.layout.size


CHART_SECONDS = 300.0
"""s of depth and control that a seek of a replay brings; more would make it slow."""
STRIP_SECONDS = 60.0
"""s that the small charts of the page show."""
_ROWS, _DOCUMENTS, _PICTURE = Kind.ROWS, Kind.DOCUMENTS, Kind.PICTURE
TOPICS: tuple[Topic, ...] = (
    Topic(1, "imu", _ROWS, packets.Imu, "attitude, turn rate and specific force"),
    Topic(2, "depth", _ROWS, packets.Depth, "depth and pressure", charted=CHART_SECONDS),
    Topic(3, "beacon", _ROWS, packets.Beacon, "light-beacon detectors", charted=STRIP_SECONDS),
    Topic(4, "motor", _ROWS, packets.Motor, "fins: set points, angles, drives"),
    Topic(5, "status", _ROWS, packets.Status, "the board's state and health", charted=STRIP_SECONDS),
    Topic(
        6,
        "navigation",
        _ROWS,
        packets.Navigation,
        "navigation commands sent to the board",
        charted=STRIP_SECONDS,
    ),
    Topic(7, "control", _ROWS, documents.Control, "ticks of the control node", charted=CHART_SECONDS),
    Topic(8, "link", _ROWS, LinkStatistics, "the serial link", charted=STRIP_SECONDS),
    Topic(9, "truth", _ROWS, documents.Truth, "the simulated body", sender="simulator"),
    Topic(
        10,
        "turning",
        _ROWS,
        documents.Turning,
        "the same ticks, for heading, pitch and roll",
        charted=STRIP_SECONDS,
    ),
    Topic(16, "state", _DOCUMENTS, documents.State, "the robot as a whole", newest_only=True),
    Topic(
        17,
        "detection",
        _DOCUMENTS,
        documents.Detection,
        "detections of the vision node",
        newest_only=True,
        charted=10.0,
    ),
    Topic(18, "debug", _DOCUMENTS, documents.DebugLine, "lines of text from the firmware", lines=True),
    Topic(19, "event", _DOCUMENTS, documents.Event, "events of the runtime", lines=True),
    Topic(
        20,
        "notice",
        _DOCUMENTS,
        documents.Event,
        "events of the server",
        sender="server",
        lines=True,
    ),
    Topic(21, "parameters", _DOCUMENTS, documents.Parameters, "all parameters", newest_only=True),
    Topic(22, "experiment", _DOCUMENTS, documents.Experiment, "progress of an experiment on a loop"),
    Topic(23, "vision", _DOCUMENTS, documents.VisionInForce, "vision settings in force", newest_only=True),
    Topic(
        24,
        "calibration",
        _DOCUMENTS,
        documents.CalibrationKept,
        "the calibration that the board keeps",
        newest_only=True,
    ),
    Topic(25, "mission", _DOCUMENTS, documents.Mission, "a mission as it stands", newest_only=True),
    Topic(
        26,
        "craft",
        _DOCUMENTS,
        documents.SwimmingCraft,
        "the craft that the simulator swims",
        sender="simulator",
        newest_only=True,
    ),
    Topic(32, "picture", _PICTURE, None, "the picture that the vision node used", recorded=False),
    Topic(33, "observer", _PICTURE, None, "the simulated scene from outside", "scene", recorded=False),
    Topic(34, "thumbnail", _PICTURE, None, "a small picture of the camera's, for recordings"),
    Topic(
        35,
        "mask",
        _PICTURE,
        None,
        "mask of the target colour, and the patches that count",
        recorded=False,
    ),
    Topic(36, "balanced", _PICTURE, None, "the camera's picture after the white balance", recorded=False),
)
BY_NAME = {topic.name: topic for topic in TOPICS}
BY_ID = {topic.id: topic for topic in TOPICS}
ROW_BYTES = {topic.id: topic.row_bytes for topic in TOPICS if topic.kind is Kind.ROWS}
"""Size of a row with its time, by the topic's number."""
RECORDED = tuple(topic for topic in TOPICS if topic.recorded)
SENT_BY: dict[str, tuple[Topic, ...]] = {
    sender: tuple(topic for topic in RECORDED if topic.sender == sender)
    for sender in ("runtime", "simulator")
}
"""The recorded topics by their senders, which number the samples and keep them for a restarted server."""
LINES = frozenset(topic.name for topic in TOPICS if topic.lines)
TELEMETRY = {
    topic.record.type: topic.name
    for topic in TOPICS
    if topic.record is not None and issubclass(topic.record, packets.Packet) and topic.record.telemetry
}
"""The topics that carry what the board sends by itself, by the packets' types."""
