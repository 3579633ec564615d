"""docs/reference/topics.md: every topic between the processes."""

import dataclasses
import typing
from collections.abc import Iterator

from robot_runtime.contract.documents import Document
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import TOPICS, Kind, Topic
from robot_runtime.generate.commands import describe_type
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/contract/topics.py"
INTRODUCTION = """\
A topic is a stream of samples that one process sends and the others receive over Zenoh; the page receives it
on the [live socket](live-socket.md). *Rows* are fixed binary records, *documents* are JSON objects, a
*picture* is one JPEG file. A page that connects receives the last minutes of a topic, or of *newest only*
topics the newest document. *Lines* are shown one by one to a person, and are the log of an MCAP export. Every
sample has a time in s of the steady clock. [The serial link's packets](packets.md) are topics, too.
"""


def topics_page() -> str:
    """The whole text of topics.md."""
    head = ("topic", "number", "kind", "sender", "recorded", "", "meaning")
    parts = [INTRODUCTION, table(head, map(_summary, TOPICS))]
    for topic in TOPICS:
        if topic.record is not None:
            parts += [f"## {topic.name}\n", f"{' '.join((topic.record.__doc__ or '').split())}\n"]
            parts.append(table(("field", "type", "meaning"), _fields(topic.record)))
    return page("Topics", SOURCE, *parts)


def _summary(topic: Topic) -> tuple[str, ...]:
    name = f"`{topic.name}`" if topic.kind is Kind.PICTURE else f"[{topic.name}](#{topic.name})"
    rules = [words for words, holds in (("newest only", topic.newest_only), ("lines", topic.lines)) if holds]
    return (
        name,
        str(topic.id),
        topic.kind.name.lower(),
        topic.sender,
        "yes" if topic.recorded else "",
        ", ".join(rules),
        topic.meaning,
    )


def _fields(record: type[Record] | type[Document]) -> Iterator[tuple[str, ...]]:
    if issubclass(record, Record):
        for name, wire in record.wires.items():
            count = f" × {wire.count}" if wire.count > 1 else ""
            yield f"`{name}`", f"number{count}", ", ".join(part for part in (wire.unit, wire.meaning) if part)
        return
    hints = typing.get_type_hints(record, include_extras=True)
    for one in dataclasses.fields(record):
        yield f"`{one.name}`", describe_type(hints[one.name]), one.metadata.get("meaning", "")
