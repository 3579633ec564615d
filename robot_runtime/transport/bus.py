"""The bus between the parts of the runtime: plain function calls, topic by topic.

A listener is any callable; it runs on the publisher's thread and must be quick.
"""

from collections import defaultdict
from collections.abc import Callable

from robot_runtime.contract.documents import Document
from robot_runtime.contract.topics import BY_NAME, Kind

RowListener = Callable[[str, float, bytes], None]
DocumentListener = Callable[[str, Document], None]


class Bus:
    """Rows travel as their topic's name, time (s) and record bytes; documents as themselves."""

    def __init__(self) -> None:
        self._rows: dict[str, list[RowListener]] = defaultdict(list)
        self._documents: dict[str, list[DocumentListener]] = defaultdict(list)

    def on_row(self, topic: str, listener: RowListener) -> None:
        """Call `listener` with every row of the topic. Raises KeyError on a topic that has no rows."""
        if BY_NAME[topic].kind is not Kind.ROWS:
            raise KeyError(f"topic {topic} has no rows")
        self._rows[topic].append(listener)

    def on_document(self, topic: str, listener: DocumentListener) -> None:
        """Call `listener` with every document of the topic. Raises KeyError on a topic without documents."""
        if BY_NAME[topic].kind is not Kind.DOCUMENTS:
            raise KeyError(f"topic {topic} has no documents")
        self._documents[topic].append(listener)

    def publish_row(self, topic: str, time: float, record: bytes) -> None:
        """Calls the listeners of a row's topic."""
        for listener in self._rows[topic]:
            listener(topic, time, record)

    def publish_document(self, topic: str, document: Document) -> None:
        """Calls the listeners of a document's topic."""
        for listener in self._documents[topic]:
            listener(topic, document)
