"""Gaps in the stream, filled from real caches."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from robot_runtime.transport.replay_cache import BacklogReply, ReplayCache, write_question
from server.stream.gap_filler import GapFiller
from tests.server.blocks import debug_block, depth_block
from tests.server.waiting import until

TOPICS = (BY_NAME["depth"], BY_NAME["debug"])


class Sender:
    """One run of a process: numbers blocks of depths and stores them in a replay cache."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.cache = ReplayCache(name, SimulatedClock())
        self.next = 0

    def send(self, count: int = 5) -> Block:
        block = depth_block(self.next, count)
        self.next = block.following
        self.cache.add(block.data, {"depth": self.next, "debug": 0})
        return block


class Receiver:
    """A gap filler and its output. It asks the living sender once the gate is open."""

    def __init__(self) -> None:
        self.alive: Sender | None = None
        self.gate = asyncio.Event()
        self.gate.set()
        self.asked: list[Mapping[str, int]] = []
        self.delivered: list[Block] = []
        self.source = GapFiller(TOPICS, self._ask, self.delivered.extend)

    @property
    def numbers(self) -> list[int]:
        return [block.first for block in self.delivered]

    def hear(self, sender: Sender, *blocks: Block) -> None:
        for block in blocks:
            self.source.take(sender.name, [block])

    async def settle(self, count: int) -> None:
        await until(lambda: len(self.delivered) >= count, f"{count} blocks")

    async def _ask(self, first_numbers: Mapping[str, int]) -> BacklogReply | None:
        self.asked.append(first_numbers)
        answer = self.alive and self.alive.cache.answer(write_question(first_numbers))
        await self.gate.wait()
        return BacklogReply.from_bytes(answer) if answer else None


@asynccontextmanager
async def receiving() -> AsyncIterator[Receiver]:
    receiver = Receiver()
    receiver.source.begin_delivery(None)
    yield receiver
    await receiver.source.close()


@pytest.fixture
async def receiver() -> AsyncIterator[Receiver]:
    async with receiving() as receiver:
        yield receiver


async def test_at_first_contact_the_backlog_comes_first(receiver: Receiver) -> None:
    sender = receiver.alive = Sender("a")
    sender.send()
    sender.send()
    receiver.hear(sender, sender.send())
    receiver.hear(sender, sender.send())
    await receiver.settle(4)
    assert receiver.numbers == [0, 5, 10, 15]
    assert receiver.asked == [{"depth": 0, "debug": 0}]
    receiver.hear(sender, sender.send())
    assert receiver.numbers == [0, 5, 10, 15, 20]


async def test_a_gap_is_filled_before_later_blocks(receiver: Receiver) -> None:
    sender = receiver.alive = Sender("a")
    receiver.hear(sender, sender.send())
    await receiver.settle(1)
    receiver.gate.clear()
    sender.send()
    receiver.hear(sender, sender.send())
    receiver.hear(sender, sender.send())
    await until(lambda: len(receiver.asked) == 2, "the question")
    assert receiver.numbers == [0]
    sender.send()
    receiver.hear(sender, sender.send())
    receiver.gate.set()
    await receiver.settle(6)
    assert receiver.numbers == [0, 5, 10, 15, 20, 25]
    assert [asked["depth"] for asked in receiver.asked] == [0, 5, 20]


async def test_duplicates_are_passed_on_once(receiver: Receiver) -> None:
    sender = receiver.alive = Sender("a")
    first, second = sender.send(), sender.send()
    receiver.hear(sender, second, first)
    await receiver.settle(2)
    receiver.hear(sender, first, second, sender.send())
    assert receiver.numbers == [0, 5, 10]
    assert len(receiver.asked) == 1


async def test_an_unfilled_gap_stays_and_does_not_stop_later_blocks(receiver: Receiver) -> None:
    sender = Sender("a")
    first, _, third, fourth = (sender.send() for _ in range(4))
    receiver.hear(sender, first)
    await receiver.settle(1)
    receiver.hear(sender, third)
    await receiver.settle(2)
    receiver.hear(sender, fourth)
    assert receiver.numbers == [0, 10, 15]
    assert len(receiver.asked) == 2


async def test_samples_beyond_the_replay_cache_are_requested_once(receiver: Receiver) -> None:
    sender = receiver.alive = Sender("a")
    receiver.hear(sender, sender.send())
    await receiver.settle(1)
    sender.next += 5
    receiver.hear(sender, sender.send())
    await receiver.settle(2)
    receiver.hear(sender, sender.send())
    assert receiver.numbers == [0, 10, 15]
    assert len(receiver.asked) == 2


async def test_a_new_run_is_passed_on_from_its_beginning_after_the_end_of_the_old_one(
    receiver: Receiver,
) -> None:
    old = receiver.alive = Sender("old")
    receiver.hear(old, old.send())
    await receiver.settle(1)
    old.send()
    new = receiver.alive = Sender("new")
    new.send()
    receiver.hear(old, old.send())
    receiver.hear(new, new.send())
    receiver.hear(old, old.send())
    await receiver.settle(5)
    # A hole of the old run that only the old run could have filled.
    assert receiver.numbers == [0, 10, 15, 0, 5]
    receiver.hear(new, new.send())
    receiver.hear(old, old.send())
    assert receiver.numbers == [0, 10, 15, 0, 5, 10, 20]


async def test_a_run_that_ends_before_its_request_does_no_harm(receiver: Receiver) -> None:
    short = Sender("short")
    heard = short.send()
    sender = receiver.alive = Sender("a")
    sender.send()
    receiver.hear(short, heard)
    await receiver.settle(2)
    receiver.hear(sender, sender.send())
    receiver.hear(short, short.send())
    assert receiver.numbers == [0, 0, 5, 5]
    assert len(receiver.asked) == 2


async def test_runs_without_a_name_are_not_requested(receiver: Receiver) -> None:
    for first in (100, 50, 200):
        receiver.source.take("", [depth_block(first, 5), debug_block(first, "a")])
    assert receiver.numbers == [100, 100, 50, 50, 200, 200]
    assert receiver.asked == []


@given(st.lists(st.sampled_from(["lost", "heard", "twice", "later"]), max_size=30))
async def test_all_losses_on_the_way_are_filled_in_the_end(fates: list[str]) -> None:
    async with receiving() as receiver:
        sender = receiver.alive = Sender("a")
        held: list[Block] = []
        for index, fate in enumerate(fates):
            block = sender.send(1 + index % 3)
            if fate == "later":
                held.append(block)
            for _ in range(("lost", "heard", "twice").index(fate) if fate != "later" else 0):
                receiver.hear(sender, block)
            if index % 4 == 0:
                await asyncio.sleep(0)
        receiver.hear(sender, *held)
        receiver.hear(sender, sender.send())
        await until(
            lambda: receiver.delivered and receiver.delivered[-1].following == sender.next, "the last"
        )
        numbers = [block.first + position for block in receiver.delivered for position in range(block.count)]
        assert numbers == list(range(sender.next))
