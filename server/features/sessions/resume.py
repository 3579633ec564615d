"""A session that a killed server has left recording: if it can go on, and from where."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlmodel import col, func, select

from robot_runtime.clock import boot
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import BY_NAME, Topic
from robot_runtime.transport.blocks import NUMBERS, Block
from robot_runtime.transport.replay_cache import BacklogReply
from server.platform.models import Chunk, SessionRow
from server.platform.store import Store

_STATE = BY_NAME["state"]
RESUMED_ORIGINS = ("operator", "arming", "scenario")
"""Not one in simulated time, which was computed by the server itself."""


@dataclass(frozen=True, slots=True)
class Last:
    """Where a topic's samples end: the number that comes next, the last one's time and sender, and the chunks
    so far.
    """

    following: int
    time: float
    run: str
    chunks: int


@dataclass(frozen=True, slots=True)
class InterruptedSession:
    """A session that was left recording, and where its topics (by name) end."""

    row: SessionRow
    last: Mapping[str, Last]


@dataclass(frozen=True, slots=True)
class Missing:
    """Samples of a sender that are not stored: the first number of each topic, by the topics' numbers.

    `same_run`: the session is a recording of this run of the sender. `whole`: the sender still has all that
    is missing. `sent`: how many samples of each topic (by name) it has sent since what is stored; empty if it
    may be another run.
    """

    first: Mapping[int, int]
    same_run: bool
    whole: bool
    sent: Mapping[str, int]


def find_interrupted(store: Store) -> InterruptedSession | None:
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
            end.topic: Last((end.first + end.count) % NUMBERS, end.last_time, end.run, end.number + 1)
            for end in ends
        }
        database.expunge(row)
    return InterruptedSession(row, last)


def find_missing(interrupted: InterruptedSession, topics: Sequence[Topic], backlog: BacklogReply) -> Missing:
    """Compare what is stored with what the sender of these topics has kept."""
    blocks: dict[int, list[Block]] = {topic.id: [] for topic in topics}
    for block in backlog.blocks:
        blocks[block.topic.id].append(block)
    first: dict[int, int] = {}
    sent: dict[str, int] = {}
    whole = True
    for topic in topics:
        following, there = backlog.next.get(topic.name, 0), blocks[topic.id]
        last = interrupted.last.get(topic.name)
        if last is None:
            first[topic.id] = _first_since(interrupted.row.started_steady, there, following)
            continue
        # Of this run nothing may be stored yet, although another one is.
        missing_from = last.following if last.run == backlog.run else 0
        ahead = (following - missing_from) % NUMBERS
        first[topic.id] = missing_from
        sent[topic.name] = ahead
        whole = whole and (ahead == 0 or _holds(there, missing_from))
    stored = any(
        topic.name in interrupted.last and interrupted.last[topic.name].run == backlog.run for topic in topics
    )
    same_run = stored or _new(interrupted, topics, backlog)
    return Missing(first, same_run, whole, sent if same_run else {})


def _new(interrupted: InterruptedSession, topics: Sequence[Topic], backlog: BacklogReply) -> bool:
    """True if nothing of this sender is stored yet, and it is the one with which the session began.

    That is known of the runtime, whose `state` is stored at the start. A session takes any simulator.
    """
    if any(topic.name in interrupted.last for topic in topics):
        return False
    state = json.loads(interrupted.row.robot_state)
    return _STATE not in topics or (isinstance(state, dict) and state.get("run") == backlog.run)


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
