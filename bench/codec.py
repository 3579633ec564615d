"""Encoding and decoding on the host, beside bare COBS and CRC in the same run."""

import timeit
import zlib
from collections.abc import Callable

from cobs import cobs

from robot_runtime.link.framing import Decoder, build
from robot_runtime.packets import Navigation

_ROUNDS = 20_000


def measure() -> dict[str, float]:
    """µs for one navigation command there and back, and as a multiple of the bare codecs."""
    packet = Navigation(x=0.0, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=0.0)
    decoder = Decoder()
    ours = _micros(lambda: list(decoder.feed(build([packet], 1, 0))))
    bare = _micros(lambda: _bare(packet.to_bytes()))
    return {"codec.us_per_packet.6": ours, "codec.ratio_to_cobs_zlib": ours / bare}


def _bare(payload: bytes) -> bytes:
    stuffed = cobs.encode(payload + zlib.crc32(payload).to_bytes(4, "little"))
    content: bytes = cobs.decode(stuffed)
    if zlib.crc32(content[:-4]) != int.from_bytes(content[-4:], "little"):
        raise AssertionError("the checksum differs")
    return content


def _micros(action: Callable[[], object]) -> float:
    return min(timeit.repeat(action, number=_ROUNDS, repeat=3)) / _ROUNDS * 1e6
