"""Blocks as the server handles them: looked at once at the edge, then passed on as the bytes they are."""

from dataclasses import dataclass

from robot_runtime.packets.layout import LayoutError
from robot_runtime.topics import BY_ID, HEADER, TOPICS, Kind, Topic

ROW_BYTES = {topic.id: topic.row_bytes for topic in TOPICS if topic.kind is Kind.ROWS}


@dataclass(frozen=True, slots=True)
class Arrival:
    """One block: `count` samples of a topic, numbered from `first` on; `data` is the whole block."""

    topic: Topic
    count: int
    first: int
    data: bytes

    @property
    def payload(self) -> bytes:
        """The block without its header."""
        return self.data[HEADER.size :]


def read_arrivals(data: bytes) -> list[Arrival]:
    """The blocks that `data` is. Raises LayoutError where it is not blocks from end to end."""
    arrivals: list[Arrival] = []
    at = 0
    while at < len(data):
        if len(data) - at < HEADER.size:
            raise LayoutError(f"{len(data) - at} bytes are no block")
        topic_id, kind, count, first, size = HEADER.unpack_from(data, at)
        topic = BY_ID.get(topic_id)
        if topic is None or topic.kind != kind:
            raise LayoutError(f"a block of topic {topic_id}, kind {kind}")
        end = at + HEADER.size + size
        if end > len(data):
            raise LayoutError(f"{topic.name}: {len(data) - at - HEADER.size} bytes instead of {size}")
        if count == 0 or (topic.kind is Kind.ROWS and size != count * ROW_BYTES[topic_id]):
            raise LayoutError(f"{topic.name}: {size} bytes are not {count} samples")
        arrivals.append(Arrival(topic, count, first, data[at:end]))
        at = end
    return arrivals
