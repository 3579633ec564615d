"""The server's bus: blocks of the robot and of the server itself, for the listeners of their topics."""

import logging
from collections import defaultdict
from collections.abc import Callable, Sequence

from robot_runtime.contract.topics import TOPICS, AnyTopic
from robot_runtime.transport.blocks import Block

log = logging.getLogger(__name__)

BlockListener = Callable[[Block], None]
RoundListener = Callable[[Sequence[Block]], None]


class Feed:
    """Delivery of each block to the listeners of its topic, and of each round of blocks that came together.

    A listener must be quick. The first failure of each is logged and reported to `on_failure`; the others
    are still called.
    """

    def __init__(self) -> None:
        self.on_failure: Callable[[str, Exception], None] = lambda _, __: None
        """Gets the name of a listener and its error."""
        self._listeners: dict[int, list[BlockListener]] = defaultdict(list)
        self._rounds: list[RoundListener] = []
        self._failed: set[tuple[str, Callable[..., None]]] = set()

    def listen(self, listener: BlockListener, *topics: AnyTopic) -> None:
        """Call `listener` with every block of these topics, or of all where none is named."""
        for topic in topics or TOPICS:
            self._listeners[topic.id].append(listener)

    def listen_to_rounds(self, listener: RoundListener) -> None:
        """Call `listener` with the blocks that came together, after their own listeners."""
        self._rounds.append(listener)

    def deliver(self, blocks: Sequence[Block]) -> None:
        """Call the listeners with these blocks, in order."""
        for block in blocks:
            for listener in self._listeners[block.topic.id]:
                try:
                    listener(block)
                except Exception as problem:
                    self._report("block", listener, problem)
        for heard in self._rounds:
            try:
                heard(blocks)
            except Exception as problem:
                self._report("round", heard, problem)

    def _report(self, kind: str, listener: Callable[..., None], problem: Exception) -> None:
        # Once: a report is delivered, too, and may make the same listener fail again.
        if (kind, listener) in self._failed:
            return
        self._failed.add((kind, listener))
        name = getattr(listener, "__qualname__", repr(listener))
        log.error("%s cannot take what was delivered", name, exc_info=problem)
        self.on_failure(name, problem)
