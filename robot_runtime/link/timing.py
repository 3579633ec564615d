"""Timing of the serial line: airtime, telemetry periods, and the age at which a value is stale.

The board sends as firmware/src/schedule.h says. In ten slots of 10 ms each, or of as many as the line needs;
where that would be more than four, in three slots, with Depth in all of them.
"""

from robot_runtime.contract.packets import FRAME_BYTES_MAX, PACKETS, Packet

TICK = 0.01
"""s, of the board's main loop."""
PERIODS_MISSED = 3
"""A value is stale once this many of its kind are missing."""
_BITS_PER_BYTE = 10
_FRAME_OVERHEAD = 8
_SLOT_TICKS_MAX = 4
_TELEMETRY = [(packet, packet.telemetry) for packet in PACKETS.values() if packet.telemetry is not None]
_SAMPLES_IN_TEN = {packet: samples.in_ten for packet, samples in _TELEMETRY}
_SAMPLES_IN_THREE = {packet: samples.in_three for packet, samples in _TELEMETRY}


def airtime(size: int, baud: int) -> float:
    """Return the time (s) that so many bytes take on the line."""
    return size * _BITS_PER_BYTE / baud


def frames_airtime(count: int, baud: int) -> float:
    """Return the time (s) that so many frames of the largest size take on the line."""
    return count * airtime(FRAME_BYTES_MAX, baud)


def periods(baud: int) -> dict[type[Packet], float]:
    """Return the time (s) between two packets of each kind of telemetry."""
    ticks, slots, samples = _slot_ticks(_SAMPLES_IN_TEN, 11, 10, baud), 10, _SAMPLES_IN_TEN
    if ticks > _SLOT_TICKS_MAX:
        ticks, slots, samples = _slot_ticks(_SAMPLES_IN_THREE, 3, 3, baud), 3, _SAMPLES_IN_THREE
    return {packet: ticks * TICK * slots / count for packet, count in samples.items()}


def stale_after(least: float, packet: type[Packet], baud: int) -> float:
    """Return the age (s) at which a packet of this kind is missing; `least` at least."""
    return max(least, PERIODS_MISSED * periods(baud)[packet])


def _slot_ticks(samples: dict[type[Packet], int], frames: int, slots: int, baud: int) -> int:
    """Return a slot's ticks as the board computes them: in whole numbers, a quarter of the line spare."""
    size = sum(count * (1 + packet.layout.size) for packet, count in samples.items())
    bits = (size + frames * _FRAME_OVERHEAD) * _BITS_PER_BYTE * round(1 / TICK) * 5 // 4 // slots
    return -(-bits // baud)
