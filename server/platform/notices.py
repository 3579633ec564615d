"""The server's own messages: a topic like any other, shown on the page and recorded."""

from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.contract import documents
from robot_runtime.contract.topics import NOTICE
from robot_runtime.transport.blocks import Block, pack_documents


class Notices:
    """Writer of notices, each handed over as a block."""

    def __init__(self, clock: Clock, deliver: Callable[[Block], None]) -> None:
        self._clock = clock
        self._deliver = deliver
        self._sent = 0

    def continue_from(self, number: int) -> None:
        """Continue numbering after the notices of an earlier server."""
        self._sent = number

    def notify(self, kind: str, severity: documents.Severity, text: str) -> None:
        """Write a notice: a text for a person, and its `kind` in one word for programs."""
        self.add_event(documents.Event(time=self._clock.now(), kind=kind, severity=severity, text=text))

    def add_event(self, event: documents.Event) -> None:
        """Write a notice from an event."""
        block = Block.of(NOTICE, 1, self._sent, pack_documents([event]))
        self._sent += 1
        self._deliver(block)
