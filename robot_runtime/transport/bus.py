"""The bus between the parts of the runtime: plain function calls, topic by topic.

A listener is any callable; it runs on the publisher's thread and must be quick.
"""

from collections import defaultdict
from collections.abc import Callable
from typing import Any, TypeVar

from robot_runtime.contract.documents import Document
from robot_runtime.contract.topics import AnyTopic, Kind, Topic

D = TypeVar("D", bound=Document)
RowListener = Callable[[float, bytes], None]
"""Gets the time of a row (s) and its record's bytes."""


class Bus:
    """Rows travel as time (s) and record bytes, documents as themselves."""

    def __init__(self) -> None:
        self._rows: dict[int, list[RowListener]] = defaultdict(list)
        self._documents: dict[int, list[Callable[[Any], None]]] = defaultdict(list)

    def on_row(self, topic: AnyTopic, listener: RowListener) -> None:
        """Call `listener` with every row of the topic. Raise ValueError on a topic that has no rows."""
        if topic.kind is not Kind.ROWS:
            raise ValueError(f"topic {topic.name} has no rows")
        self._rows[topic.id].append(listener)

    def on_document(self, topic: Topic[D], listener: Callable[[D], None]) -> None:
        """Call `listener` with every document of the topic. Raise ValueError where it has none."""
        if topic.kind is not Kind.DOCUMENTS:
            raise ValueError(f"topic {topic.name} has no documents")
        self._documents[topic.id].append(listener)

    def publish_row(self, topic: AnyTopic, time: float, record: bytes) -> None:
        """Call the listeners of a row's topic."""
        for listener in self._rows[topic.id]:
            listener(time, record)

    def publish_document(self, topic: Topic[D], document: D) -> None:
        """Call the listeners of a document's topic."""
        for listener in self._documents[topic.id]:
            listener(document)
