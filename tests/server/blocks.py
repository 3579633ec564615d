"""Blocks as the runtime sends them, with contents that tests can distinguish."""

import json
from typing import Any

from robot_runtime.contract import documents, packets
from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.topics import BY_NAME, Kind
from robot_runtime.transport.blocks import Block, pack_documents, row


def depth_record(number: int) -> packets.Depth:
    return packets.Depth(time=number, depth=number % 1000 / 1000, pressure=101_325 + number, temperature=20.5)


def depth_block(first: int, count: int, start: float = 100.0, period: float = 0.02) -> Block:
    """Rows whose board time is their own number."""
    rows = b"".join(
        row(start + number * period, depth_record(number).to_bytes())
        for number in range(first, first + count)
    )
    return Block.of(BY_NAME["depth"], count, first, rows)


def debug_block(first: int, *texts: str, start: float = 100.0) -> Block:
    lines = [
        documents.DebugLine(time=start + first + index, level=1, text=text)
        for index, text in enumerate(texts)
    ]
    return Block.of(BY_NAME["debug"], len(lines), first, pack_documents(lines))


def picture_block(number: int, size: int = 20, topic: str = "picture") -> Block:
    return Block.of(BY_NAME[topic], 1, number, row(100.0, bytes([number % 256]) * size))


def thumbnail_block(number: int, time: float, jpeg: bytes) -> Block:
    return Block.of(BY_NAME["thumbnail"], 1, number, row(time, jpeg))


def snapshot_block(number: int, time: float, jpeg: bytes) -> Block:
    return Block.of(BY_NAME["snapshot"], 1, number, row(time, jpeg))


def film_block(number: int, time: float, picture: bytes) -> Block:
    return Block.of(BY_NAME["film"], 1, number, row(time, picture))


def link_block(first: int, bytes_received: int) -> Block:
    values: dict[str, Any] = dict.fromkeys(LinkStatistics.wires, 0) | {"bytes_received": bytes_received}
    return Block.of(BY_NAME["link"], 1, first, row(100.0, LinkStatistics(**values).to_bytes()))


DEPTH_LOOP = {"name": "depth", "on": False, "set_point": 0.5, "controller": "pid", "controllers": []}


def state_block(first: int, **changes: Any) -> Block:
    document: dict[str, Any] = {
        "time": 100.0,
        "run": "0123456789abcdef",
        "mode": "disarmed",
        "armed": False,
        "armed_since": None,
        "alarms": [],
        "pilot_dropped": 0,
        "refusals": [],
        "connected": True,
        "connection": "connected",
        "port": "board.tty",
        "baud": 250_000,
        "paces": [{"topic": "depth", "period": 0.02}],
        "epoch": 1,
        "steering": "none",
        "loops": [DEPTH_LOOP],
        "set_point_default": 0.5,
        "set_point_detected": 1.0,
        "deepest": 3.0,
        "unwatched": 30.0,
        "battery_left": None,
        "buoyancy_known": True,
        "control_rate": 10.0,
        "profile": "full",
        "vision_rate": 4.0,
        "stream_rate": 15.0,
        "vision_colour": "yellow",
        "colours": ["yellow"],
        "card": None,
        "cards": [],
        "camera": "card",
    }
    return Block.of(BY_NAME["state"], 1, first, json.dumps([document | changes]).encode())


def truth_block(first: int) -> Block:
    topic = BY_NAME["truth"]
    assert topic.kind is Kind.ROWS
    return Block.of(topic, 1, first, bytes(topic.row_bytes))


def mission_block(first: int, *missions: documents.Mission) -> Block:
    """Documents of missions."""
    return Block.of(BY_NAME["mission"], len(missions), first, pack_documents(list(missions)))
