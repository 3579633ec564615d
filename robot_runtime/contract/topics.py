"""The topics: every stream of samples between the processes, each declared once with its rules.

From a row come the stream's sender, its recording, the history for pages that connect, replay, exports, the
page's types and docs/reference/topics.md. `robot_runtime.transport.blocks` packs the samples.
"""

from dataclasses import dataclass
from enum import IntEnum
from struct import Struct
from typing import Any, Generic, Literal, TypeVar

from robot_runtime.contract import documents, packets
from robot_runtime.contract.declarations import Declarations
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


S = TypeVar("S")


@dataclass(frozen=True, slots=True, eq=False)
class Topic(Generic[S]):
    """One stream of samples of type S, and its rules.

    `record` is S, the class of its rows or documents; pictures are bytes, JPEG. `sender` names the process
    that sends it. `newest_only`: each document states everything, so a page that connects is sent the newest
    only. `lines`: each document is a line for a person, which pages list and exports put into the log.
    `charted`: s before the shown time that a replaying page needs for its charts.
    """

    id: int
    name: str
    kind: Kind
    record: type[S]
    meaning: str
    sender: Sender = "runtime"
    recorded: bool = True
    newest_only: bool = False
    lines: bool = False
    charted: float = 0.0

    @property
    def row_bytes(self) -> int:
        """Bytes of one row with its time. Raises TypeError where the topic has no rows."""
        if not issubclass(self.record, Record):
            raise TypeError(f"topic {self.name} has no rows")
        return TIME.size + self.record.layout.size


AnyTopic = Topic[Any]
BY_ID: Declarations[int, AnyTopic] = Declarations("the number of a topic")
BY_NAME: Declarations[str, AnyTopic] = Declarations("the name of a topic")


def topic(
    number: int,
    name: str,
    kind: Kind,
    record: type[S],
    meaning: str,
    *,
    sender: Sender = "runtime",
    recorded: bool = True,
    newest_only: bool = False,
    lines: bool = False,
    charted: float = 0.0,
) -> Topic[S]:
    """Declares a topic. Raises DeclaredTwiceError where its number or name is another's."""
    made = Topic(number, name, kind, record, meaning, sender, recorded, newest_only, lines, charted)
    BY_NAME.add(name, made, depth=1)
    BY_ID.add(number, made, depth=1)
    return made


CHART_SECONDS = 300.0
"""s of depth and control that a seek of a replay brings; more would make it slow."""
STRIP_SECONDS = 60.0
"""s that the small charts of the page show."""
_ROWS, _DOCUMENTS, _PICTURE = Kind.ROWS, Kind.DOCUMENTS, Kind.PICTURE

IMU = topic(1, "imu", _ROWS, packets.Imu, "attitude, turn rate and specific force")
DEPTH = topic(2, "depth", _ROWS, packets.Depth, "depth and pressure", charted=CHART_SECONDS)
BEACON = topic(3, "beacon", _ROWS, packets.Beacon, "light-beacon detectors", charted=STRIP_SECONDS)
MOTOR = topic(4, "motor", _ROWS, packets.Motor, "fins: set points, angles, drives")
STATUS = topic(5, "status", _ROWS, packets.Status, "the board's state and health", charted=STRIP_SECONDS)
NAVIGATION = topic(
    6, "navigation", _ROWS, packets.Navigation, "navigation commands sent to the board", charted=STRIP_SECONDS
)
CONTROL = topic(7, "control", _ROWS, documents.Control, "ticks of the control node", charted=CHART_SECONDS)
LINK = topic(8, "link", _ROWS, LinkStatistics, "the serial link", charted=STRIP_SECONDS)
TRUTH = topic(9, "truth", _ROWS, documents.Truth, "the simulated body", sender="simulator")
TURNING = topic(
    10,
    "turning",
    _ROWS,
    documents.Turning,
    "the same ticks, for heading, pitch and roll",
    charted=STRIP_SECONDS,
)
STATE = topic(16, "state", _DOCUMENTS, documents.State, "the robot as a whole", newest_only=True)
DETECTION = topic(
    17,
    "detection",
    _DOCUMENTS,
    documents.Detection,
    "detections of the vision node",
    newest_only=True,
    charted=10.0,
)
DEBUG = topic(18, "debug", _DOCUMENTS, documents.DebugLine, "lines of text from the firmware", lines=True)
EVENT = topic(19, "event", _DOCUMENTS, documents.Event, "events of the runtime", lines=True)
NOTICE = topic(20, "notice", _DOCUMENTS, documents.Event, "events of the server", sender="server", lines=True)
PARAMETERS = topic(21, "parameters", _DOCUMENTS, documents.Parameters, "all parameters", newest_only=True)
EXPERIMENT = topic(22, "experiment", _DOCUMENTS, documents.Experiment, "progress of an experiment on a loop")
VISION = topic(
    23, "vision", _DOCUMENTS, documents.VisionInForce, "vision settings in force", newest_only=True
)
CALIBRATION = topic(
    24,
    "calibration",
    _DOCUMENTS,
    documents.CalibrationKept,
    "the calibration that the board keeps",
    newest_only=True,
)
MISSION = topic(25, "mission", _DOCUMENTS, documents.Mission, "a mission as it stands", newest_only=True)
CRAFT = topic(
    26,
    "craft",
    _DOCUMENTS,
    documents.SwimmingCraft,
    "the craft that the simulator swims",
    sender="simulator",
    newest_only=True,
)
PICTURE = topic(32, "picture", _PICTURE, bytes, "the picture that the vision node used", recorded=False)
OBSERVER = topic(
    33, "observer", _PICTURE, bytes, "the simulated scene from outside", sender="scene", recorded=False
)
THUMBNAIL = topic(34, "thumbnail", _PICTURE, bytes, "a small picture of the camera's, for recordings")
MASK = topic(
    35, "mask", _PICTURE, bytes, "mask of the target colour, and the patches that count", recorded=False
)
BALANCED = topic(
    36, "balanced", _PICTURE, bytes, "the camera's picture after the white balance", recorded=False
)

TOPICS: tuple[AnyTopic, ...] = tuple(BY_ID.values())
ROW_BYTES = {one.id: one.row_bytes for one in TOPICS if one.kind is Kind.ROWS}
"""Size of a row with its time, by the topic's number."""
RECORDED = tuple(one for one in TOPICS if one.recorded)
SENT_BY: dict[str, tuple[AnyTopic, ...]] = {
    sender: tuple(one for one in RECORDED if one.sender == sender) for sender in ("runtime", "simulator")
}
"""The recorded topics by their senders, which number the samples and keep them for a restarted server."""
LINES = frozenset(one.name for one in TOPICS if one.lines)
TELEMETRY = {
    one.record.type: one for one in TOPICS if issubclass(one.record, packets.Packet) and one.record.telemetry
}
"""The topics that carry what the board sends by itself, by the packets' types."""
