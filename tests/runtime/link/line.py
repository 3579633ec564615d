"""A serial line in simulated time with faults, and a channel at each end."""

import random
from dataclasses import dataclass
from math import log

from robot_runtime.contract.packets import Acknowledge, Heartbeat, Packet
from robot_runtime.link.channel import Channel
from robot_runtime.link.framing import Decoder

KEY = 0x0102_0304
_SHORTEST_STEP = 1e-6
MESSAGES = 20_000


class Layout:
    """Size of a payload, all that the decoder needs of its layout."""

    def __init__(self, size: int) -> None:
        self.size = size


def packet_of(type_: int, size: int) -> type[Packet]:
    """Return a reliable packet for tests, of that many bytes."""
    attributes = {"type": type_, "reliable": True, "layout": Layout(size), "tail": None, "wires": {}}
    return type(f"Payload{size}", (Packet,), attributes)


PAYLOADS = {size: packet_of(0x70 + index, size) for index, size in enumerate((2, 6, 18))}
PACKETS: dict[int, type[Packet]] = {cls.type: cls for cls in PAYLOADS.values()}
PACKETS |= {cls.type: cls for cls in (Acknowledge, Heartbeat)}


@dataclass(frozen=True)
class Noise:
    """Rates of flipped bits and of lost, doubled and inserted bytes, and of bursts."""

    bits: float = 0.0
    drops: float = 0.0
    doubles: float = 0.0
    inserts: float = 0.0
    bursts: float = 0.0
    delay: float = 0.0
    """s that any byte may be late, without overtaking."""
    seed: int = 1


class NoisyWire:
    """One direction: frames are sent, and their bytes arrive after their time on the line."""

    def __init__(self, baud: int, noise: Noise, chance: random.Random) -> None:
        self.sent = 0
        self.carried: list[bytes] = []
        self._byte_time = 10 / baud
        self._noise = noise
        self._chance = chance
        self._free = 0.0
        self._arrivals: list[tuple[float, bytes]] = []

    def send(self, frame: bytes, now: float) -> None:
        """Append a frame to the line's traffic; an empty one is ignored."""
        if not frame:
            return
        self._free = max(self._free, now) + len(frame) * self._byte_time
        self.sent += len(frame)
        self.carried.append(frame)
        late = self._chance.uniform(0.0, self._noise.delay)
        arrival = max(self._free + late, self._arrivals[-1][0] if self._arrivals else 0.0)
        noise = self._noise
        if noise.doubles and self._chance.random() < noise.doubles:
            frame = frame + frame
        if noise.drops and self._chance.random() < noise.drops:
            frame = frame[:-1]
        if noise.inserts and self._chance.random() < noise.inserts:
            at = self._chance.randrange(len(frame))
            frame = frame[:at] + self._chance.randbytes(1) + frame[at:]
        if noise.bursts and self._chance.random() < noise.bursts:
            frame = self._chance.randbytes(len(frame))
        self._arrivals.append((arrival, self._flip(frame)))

    def receive(self, now: float) -> bytes:
        """Return the bytes that have arrived by now."""
        data = b""
        while self._arrivals and self._arrivals[0][0] <= now:
            data += self._arrivals.pop(0)[1]
        return data

    def due(self) -> float:
        """Time at which the next bytes arrive."""
        return self._arrivals[0][0] if self._arrivals else float("inf")

    def _flip(self, frame: bytes) -> bytes:
        """Flip bits at exponential distances, by the rate of bit errors."""
        if not self._noise.bits:
            return frame
        damaged = bytearray(frame)
        at = 0.0
        while True:
            at += -log(1.0 - self._chance.random()) / self._noise.bits
            if at >= 8 * len(damaged):
                return bytes(damaged)
            damaged[int(at) // 8] ^= 1 << int(at) % 8


class End:
    """One end: a channel that always has a message to send, or the given ones."""

    def __init__(self, baud: int, credit: int) -> None:
        self.channel = Channel(baud, credit, KEY)
        self.heard: list[tuple[int, bytes]] = []
        self.decoder = Decoder(PACKETS)
        self.decoder.key = KEY

    def take(self, data: bytes, now: float) -> None:
        """Take received bytes."""
        for frame in self.decoder.feed(data):
            if not frame.open:
                self.heard += self.channel.receive(frame, now)


class NoisyLine:
    """Two ends and a wire each way; time advances from event to event."""

    def __init__(self, baud: int, noise: Noise | None = None, credit: int = 4096) -> None:
        noise = noise or Noise()
        chance = random.Random(noise.seed)
        self.now = 0.0
        self.ends = (End(baud, credit), End(baud, credit))
        self.wires = (NoisyWire(baud, noise, chance), NoisyWire(baud, noise, chance))

    def run(self, until: float) -> None:
        """Run both ends up to this time."""
        while self.now < until:
            for end, out, into in zip(self.ends, self.wires, reversed(self.wires), strict=True):
                end.take(into.receive(self.now), self.now)
                while frame := end.channel.poll(self.now):
                    out.send(frame, self.now)
            due = min(*(end.channel.due() for end in self.ends), *(wire.due() for wire in self.wires))
            self.now = min(max(due, self.now + _SHORTEST_STEP), until)


def numbered(size: int, count: int) -> list[bytes]:
    """Distinct messages of this payload size, with zeros among their bytes."""
    head = bytes([PAYLOADS[size].type])
    return [head + number.to_bytes(2, "big") + bytes(range(size - 2)) for number in range(count)]


def goodput(baud: int, size: int, bit_errors: float = 0.0) -> float:
    """Share of baud/10 that the slower direction carries while both always have messages."""
    line = NoisyLine(baud, Noise(bits=bit_errors))
    messages = numbered(size, MESSAGES)
    for end in line.ends:
        for message in messages:
            end.channel.queue(message)
    seconds = 600 * 64 * 10 / baud
    line.run(seconds)
    for end in line.ends:
        assert end.heard == [(message[0], message[1:]) for message in messages[: len(end.heard)]]
        assert len(end.heard) < MESSAGES
    return min(len(end.heard) for end in line.ends) * size / (seconds * baud / 10)
