"""Fills gaps in what a process of the robot sends: missing samples are asked for again.

Samples are numbered by topic, and whoever sends them keeps those of the last minutes
(`robot_runtime.transport.replay_cache`).
While a question for them is out, what arrives waits, so that everything is passed on in order and once.
"""

import asyncio
from collections.abc import Awaitable, Callable, Mapping, Sequence

from robot_runtime.contract.topics import Topic
from robot_runtime.transport.blocks import Block
from robot_runtime.transport.replay_cache import BacklogReply

Ask = Callable[[Mapping[str, int]], Awaitable[BacklogReply | None]]
"""Asks for the blocks from these numbers on, by the topics' names; None where nobody answers."""


class GapFiller:
    """One process, through any number of its runs, and what only it sends.

    `deliver` is called with its blocks, in order. At first everything waits, until `begin_delivery`.
    """

    def __init__(self, topics: Sequence[Topic], ask: Ask, deliver: Callable[[list[Block]], None]) -> None:
        self.topics = topics
        self._ask = ask
        self._deliver = deliver
        self.run = ""
        """Of the process, as it was last heard; empty before."""
        self._over: set[str] = set()
        self._expected: dict[int, int] = {}
        self._last_request: dict[str, int] = {}
        self._waiting: list[tuple[str, list[Block]]] = []
        self._paused = True
        self._asking: asyncio.Task[None] | None = None

    def everything(self) -> dict[str, int]:
        """The request for the whole backlog."""
        return {topic.name: 0 for topic in self.topics}

    def begin_delivery(self, backlog: BacklogReply | None) -> None:
        """Pass on the process's backlog, if any, and then what arrives."""
        self._paused = False
        self._merge(backlog)

    def take(self, run: str, blocks: list[Block]) -> None:
        """Blocks have arrived from this run of the process; where it has no name, nothing is asked for."""
        if self._paused:
            self._waiting.append((run, blocks))
        elif not run or run in self._over:
            self._deliver(blocks)
        elif run != self.run:
            self._catch_up(run, blocks, self.everything())
        elif self._follow(blocks) or self._follow(blocks := self._fresh(blocks)):
            self._pass_on(blocks)
        else:
            numbers = {topic.name: self._expected.get(topic.id, 0) for topic in self.topics}
            if numbers == self._last_request:
                # It was asked for these already, and has not got them: they stay missing.
                self._pass_on(blocks)
            else:
                self._last_request = numbers
                self._catch_up(run, blocks, numbers)

    async def close(self) -> None:
        """Ask no more."""
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
            # Another run by now, whose numbers begin anew.
            backlog = await self._ask(self.everything())
        self.begin_delivery(backlog)

    def _merge(self, backlog: BacklogReply | None) -> None:
        waiting, self._waiting = self._waiting, []
        first = waiting[0][0] if waiting else ""
        if backlog is None:
            # Whatever is missing stays so.
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
        expected = dict(self._expected)
        for block in blocks:
            if expected.get(block.topic.id, block.first) != block.first:
                return False
            expected[block.topic.id] = block.following
        return True

    def _fresh(self, blocks: list[Block]) -> list[Block]:
        return [block for block in blocks if block.after(self._expected.get(block.topic.id, block.first))]

    def _pass_on(self, blocks: list[Block]) -> None:
        for block in blocks:
            self._expected[block.topic.id] = block.following
        if blocks:
            self._deliver(blocks)
