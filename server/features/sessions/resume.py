"""Whether a session that a killed server has left recording can go on, and from where."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

from sqlmodel import col, func, select

from robot_runtime.clock import boot
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import BY_NAME, NUMBERS, Block, Topic
from robot_runtime.transport.replay_cache import BacklogReply
from server.platform.models import Chunk, SessionRow
from server.platform.store import Store

_STATE = BY_NAME["state"]
RESUMED_ORIGINS = ("operator", "arming", "scenario")
"""Not one in simulated time, which was computed by the server itself."""
RESTATED = {"parameters"}
"""A session begins with what is in force, as of then: not at the time at which it was sent."""


@dataclass(frozen=True, slots=True)
class Last:
    """Where a topic's samples end: the number that comes next, the last one's time, and the chunks so far."""

    following: int
    time: float
    chunks: int


@dataclass(frozen=True, slots=True)
class Left:
    """A session that was left recording, and where its topics (by name) end."""

    row: SessionRow
    last: Mapping[str, Last]


@dataclass(frozen=True, slots=True)
class Missing:
    """What a sender has that is not stored: the first such number of each topic, by the topics' numbers.

    `same_run`: the sender is the one that was recorded, as a stored sample shows that it still has, or its
    name where none is stored yet. `whole`: it has kept all that is missing. `sent`: how many samples of each
    topic (by name) it has sent since what is stored; empty where it may be another one.
    """

    first: Mapping[int, int]
    same_run: bool
    whole: bool
    sent: Mapping[str, int]


def find_left(store: Store) -> Left | None:
    """The newest session that was left recording since this computer was started. Raises StoreError."""
    with store.read() as database:
        row = database.exec(
            select(SessionRow)
            .where(
                SessionRow.state == "recording",
                SessionRow.boot == boot(),
                col(SessionRow.origin).in_(RESUMED_ORIGINS),
            )
            .order_by(col(SessionRow.id).desc())
            .limit(1)
        ).first()
        if row is None:
            return None
        newest = select(func.max(Chunk.id)).where(Chunk.session_id == row.id).group_by(Chunk.topic)
        ends = database.exec(select(Chunk).where(col(Chunk.id).in_(newest)))
        last = {
            end.topic: Last((end.first + end.count) % NUMBERS, end.last_time, end.number + 1) for end in ends
        }
        database.expunge(row)
    return Left(row, last)


def find_missing(left: Left, topics: Sequence[Topic], kept: BacklogReply) -> Missing:
    """Compare what is stored with what the sender of these topics has kept."""
    blocks: dict[int, list[Block]] = {topic.id: [] for topic in topics}
    for block in kept.blocks:
        blocks[block.topic.id].append(block)
    first: dict[int, int] = {}
    sent: dict[str, int] = {}
    proofs: set[bool] = set()
    whole = True
    for topic in topics:
        following, there = kept.next.get(topic.name, 0), blocks[topic.id]
        last = left.last.get(topic.name)
        if last is None:
            first[topic.id] = _first_since(left.row.started_steady, there, following)
            continue
        wanted, ahead = last.following, (following - last.following) % NUMBERS
        proof = {False} if ahead >= NUMBERS // 2 else _prove(last, there, _restated(topic, left.row))
        proofs |= proof
        if proof == {False}:
            # Stored of an earlier run; of this one, if it is this one, nothing yet.
            wanted, ahead = 0, following
        first[topic.id] = wanted
        sent[topic.name] = ahead
        whole = whole and (ahead == 0 or _holds(there, wanted))
    # One sample that both have is enough: runs follow each other. Where the last stored one is not kept any
    # more, its name shows that it is the same.
    known = True in proofs or (not proofs and _began(left, topics, kept))
    same_run = True in proofs or _new(left, topics, kept)
    return Missing(first, same_run, whole, sent if known else {})


def _new(left: Left, topics: Sequence[Topic], kept: BacklogReply) -> bool:
    """Whether nothing of this sender is stored yet, and it is the one that the session began with.

    That is known of the runtime, whose `state` is written down at the start; whichever simulator there is may
    begin a session.
    """
    if any(topic.name in left.last for topic in topics):
        return False
    return _STATE not in topics or _began(left, topics, kept)


def _began(left: Left, topics: Sequence[Topic], kept: BacklogReply) -> bool:
    """Whether this is the runtime whose `state` was written down when the session began."""
    state = json.loads(left.row.robot_state)
    return _STATE in topics and isinstance(state, dict) and state.get("run") == kept.run


def _restated(topic: Topic, row: SessionRow) -> float:
    """Until when, s, what this topic told was stored as of a later time."""
    return row.started_steady if topic.name in RESTATED else -inf


def _prove(last: Last, blocks: Sequence[Block], restated: float) -> set[bool]:
    """Whether the last stored sample is the one that was kept under its number.

    Empty where none was, or it is no later than `restated`, so that its stored time says nothing.
    """
    number = (last.following - 1) % NUMBERS
    for block in blocks:
        if _holds([block], number):
            try:
                time = block.time_of(number)
                return set() if time <= restated else {time == last.time}
            except LayoutError:
                return {False}
    return set()


def _holds(blocks: Sequence[Block], number: int) -> bool:
    return any((number - block.first) % NUMBERS < block.count for block in blocks)


def _first_since(time: float, blocks: Sequence[Block], following: int) -> int:
    for block in blocks:
        try:
            if block.time_of((block.following - 1) % NUMBERS) >= time:
                return block.first
        except LayoutError:
            continue
    return following
