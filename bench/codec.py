"""Cost of a packet for the host, compared with other codecs in the same run."""

import time
import timeit
import zlib
from collections.abc import Callable

from cobs import cobs
from pymavlink.dialects.v10 import common as mavlink

from robot_runtime.contract.packets import Navigation, Packet, decode
from robot_runtime.link.framing import OPEN, Decoder, Frame, assemble, build
from tests.runtime.link.line import PAYLOADS

_ROUNDS = 100
_TIMES = 500
_CRC_BYTES = 4
_NUMBER, _ACKNOWLEDGED = 1, 2

Action = Callable[[], object]


def measure() -> dict[str, float]:
    """Return µs of CPU there and back, and multiples of the peers' in the same rounds; each in its best
    round.

    `us_per_packet`: from a payload's bytes to the frame on the line, and from that to the payload again, as
    the runtime handles most packets; sequence number, acknowledgement, session key, CRC and lengths are made
    and checked. `with_fields`: NAVIGATION from its six scaled numbers to the line and back to them.

    `ratio_to_cobs_zlib`: to COBS and CRC-32 by the C package cobs and zlib around the payload alone, which
    say nothing of a type, a number or a session.

    `ratio_to_same_frame`: to the shortest code with cobs and zlib that turns the same bytes into the same
    frame and that into the same `Frame`. It knows one type and one length and takes exactly one whole frame,
    of one message; ours takes a stream, in pieces, of many types, messages and texts.

    `ratio_to_pymavlink`: ours `with_fields`, to pymavlink's pack and parse of a MAVLink 1 message of as many
    payload bytes (REQUEST_DATA_STREAM), which packs and unpacks fields too: whole numbers without a scale. It
    resynchronises in a stream as ours does and numbers messages, has a CRC-16 (in C, from fastcrc) and no
    acknowledgement. `bytes_to_pymavlink`: ours without fields, to the same and RC_CHANNELS_OVERRIDE.

    Each ratio is the worse one of 6 and 18 bytes; `with_fields` has 6.
    """
    small, large = (bytes(range(1, size + 1)) for size in (6, 18))
    best = _best(
        {
            "ours.6": _ours(small),
            "ours.18": _ours(large),
            "same.6": _same(small),
            "same.18": _same(large),
            "bare.6": _bare(small),
            "bare.18": _bare(large),
            "mavlink.6": _mavlink(mavlink.MAVLink_request_data_stream_message(1, 1, 0, 50, 1)),
            "mavlink.18": _mavlink(mavlink.MAVLink_rc_channels_override_message(1, 1, *range(1000, 1008))),
            "fields": _with_fields(),
        }
    )

    def ratio(peer: str) -> float:
        return max(best[f"ours.{size}"] / best[f"{peer}.{size}"] for size in (6, 18))

    return {
        "codec.us_per_packet.6": best["ours.6"],
        "codec.us_per_packet.18": best["ours.18"],
        "codec.us_per_packet.6.with_fields": best["fields"],
        "codec.ratio_to_cobs_zlib": ratio("bare"),
        "codec.ratio_to_same_frame": ratio("same"),
        "codec.ratio_to_pymavlink": best["fields"] / best["mavlink.6"],
        "codec.bytes_to_pymavlink": ratio("mavlink"),
    }


def _ours(payload: bytes) -> Action:
    cls = PAYLOADS[len(payload)]
    decoder = Decoder({cls.type: cls})
    message = bytes([cls.type]) + payload

    def there_and_back() -> Frame:
        (frame,) = decoder.feed(assemble(message, True, _NUMBER, _ACKNOWLEDGED, OPEN))
        return frame

    return there_and_back


def _same(payload: bytes) -> Action:
    type_, size = PAYLOADS[len(payload)].type, len(payload)
    message = bytes([type_]) + payload

    def there_and_back() -> Frame:
        content = bytes([_NUMBER << 4 | _ACKNOWLEDGED]) + message
        checksum = zlib.crc32(content) ^ OPEN
        line = cobs.encode(content + checksum.to_bytes(_CRC_BYTES, "little")) + b"\0"

        stuffed, _, _ = line.partition(b"\0")
        content = cobs.decode(stuffed)
        body, checksum = content[:-_CRC_BYTES], int.from_bytes(content[-_CRC_BYTES:], "little")
        if zlib.crc32(body) ^ checksum != OPEN or body[1] != type_ or len(body) != size + 2:
            raise ValueError("no such frame")
        return Frame(body[0] >> 4, body[0] & 15, True, True, ((body[1], body[2:]),))

    if there_and_back() != _ours(payload)():
        raise AssertionError("the peer makes another frame of it")
    return there_and_back


def _bare(payload: bytes) -> Action:
    def there_and_back() -> bytes:
        line = cobs.encode(payload + zlib.crc32(payload).to_bytes(_CRC_BYTES, "little"))
        content: bytes = cobs.decode(line)
        if zlib.crc32(content[:-_CRC_BYTES]) != int.from_bytes(content[-_CRC_BYTES:], "little"):
            raise ValueError("no such frame")
        return content[:-_CRC_BYTES]

    return there_and_back


def _mavlink(message: mavlink.MAVLink_message) -> Action:
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    link.robust_parsing = True

    def there_and_back() -> object:
        (parsed,) = link.parse_buffer(message.pack(link))
        return parsed

    return there_and_back


def _with_fields() -> Action:
    packet = Navigation(x=0.5, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=-0.5)
    decoder = Decoder()

    def there_and_back() -> Packet:
        (frame,) = decoder.feed(build([packet], _NUMBER, _ACKNOWLEDGED))
        return decode(*frame.messages[0])

    return there_and_back


def _best(actions: dict[str, Action]) -> dict[str, float]:
    """Return µs of each codec in its best round.

    All have their turn in each round, so that none is favoured.
    """
    timers = {name: timeit.Timer(action, timer=time.thread_time) for name, action in actions.items()}
    rounds = [{name: timer.timeit(_TIMES) for name, timer in timers.items()} for _ in range(_ROUNDS)]
    return {name: min(timing[name] for timing in rounds) / _TIMES * 1e6 for name in actions}
