"""The filler of gaps in the stream of a process: it requests missing samples again.

Samples are numbered by topic, and their sender stores those of the last minutes
(`robot_runtime.transport.replay_cache`). While a request is pending, received blocks wait, so that every
sample is passed on once and in order.
"""

import asyncio
from collections.abc import Awaitable, Callable, Mapping, Sequence

from robot_runtime.contract.topics import AnyTopic
from robot_runtime.transport.blocks import NUMBERS, Block
from robot_runtime.transport.replay_cache import BacklogReply

Ask = Callable[[Mapping[str, int]], Awaitable[BacklogReply | None]]
"""Requests the blocks from these numbers on, by the topics' names; returns None without an answer."""


class GapFiller:
    """Gap filler of one process, across its restarts, for the topics that only it sends.

    `deliver` is called with its blocks, in order. Blocks before `begin_delivery` wait.
    """

    def __init__(self, topics: Sequence[AnyTopic], ask: Ask, deliver: Callable[[list[Block]], None]) -> None:
        self.topics = topics
        self._ask = ask
        self._deliver = deliver
        self.run = ""
        """The run of the process, from its newest block; empty before the first."""
        self._over: set[str] = set()
        self._expected: dict[int, int] = {}
        self._last_request: dict[str, int] = {}
        self._waiting: list[tuple[str, list[Block]]] = []
        self._paused = True
        self._asking: asyncio.Task[None] | None = None

    def everything(self) -> dict[str, int]:
        """Return the request for the whole backlog."""
        return {topic.name: 0 for topic in self.topics}

    def begin_delivery(self, backlog: BacklogReply | None) -> None:
        """Pass on the process's backlog, if any, and from now on received blocks."""
        self._paused = False
        self._merge(backlog)

    def take(self, run: str, blocks: list[Block]) -> None:
        """Take blocks of this run of the process; without a run's name no gap is filled."""
        if self._paused:
            self._waiting.append((run, blocks))
        elif not run or run in self._over:
            self._deliver(blocks)
        elif run != self.run:
            self._catch_up(run, blocks, self.everything())
        elif self._follow(blocks) or self._follow(blocks := self._fresh(blocks)):
            if blocks:
                self._deliver(blocks)
        else:
            numbers = {topic.name: self._expected.get(topic.id, 0) for topic in self.topics}
            if numbers == self._last_request:
                # These were requested already, and the process does not have them: they stay missing.
                self._pass_on(blocks)
            else:
                self._last_request = numbers
                self._catch_up(run, blocks, numbers)

    async def close(self) -> None:
        """Cancel a pending request."""
        if self._asking is not None:
            self._asking.cancel()
            await asyncio.gather(self._asking, return_exceptions=True)

    def _catch_up(self, run: str, blocks: list[Block], first_numbers: Mapping[str, int]) -> None:
        self._paused = True
        self._waiting.append((run, blocks))
        self._asking = asyncio.create_task(self._ask_and_merge(run, first_numbers))

    async def _ask_and_merge(self, run: str, first_numbers: Mapping[str, int]) -> None:
        backlog = await self._ask(first_numbers)
        if backlog is not None and backlog.run != run:
            # The process was restarted: its numbers begin anew.
            backlog = await self._ask(self.everything())
        self.begin_delivery(backlog)

    def _merge(self, backlog: BacklogReply | None) -> None:
        waiting, self._waiting = self._waiting, []
        first = waiting[0][0] if waiting else ""
        if backlog is None:
            # Without a backlog the missing samples stay missing.
            self._begin(first or self.run)
        elif backlog.run != self.run:
            if first != backlog.run:
                self._over.add(first)
            for run, blocks in waiting:
                if run == self.run:
                    self._pass_on(self._fresh(blocks))
            waiting = [(run, blocks) for run, blocks in waiting if run != self.run]
            self._begin(backlog.run)
        if backlog is not None:
            self._pass_on(self._fresh(backlog.blocks))
            self._expected = {topic.id: backlog.next.get(topic.name, 0) for topic in self.topics}
        for run, blocks in waiting:
            self.take(run, blocks)

    def _begin(self, run: str) -> None:
        if run != self.run:
            self._over.add(self.run)
        self.run, self._expected, self._last_request = run, {}, {}

    def _follow(self, blocks: list[Block]) -> bool:
        """Expect the samples after these blocks; return False, without a change, where one is missing."""
        expected = dict(self._expected)
        for block in blocks:
            topic = block.topic.id
            if expected.get(topic, block.first) != block.first:
                return False
            expected[topic] = (block.first + block.count) % NUMBERS
        self._expected = expected
        return True

    def _fresh(self, blocks: list[Block]) -> list[Block]:
        return [block for block in blocks if block.after(self._expected.get(block.topic.id, block.first))]

    def _pass_on(self, blocks: list[Block]) -> None:
        for block in blocks:
            self._expected[block.topic.id] = block.following
        if blocks:
            self._deliver(blocks)
