"""The sender of samples, gathered into blocks so that each message to other processes carries many.

Everything queued is sent as one message named `stream`, blocks one after the other, because waking the
receiver costs more than bytes. Each topic with subscribers of its own is sent under its name as well.
"""

import threading
from collections import defaultdict
from collections.abc import Callable

from robot_runtime.contract.documents import Document
from robot_runtime.contract.topics import FILM, TOPICS, AnyTopic
from robot_runtime.transport.blocks import Block, pack_documents, row
from robot_runtime.transport.replay_cache import ReplayCache

STREAM = "stream"
SIMULATOR_STREAM = "simulator/stream"
"""The simulator's `STREAM`, a key of its own: a simulator elsewhere may not send under the robot's."""


class Outbox:
    """Queue of rows and documents until `flush` sends them; `watched`: a topic of this name has a subscriber.

    Sent messages go to `cache` too, for a server that restarts. Every method may be called from any thread.
    """

    def __init__(
        self,
        send: Callable[[str, bytes], None],
        watched: Callable[[str], bool],
        cache: ReplayCache | None = None,
        stream: str = STREAM,
    ) -> None:
        self._stream = stream
        self._send = send
        self._watched = watched
        self._cache = cache
        self._lock = threading.Lock()
        self._sending = threading.Lock()
        self._rows: defaultdict[AnyTopic, list[bytes]] = defaultdict(list)
        self._documents: defaultdict[AnyTopic, list[Document]] = defaultdict(list)
        self._film: list[bytes] = []
        self._next = dict.fromkeys((topic.name for topic in TOPICS), 0)

    def add_row(self, topic: AnyTopic, time: float, record: bytes) -> None:
        """Queue one row."""
        with self._lock:
            self._rows[topic].append(row(time, record))

    def add_picture(self, topic: AnyTopic, time: float, jpeg: bytes) -> None:
        """Queue a picture in place of the topic's queued one."""
        with self._lock:
            self._rows[topic] = [row(time, jpeg)]

    def add_film(self, time: float, picture: bytes) -> None:
        """Queue a picture of the film, none of which may be left out: later ones build on it."""
        with self._lock:
            self._film.append(row(time, picture))

    def add_document(self, topic: AnyTopic, document: Document) -> None:
        """Queue one document."""
        with self._lock:
            self._documents[topic].append(document)

    def flush(self) -> None:
        """Send everything queued."""
        with self._sending:
            with self._lock:
                rows, self._rows = self._rows, defaultdict(list)
                documents, self._documents = self._documents, defaultdict(list)
                film, self._film = self._film, []
            blocks = {
                topic: self._block(topic, len(waiting), b"".join(waiting)) for topic, waiting in rows.items()
            }
            for topic, batch in documents.items():
                blocks[topic] = self._block(topic, len(batch), pack_documents(batch))
            pictures = [self._block(FILM, 1, picture) for picture in film]
            if blocks or pictures:
                message = b"".join([*blocks.values(), *pictures])
                if self._cache is not None:
                    self._cache.add(message, self._next)
                self._send(self._stream, message)
            for topic, block in blocks.items():
                if self._watched(topic.name):
                    self._send(topic.name, block)

    def send_picture(self, topic: AnyTopic, time: float, jpeg: bytes) -> None:
        """Send a picture at once."""
        with self._sending:
            self._send(topic.name, self._block(topic, 1, row(time, jpeg)))

    def _block(self, topic: AnyTopic, count: int, payload: bytes) -> bytes:
        first = self._next[topic.name]
        self._next[topic.name] = first + count
        return Block.of(topic, count, first, payload).data
