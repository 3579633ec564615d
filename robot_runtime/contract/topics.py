"""The topics: every stream of samples between the processes, each declared once with its rules.

From a row come the stream's sender, its recording, the history for pages that connect, replay, exports, the
page's types and docs/reference/topics.md. `robot_runtime.transport.blocks` packs the samples.
"""

from dataclasses import dataclass, field
from enum import IntEnum
from struct import Struct
from typing import Any, Generic, Literal, TypeVar

from robot_runtime.contract import documents, packets
from robot_runtime.contract.declarations import Declarations
from robot_runtime.contract.film_picture import FilmPicture
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
    FILM = 3


S = TypeVar("S")
BY_ID: Declarations[int, "AnyTopic"] = Declarations("the number of a topic")
BY_NAME: Declarations[str, "AnyTopic"] = Declarations("the name of a topic")


@dataclass(frozen=True, slots=True, eq=False)
class Topic(Generic[S]):
    """One stream of samples of type S, and its rules; a topic that is made is declared.

    `record` is S, the class of its rows or documents, which says the kind; pictures are bytes, JPEG; a
    film is only recorded.
    `sender` names the process that sends it. `newest_only`: each document states everything, so a page that
    connects is sent the newest only. `standing`: sent at changes and every ten seconds, and in force until
    the next one, so that a recording begins with the newest. `lines`: each document is a line for a person,
    which pages list and exports put into the log. `charted`: s before the shown time that a replaying page
    needs for its charts. `stands_for`: it is only recorded, and replayed as that topic.
    """

    id: int
    name: str
    record: type[S]
    meaning: str
    sender: Sender = "runtime"
    recorded: bool = True
    newest_only: bool = False
    standing: bool = False
    lines: bool = False
    charted: float = 0.0
    stands_for: "Topic[S] | None" = None
    kind: Kind = field(init=False)

    def __post_init__(self) -> None:
        """Declare it. Raise DeclaredTwiceError where its number or name is another's."""
        other = Kind.ROWS if issubclass(self.record, Record) else Kind.DOCUMENTS
        pictures: dict[type, Kind] = {bytes: Kind.PICTURE, FilmPicture: Kind.FILM}
        object.__setattr__(self, "kind", pictures.get(self.record, other))
        BY_NAME.add(self.name, self, depth=2)
        BY_ID.add(self.id, self, depth=2)

    @property
    def only_recorded(self) -> bool:
        """True where pages and programs are not sent it."""
        return self.stands_for is not None or self.kind is Kind.FILM

    @property
    def row_bytes(self) -> int:
        """Bytes of one row with its time. Raises TypeError where the topic has no rows."""
        if not issubclass(self.record, Record):
            raise TypeError(f"topic {self.name} has no rows")
        return TIME.size + self.record.layout.size


AnyTopic = Topic[Any]
CHART_SECONDS = 300.0
"""s of depth and control that a seek of a replay brings; more would make it slow."""
STRIP_SECONDS = 60.0
"""s that the small charts of the page show."""

IMU = Topic(1, "imu", packets.Imu, "attitude, turn rate and specific force")
DEPTH = Topic(2, "depth", packets.Depth, "depth and pressure", charted=CHART_SECONDS)
BEACON = Topic(3, "beacon", packets.Beacon, "light-beacon detectors", charted=STRIP_SECONDS)
MOTOR = Topic(4, "motor", packets.Motor, "fins: set points, angles, drives")
STATUS = Topic(5, "status", packets.Status, "the board's state and health", charted=STRIP_SECONDS)
NAVIGATION = Topic(
    6, "navigation", packets.Navigation, "navigation commands sent to the board", charted=STRIP_SECONDS
)
CONTROL = Topic(7, "control", documents.Control, "ticks of the control node", charted=CHART_SECONDS)
LINK = Topic(8, "link", LinkStatistics, "the serial link", charted=STRIP_SECONDS)
TRUTH = Topic(9, "truth", documents.Truth, "the simulated body", sender="simulator")
TURNING = Topic(
    10, "turning", documents.Turning, "the same ticks, for heading, pitch and roll", charted=STRIP_SECONDS
)
TRACK = Topic(
    11, "track", documents.Track, "the way by dead reckoning, with its uncertainty", charted=CHART_SECONDS
)
STATE = Topic(16, "state", documents.State, "the robot as a whole", newest_only=True)
DETECTION = Topic(
    17, "detection", documents.Detection, "detections of the vision node", newest_only=True, charted=10.0
)
DEBUG = Topic(18, "debug", documents.DebugLine, "events and lines of the board, in words", lines=True)
EVENT = Topic(19, "event", documents.Event, "events of the runtime", lines=True)
NOTICE = Topic(20, "notice", documents.Event, "events of the server", sender="server", lines=True)
PARAMETERS = Topic(21, "parameters", documents.Parameters, "all parameters", newest_only=True, standing=True)
EXPERIMENT = Topic(22, "experiment", documents.Experiment, "progress of an experiment on a loop")
VISION = Topic(23, "vision", documents.VisionInForce, "vision settings in force", newest_only=True)
CALIBRATION = Topic(
    24, "calibration", documents.CalibrationKept, "the calibration that the board keeps", newest_only=True
)
MISSION = Topic(25, "mission", documents.Mission, "a mission as it stands", newest_only=True)
CRAFT = Topic(
    26,
    "craft",
    documents.SwimmingCraft,
    "the craft that the simulator swims",
    sender="simulator",
    newest_only=True,
    standing=True,
)
PICTURE = Topic(32, "picture", bytes, "the picture that the vision node used", recorded=False)
OBSERVER = Topic(33, "observer", bytes, "the simulated scene from outside", sender="scene", recorded=False)
THUMBNAIL = Topic(
    34, "thumbnail", bytes, "a small picture of the camera's, for recordings", stands_for=PICTURE
)
MASK = Topic(35, "mask", bytes, "mask of the target colour, and the patches that count", recorded=False)
BALANCED = Topic(36, "balanced", bytes, "the camera's picture after the white balance", recorded=False)
CAMERA = Topic(37, "camera", bytes, "the camera's stream, for driving by sight", recorded=False)
SNAPSHOT = Topic(38, "snapshot", bytes, "a snapshot: the camera's picture at full size", stands_for=PICTURE)
FILM = Topic(39, "film", FilmPicture, "the film of the camera, picture by picture")

TOPICS: tuple[AnyTopic, ...] = tuple(BY_ID.values())
ROW_BYTES = {stream.id: stream.row_bytes for stream in TOPICS if stream.kind is Kind.ROWS}
"""Size of a row with its time, by the topic's number."""
RECORDED = tuple(stream for stream in TOPICS if stream.recorded)
SENT_BY: dict[str, tuple[AnyTopic, ...]] = {
    sender: tuple(stream for stream in RECORDED if stream.sender == sender)
    for sender in ("runtime", "simulator")
}
"""The recorded topics by their senders, which number the samples and keep them for a restarted server."""
LINES = frozenset(stream.name for stream in TOPICS if stream.lines)
WATCHABLE = {
    stream.name: stream for stream in TOPICS if stream.kind is Kind.PICTURE and stream.stands_for is None
}
"""The pictures by their names: sent only while somebody watches them."""
TELEMETRY = {
    stream.record.type: stream
    for stream in TOPICS
    if issubclass(stream.record, packets.Packet) and stream.record.telemetry
}
"""The topics that carry what the board sends by itself, by the packets' types."""
