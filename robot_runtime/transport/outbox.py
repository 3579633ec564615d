"""Gathers samples into blocks and sends them to the other processes, so that each message carries many.

Everything queued is sent as one message named `stream`, blocks one after the other, because waking the
receiver costs more than bytes. Each topic with subscribers of its own is sent under its name as well.
"""

import threading
from collections import defaultdict
from collections.abc import Callable

from robot_runtime.contract.documents import Document
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents, row
from robot_runtime.transport.replay_cache import ReplayCache

STREAM = "stream"
SIMULATOR_STREAM = "simulator/stream"
"""The simulator's `STREAM`, a key of its own: a simulator elsewhere may not send under the robot's."""


class Outbox:
    """Queues rows and documents until `flush` sends them; `watched` is true for topics with a subscriber.

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
        self._rows: defaultdict[str, list[bytes]] = defaultdict(list)
        self._documents: defaultdict[str, list[Document]] = defaultdict(list)
        self._next = dict.fromkeys(BY_NAME, 0)

    def add_row(self, topic: str, time: float, record: bytes) -> None:
        """Queue one row."""
        with self._lock:
            self._rows[topic].append(row(time, record))

    def add_picture(self, topic: str, time: float, jpeg: bytes) -> None:
        """Queues a picture in place of the topic's queued one."""
        with self._lock:
            self._rows[topic] = [row(time, jpeg)]

    def add_document(self, topic: str, document: Document) -> None:
        """Queue one document."""
        with self._lock:
            self._documents[topic].append(document)

    def flush(self) -> None:
        """Sends everything queued."""
        with self._sending:
            with self._lock:
                rows, self._rows = self._rows, defaultdict(list)
                documents, self._documents = self._documents, defaultdict(list)
            blocks = {
                name: self._block(name, len(waiting), b"".join(waiting)) for name, waiting in rows.items()
            }
            for name, batch in documents.items():
                blocks[name] = self._block(name, len(batch), pack_documents(batch))
            if blocks:
                message = b"".join(blocks.values())
                if self._cache is not None:
                    self._cache.add(message, self._next)
                self._send(self._stream, message)
            for name, block in blocks.items():
                if self._watched(name):
                    self._send(name, block)

    def send_picture(self, topic: str, time: float, jpeg: bytes) -> None:
        """Send a picture at once."""
        with self._sending:
            self._send(topic, self._block(topic, 1, row(time, jpeg)))

    def _block(self, name: str, count: int, payload: bytes) -> bytes:
        first = self._next[name]
        self._next[name] = first + count
        return Block.of(BY_NAME[name], count, first, payload).data
