"""Faults of one direction of a serial line: at chosen rates, seeded and counted.

Faults follow from a seed and from how much is sent, not from when it is sent or in which portions.
"""

import math
import threading
from collections import Counter
from collections.abc import Iterable
from random import Random
from typing import Literal, get_args

Direction = Literal["to_board", "from_board"]
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
Kind = Literal["bit_errors", "drop", "double", "insert"]
KINDS: tuple[Kind, ...] = get_args(Kind)
COUNTS = ("bit_errors", "drops", "doubles", "inserts", "bursts", "burst_errors", "cuts", "stalls", "lost")
"""The names of the counts; `cuts` and `lost` are bytes, the latter those that the host did not read."""
_GAP_MAX = 1e15


class Recurrence:
    """An event with the same probability in each of many trials."""

    def __init__(self, rate: float, random: Random) -> None:
        """Raise ValueError unless the rate is from 0 to 1."""
        if not 0 <= rate <= 1:
            raise ValueError(f"a rate is from 0 to 1, and not {rate:g}")
        self._rate = rate
        self._random = random
        self._distance = self._gap()

    def hits(self, trials: int) -> list[int]:
        """Return the hits among the next trials, counted from 0."""
        hits = []
        while self._distance < trials:
            hits.append(int(self._distance))
            self._distance += 1 + self._gap()
        self._distance -= trials
        return hits

    def _gap(self) -> float:
        # The number of trials before the next hit is geometrically distributed.
        if self._rate == 0:
            return math.inf
        if self._rate == 1:
            return 0
        return math.floor(min(math.log(1 - self._random.random()) / math.log1p(-self._rate), _GAP_MAX))


class FaultyChannel:
    """One direction of the line: bytes in, damaged bytes out. Thread-safe."""

    def __init__(self, name: str, seed: int) -> None:
        self.counts: Counter[str] = Counter(dict.fromkeys(COUNTS, 0))
        self._name = name
        self._lock = threading.Lock()
        self._rates: dict[str, float] = dict.fromkeys((*KINDS, "burst"), 0.0)
        self._burst_bits = 1
        self._cut = False
        self.seed(seed)

    def seed(self, seed: int) -> None:
        """Seed all faults from now on."""
        with self._lock:
            self._seed = seed
            self._inserted = self._random("inserted")
            self._flips = self._random("flips")
            self._burst_rest = 0
            self._faults = {kind: Recurrence(rate, self._random(kind)) for kind, rate in self._rates.items()}

    def set_rate(self, kind: Kind, rate: float) -> None:
        """Set the probability of this fault for each bit (bit_errors) or byte. Raise ValueError."""
        self._set(kind, rate)

    def burst(self, rate: float, bits: int) -> None:
        """Set the probability that a burst of so many bits begins at a bit. Raise ValueError.

        Half of the bits in a burst are wrong.
        """
        if bits < 1:
            raise ValueError("a burst is at least one bit long")
        self._set("burst", rate)
        self._burst_bits = bits

    def cut(self, cut: bool) -> None:
        """Cut the line, or restore it."""
        self._cut = cut

    def clean(self) -> None:
        """Remove all faults; the counts stay."""
        for kind in self._rates:
            self._set(kind, 0.0)
        self._burst_rest = 0
        self._cut = False

    def carry(self, data: bytes) -> bytes:
        """Return the bytes that arrive when these are sent."""
        with self._lock:
            if self._cut:
                self.counts["cuts"] += len(data)
                return b""
            arriving = self._harm_bytes(data)
            self._harm_bits(arriving)
            return bytes(arriving)

    def _random(self, purpose: str) -> Random:
        # One for each purpose: otherwise the portions in which bytes come would decide.
        return Random(f"{self._seed} {self._name} {purpose}")

    def _set(self, kind: str, rate: float) -> None:
        recurrence = Recurrence(rate, self._random(kind))
        with self._lock:
            self._rates[kind] = rate
            self._faults[kind] = recurrence

    def _harm_bytes(self, data: bytes) -> bytearray:
        dropped, doubled, inserted = (
            set(self._faults[kind].hits(len(data))) for kind in ("drop", "double", "insert")
        )
        doubled -= dropped
        self.counts.update(drops=len(dropped), doubles=len(doubled), inserts=len(inserted))
        arriving = bytearray()
        for at, byte in enumerate(data):
            if at in inserted:
                arriving.append(self._inserted.getrandbits(8))
            if at not in dropped:
                arriving.append(byte)
            if at in doubled:
                arriving.append(byte)
        return arriving

    def _harm_bits(self, data: bytearray) -> None:
        bits = 8 * len(data)
        errors, beginnings = self._faults["bit_errors"].hits(bits), self._faults["burst"].hits(bits)
        burst = set(range(min(self._burst_rest, bits)))
        end = self._burst_rest
        for beginning in beginnings:
            if beginning >= end:
                self.counts["bursts"] += 1
                end = beginning + self._burst_bits
                burst.update(range(beginning, min(end, bits)))
        self._burst_rest = max(end - bits, 0)
        self._turn(data, (bit for bit in sorted(burst) if self._flips.getrandbits(1)), "burst_errors")
        self._turn(data, (bit for bit in errors if bit not in burst), "bit_errors")

    def _turn(self, data: bytearray, bits: Iterable[int], count: str) -> None:
        for bit in bits:
            data[bit // 8] ^= 1 << bit % 8
            self.counts[count] += 1
