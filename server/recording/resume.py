"""The session that a killed server left recording, and its continuation."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlmodel import col, func, select

from robot_runtime.clock import boot
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import STATE, AnyTopic
from robot_runtime.transport.blocks import NUMBERS, Block
from robot_runtime.transport.replay_cache import BacklogReply
from server.platform.models import BookmarkRow, Chunk, SessionRow, SessionTag
from server.platform.store import Store
from server.recording.session import REAL_ORIGINS


@dataclass(frozen=True, slots=True)
class TopicEnd:
    """The end of a topic's samples: the next number, time and sender of the last one, number of chunks."""

    following: int
    time: float
    run: str
    chunks: int


@dataclass(frozen=True, slots=True)
class InterruptedSession:
    """A session that was left recording, the ends of its topics by name, its tags and number of bookmarks."""

    row: SessionRow
    last: Mapping[str, TopicEnd]
    tags: Sequence[str]
    markers: int


@dataclass(frozen=True, slots=True)
class MissingSamples:
    """Samples of a sender that are not stored: the first number of each topic, by the topics' numbers.

    `same_run`: the session is a recording of this run of the sender. `whole`: the sender still has all of
    them. `sent`: the number of samples by topic since the last stored one; empty if it may be another run.
    """

    first: Mapping[int, int]
    same_run: bool
    whole: bool
    sent: Mapping[str, int]


def find_interrupted(store: Store) -> InterruptedSession | None:
    """Return the newest session that was left recording since this computer was started. Raise StoreError."""
    with store.read() as database:
        row = database.exec(
            select(SessionRow)
            .where(
                SessionRow.state == "recording",
                SessionRow.boot == boot(),
                col(SessionRow.origin).in_(REAL_ORIGINS),
            )
            .order_by(col(SessionRow.id).desc())
            .limit(1)
        ).first()
        if row is None:
            return None
        newest = select(func.max(Chunk.id)).where(Chunk.session_id == row.id).group_by(Chunk.topic)
        ends = database.exec(select(Chunk).where(col(Chunk.id).in_(newest)))
        last = {
            end.topic: TopicEnd((end.first + end.count) % NUMBERS, end.last_time, end.run, end.number + 1)
            for end in ends
        }
        tags = database.exec(select(SessionTag.tag).where(SessionTag.session_id == row.id)).all()
        marked = select(func.count()).select_from(BookmarkRow).where(BookmarkRow.session_id == row.id)
        markers = database.exec(marked).one()
        database.expunge(row)
    return InterruptedSession(row, last, tags, markers)


def find_missing(
    interrupted: InterruptedSession, topics: Sequence[AnyTopic], backlog: BacklogReply
) -> MissingSamples:
    """Compare the stored samples with the backlog of the sender of these topics."""
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
        # The stored samples may be of another run.
        missing_from = last.following if last.run == backlog.run else 0
        ahead = (following - missing_from) % NUMBERS
        first[topic.id] = missing_from
        sent[topic.name] = ahead
        whole = whole and (ahead == 0 or _holds(there, missing_from))
    stored = any(
        topic.name in interrupted.last and interrupted.last[topic.name].run == backlog.run for topic in topics
    )
    same_run = stored or _new(interrupted, topics, backlog)
    return MissingSamples(first, same_run, whole, sent if same_run else {})


def _new(interrupted: InterruptedSession, topics: Sequence[AnyTopic], backlog: BacklogReply) -> bool:
    """Return True if nothing of this sender is stored yet, and the session began with it.

    The `state` stored at the start shows it for the runtime. Any simulator is accepted.
    """
    if any(topic.name in interrupted.last for topic in topics):
        return False
    state = json.loads(interrupted.row.robot_state)
    return STATE not in topics or (isinstance(state, dict) and state.get("run") == backlog.run)


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
