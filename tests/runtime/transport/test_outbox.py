"""The sender of samples: pictures of a film are never left out, others may be."""

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.topics import FILM, THUMBNAIL
from robot_runtime.transport.blocks import Block, read_blocks
from robot_runtime.transport.outbox import STREAM, Outbox
from robot_runtime.transport.replay_cache import BacklogReply, ReplayCache, write_question


def test_every_picture_of_a_film_is_sent_and_kept_for_a_server_that_restarts() -> None:
    sent: list[tuple[str, bytes]] = []
    cache = ReplayCache("run", SimulatedClock())
    outbox = Outbox(lambda name, data: sent.append((name, data)), lambda _: False, cache)
    for number in range(3):
        outbox.add_film(20.0 + number, bytes([number]))
        outbox.add_picture(THUMBNAIL, 20.0 + number, bytes([number]))
    outbox.flush()
    ((name, data),) = sent
    assert name == STREAM

    def film(blocks: list[Block]) -> list[tuple[int, bytes]]:
        return [(block.first, block.payload[8:]) for block in blocks if block.topic is FILM]

    assert film(read_blocks(data)) == [(0, b"\0"), (1, b"\1"), (2, b"\2")]
    assert [block.payload[8:] for block in read_blocks(data) if block.topic is THUMBNAIL] == [b"\2"]
    reply = BacklogReply.from_bytes(cache.answer(write_question({"film": 1})))
    assert film(reply.blocks) == [(1, b"\1"), (2, b"\2")]
    assert reply.next["film"] == 3
