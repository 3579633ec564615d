"""A synthetic dive with known figures: arming, steps to 0.5 m and 1 m, critically damped."""

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract import documents, packets
from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents, row
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import new_row
from tests.server.blocks import DEPTH_LOOP, state_block

STARTED_STEADY = 99.5
START = 100.0
"""s, steady clock"""
ARMED, STEPPED, DISARMED, END = 102.0, 112.0, 132.0, 134.0
SHOWN = 111.7
"""s, the card that deepens the set point"""
SHALLOW, DEEP = 0.5, 1.0
WN = 2.0
FLAPS = 1.25
"""Hz"""


def depth_at(time: float) -> float:
    """Depth in m; each step is followed as by wn² / (s + wn)², from rest."""

    def part(since: float) -> float:
        return 1 - np.exp(-WN * since) * (1 + WN * since) if since > 0 else 0.0

    return float(SHALLOW * part(time - ARMED) + (DEEP - SHALLOW) * part(time - STEPPED))


def set_point_at(time: float) -> float:
    return DEEP if time >= STEPPED else SHALLOW


def dive(
    controller: str = "pid",
    gains: Mapping[str, float] = {"kp": 3.0},
    *,
    arms: bool = True,
    lost: int = 0,
    begin: float = START,
) -> list[Block]:
    """Return the blocks of such a dive from `begin` on; `lost` frames are missing at its end."""
    blocks = [
        rows("depth", 50.0, begin, _depth if arms else lambda _: _depth(START)),
        rows("control", 10.0, begin, _control),
        rows("motor", 50.0, begin, _motor),
        rows("link", 1.0, begin, lambda time: _link(lost if time > DISARMED - 5 else 0)),
    ]
    chosen = {
        "name": controller,
        "title": controller.upper(),
        "gains": [
            {"name": name, "value": value, "minimum": 0, "maximum": 50, "unit": "", "meaning": ""}
            for name, value in gains.items()
        ],
    }
    begins = (START, False, None) if begin <= ARMED else (begin, True, None)
    moments = [begins, (ARMED + 0.04, True, None), (SHOWN, True, "yellow"), (DISARMED, False, "yellow")]
    if not arms:
        moments = [begins]
    elif begin > ARMED:
        moments.pop(1)
    for index, (time, armed, card) in enumerate(moments):
        blocks.append(
            state_block(
                index,
                time=time,
                mode="automatic" if armed else "disarmed",
                armed=armed,
                armed_since=ARMED if armed else None,
                card=card,
                loops=[DEPTH_LOOP | {"controller": controller, "controllers": [chosen]}],
            )
        )
    event = documents.Event(time=ARMED, kind="armed", severity="info", text="Armed.")
    return [*blocks, Block.of(BY_NAME["event"], 1, 0, pack_documents([event]))]


def record(
    store: Store, settings: Settings, blocks: list[Block], name: str = "dive", started: float = STARTED_STEADY
) -> int:
    """Record these blocks, where no event loop runs. Return the session's number."""
    return asyncio.run(record_dive(store, settings, blocks, name, started))


async def record_dive(
    store: Store, settings: Settings, blocks: list[Block], name: str = "dive", started: float = STARTED_STEADY
) -> int:
    """Record these blocks as a session that lasts until END. Return its number."""
    clock = SimulatedClock(started)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    session = await recorder.start(new_row(settings, clock, name, "", "{}"))
    for block in blocks:
        recorder.add(block)
    clock.forward(END - started)
    await recorder.stop(session.id)
    return session.id


def rows(topic: str, rate: float, begin: float, make: Callable[[float], Record]) -> Block:
    times = (begin + np.arange(round((END - begin) * rate)) / rate).tolist()
    payload = b"".join(row(time, make(time).to_bytes()) for time in times)
    return Block.of(BY_NAME[topic], len(times), 0, payload)


def _depth(time: float) -> Record:
    return packets.Depth(time=0, depth=depth_at(time), pressure=101_325, temperature=20.0)


def _control(time: float) -> Record:
    expected, depth = set_point_at(time), depth_at(time)
    armed = ARMED <= time < DISARMED
    return documents.Control(
        set_point=expected, depth=depth, error=expected - depth, output=-0.5 if armed else 0.0, latency=0.01
    )


def _motor(time: float) -> Record:
    angle = 0.6 * np.sin(2 * np.pi * FLAPS * time) if ARMED <= time < DISARMED else 0.0
    return packets.Motor(time=0, wanted=(angle,) * 4, angle=(angle,) * 4, drive=(0, 0, 0, 0))


def _link(lost: int) -> Record:
    values: dict[str, Any] = dict.fromkeys(LinkStatistics.wires, 0) | {"frames_missed": lost}
    return LinkStatistics(**values)
