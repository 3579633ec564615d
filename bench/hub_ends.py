"""`python -m bench.hub_ends ROLE ...`: the processes whose cost and latency `bench.hub` measures.

`server DATA PORT PAGE` is the server alone, `doors DATA PORT PAGE ENDPOINT` the same with open doors, of
which that for ROS 2 is at this endpoint. `source DATA` sends it samples over Zenoh as the runtime does;
`foxglove PORT` logs the same samples to foxglove-sdk's server in its own process. Each runs until its
standard input ends.
"""

import asyncio
import itertools
import random
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from struct import Struct

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.topics import BY_NAME, TIME
from robot_runtime.transport.outbox import Outbox
from robot_runtime.transport.replay_cache import ReplayCache
from robot_runtime.transport.zenoh_transport import ZenohTransport
from server.app import create_app
from server.features.doors.config import DoorsConfig
from server.http.listener import open_socket
from server.http.serving import make_server
from server.platform.schema import prepare
from server.platform.server_config import ServerConfig
from server.platform.settings import DataFolder, Settings

TOPICS = ("imu", "depth", "beacon", "motor", "status", "navigation", "control", "link")
RATE = 100.0
"""Samples a second of each topic."""
PAST_SECONDS = 60
"""s of samples that the source sends at once when it begins."""
_VARIANTS = 997


def _records(name: str) -> list[bytes]:
    """Return the records of a topic, one after the other: IMU and fins have noise and a few spikes."""
    size = BY_NAME[name].row_bytes - TIME.size
    if name not in ("imu", "motor"):
        return [bytes(size)]
    chance = random.Random(1)
    values = [[chance.gauss(0, 1500) for _ in range(8)] for _ in range(_VARIANTS)]
    values[_VARIANTS // 2] = [30_000.0] * 8
    stamp, rest = Struct("<I"), Struct("<8h")
    return [(stamp.pack(0) + rest.pack(*map(int, value))).ljust(size, b"\0") for value in values]


_RECORDS = {name: _records(name) for name in TOPICS}


def _every_tick(do: Callable[[float], None], ended: threading.Event) -> None:
    """Call with the time (s, steady clock), RATE times a second."""
    due = time.monotonic()
    while not ended.wait(max(0.0, due - time.monotonic())):
        do(time.monotonic())
        due += 1 / RATE


async def _serve(
    data: Path, port: int, page: Path, ended: threading.Event, doors: DoorsConfig | None = None
) -> None:
    settings = Settings(data=DataFolder(data), config=Path("robot.toml"), page=page)
    settings = settings.with_section(ServerConfig(port=port))
    if doors is not None:
        settings = settings.with_section(doors)
    prepare(settings.data)
    server = make_server(create_app(settings, ()))
    with open_socket("127.0.0.1", port) as listener:
        running = asyncio.create_task(server.serve(sockets=[listener]))
        await asyncio.to_thread(ended.wait)
        server.should_exit = True
        await running


def _source(data: Path, ended: threading.Event) -> None:
    messages = ZenohTransport("turtle", listen=[f"unixsock-stream/{DataFolder(data).runtime_socket}"])
    cache = ReplayCache(messages.run, SteadyClock())
    messages.serve_bytes("query/blocks", cache.answer)
    outbox = Outbox(messages.publish, lambda _: False, cache)

    tick = itertools.count()

    def add(now: float) -> None:
        number = next(tick)
        for name in TOPICS:
            outbox.add_row(BY_NAME[name], now, _RECORDS[name][number % len(_RECORDS[name])])

    def send(now: float) -> None:
        add(now)
        outbox.flush()

    begin = time.monotonic() - PAST_SECONDS
    for past in range(int(PAST_SECONDS * RATE)):
        add(begin + past / RATE)
    outbox.flush()
    _every_tick(send, ended)
    messages.close()


def _foxglove(port: int, ended: threading.Event) -> None:
    import foxglove

    server = foxglove.start_server(host="127.0.0.1", port=port)
    schema = foxglove.Schema(name="row", encoding="", data=b"")
    channels = [
        (foxglove.Channel(f"/{name}", schema=schema, message_encoding="row"), _RECORDS[name])
        for name in TOPICS
    ]
    tick = itertools.count()

    def log(now: float) -> None:
        stamp, number = TIME.pack(now), next(tick)
        for channel, records in channels:
            channel.log(stamp + records[number % len(records)])

    _every_tick(log, ended)
    server.stop()


def main() -> None:
    role, *rest = sys.argv[1:]
    ended = threading.Event()

    def wait() -> None:
        sys.stdin.read()
        ended.set()

    threading.Thread(target=wait, daemon=True).start()
    if role in ("server", "doors"):
        doors = (
            DoorsConfig(rosbridge=True, foxglove=True, ros2=True, ros2_listen=rest[3])
            if role == "doors"
            else None
        )
        asyncio.run(_serve(Path(rest[0]), int(rest[1]), Path(rest[2]).resolve(), ended, doors))
    elif role == "source":
        _source(Path(rest[0]), ended)
    else:
        _foxglove(int(rest[0]), ended)


if __name__ == "__main__":
    main()
