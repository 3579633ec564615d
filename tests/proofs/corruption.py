"""Corrupted frames by the million, through the chip's decoder and the host's, over the same bytes.

`firmware/host/proofs/corruption.h` defines the damage. An undetected corruption is an accepted frame
that was not sent in this session, in order and at most once.
"""

import ctypes
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple, Self

from robot_runtime.link.framing import Decoder, assemble
from tests.board.rig import ROOT, build
from tests.proofs.pool import processes

Checksum = Literal["crc32", "crc16", "xor8"]
End = Literal["chip", "host"]
ENDS: tuple[End, ...] = ("chip", "host")
BATCH = 2000
"""Damaged frames that are read at once."""


class Model(NamedTuple):
    """A kind of corruption: its number in corruption.h, and the rate of bit errors."""

    damage: int
    rate: float = 0.0


MODELS = {
    "bit errors 1e-4": Model(0, 1e-4),
    "bit errors 1e-3": Model(0, 1e-3),
    "bit errors 1e-2": Model(0, 1e-2),
    "bit errors 1e-1": Model(0, 1e-1),
    "bursts": Model(1),
    "deleted bytes": Model(2),
    "inserted bytes": Model(3),
    "doubled bytes": Model(4),
    "moved bytes": Model(5),
    "truncated": Model(6),
    "joined": Model(7),
    "garbage": Model(8),
    "wrong checksum": Model(9),
    "another session": Model(10),
    "another session, bit errors": Model(11),
}


@dataclass
class FrameCounts:
    """Corrupted frames, accepted frames that were sent, and accepted frames that were never sent."""

    corrupted: int = 0
    accepted: int = 0
    undetected: int = 0

    def __add__(self, other: Self) -> "FrameCounts":
        return FrameCounts(
            self.corrupted + other.corrupted,
            self.accepted + other.accepted,
            self.undetected + other.undetected,
        )


class DamagingLine:
    """A line of firmware/host/proofs whose frames have this checksum."""

    def __init__(self, checksum: Checksum, model: str, seed: int) -> None:
        self._library = _load(checksum)
        self._line = self._library.corruption_create(*MODELS[model], seed)
        self.key = int(self._library.corruption_key(self._line))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._library.corruption_destroy(self._line)

    def batches(self, frames: int) -> Iterator[None]:
        """Make at least `frames` damaged frames, a batch at a time, to be read by `chip` and `host`."""
        for start in range(0, frames, BATCH):
            self._library.corruption_carry(self._line, min(BATCH, frames - start))
            yield

    def chip(self) -> FrameCounts:
        """Return the counts of the batch by the chip's decoder."""
        counts = (ctypes.c_uint32 * 3)()
        self._library.corruption_read(self._line, counts)
        return FrameCounts(*counts)

    def host(self) -> FrameCounts:
        """Return the counts of the same bytes by the host's decoder."""
        damaged = self._bytes("damaged")
        counts = FrameCounts(corrupted=sum(damaged) + int(self._library.corruption_foreign(self._line)))
        sent = [frame + b"\0" for frame in self._bytes("sent").split(b"\0")[:-1]]
        decoder = Decoder()
        decoder.key = self.key
        at = 0
        for frame in decoder.feed(self._bytes("line")):
            key = 0 if frame.open else self.key
            messages = b"".join(bytes([type_]) + payload for type_, payload in frame.messages)
            try:
                result = sent.index(
                    assemble(messages, frame.reliable, frame.number, frame.acknowledged, key), at
                )
            except ValueError:
                counts.undetected += 1
                continue
            counts.accepted += 1
            counts.corrupted -= damaged[result]
            at = result + 1
        return counts

    def _bytes(self, name: str) -> bytes:
        size = getattr(self._library, f"corruption_{name}_size")(self._line)
        return ctypes.string_at(getattr(self._library, f"corruption_{name}")(self._line), size)


def prepare() -> None:
    """Compile the lines."""
    build(ROOT / "firmware", "proofs")


def measure(end: End, model: str, frames: int, checksum: Checksum = "crc32", seed: int = 0) -> FrameCounts:
    """Return the counts of an end that reads at least `frames` damaged frames; the same for the same seed."""
    with DamagingLine(checksum, model, seed * len(MODELS) + list(MODELS).index(model)) as line:
        read: Callable[[], FrameCounts] = getattr(line, end)
        return sum((read() for _ in line.batches(frames)), FrameCounts())


def measure_all(frames: int) -> dict[tuple[End, str], FrameCounts]:
    """Return counts by end and model: each end reads at least `frames` damaged frames, equally of each."""
    prepare()
    share = -(-frames // len(MODELS) // BATCH) * BATCH
    with processes(2) as pool:
        futures = {model: pool.submit(_measure_both, model, share) for model in MODELS}
        return {(end, model): future.result()[end] for end in ENDS for model, future in futures.items()}


def _measure_both(model: str, frames: int) -> dict[End, FrameCounts]:
    with DamagingLine("crc32", model, list(MODELS).index(model)) as line:
        counts = {end: FrameCounts() for end in ENDS}
        for _ in line.batches(frames):
            counts["chip"] += line.chip()
            counts["host"] += line.host()
        return counts


def table(counts: Mapping[tuple[End, str], FrameCounts]) -> str:
    """Return a text table: undetected of corrupted frames, by model and end."""
    lines = [f"{'undetected of corrupted':<28}" + "".join(f"{end:>22}" for end in ENDS)]
    for model in MODELS:
        cells = (counts[end, model] for end in ENDS)
        lines.append(
            f"{model:<28}" + "".join(f"{f'{cell.undetected} of {cell.corrupted}':>22}" for cell in cells)
        )
    totals = (sum((count for (end, _), count in counts.items() if end == of), FrameCounts()) for of in ENDS)
    lines.append(
        f"{'all':<28}" + "".join(f"{f'{total.undetected} of {total.corrupted}':>22}" for total in totals)
    )
    return "\n".join(lines)


def _load(checksum: Checksum) -> ctypes.CDLL:
    library = ctypes.CDLL(str(ROOT / f"build/firmware/libcorruption_{checksum}.so"))
    pointer, number = ctypes.c_void_p, ctypes.c_uint32
    library.corruption_create.restype = pointer
    library.corruption_create.argtypes = [ctypes.c_uint8, ctypes.c_double, ctypes.c_uint64]
    library.corruption_destroy.argtypes = [pointer]
    library.corruption_carry.argtypes = [pointer, number]
    library.corruption_read.argtypes = [pointer, pointer]
    for name in ("line", "sent", "damaged"):
        getattr(library, f"corruption_{name}").restype = pointer
    for name in ("key", "line_size", "sent_size", "damaged_size", "foreign"):
        getattr(library, f"corruption_{name}").restype = number
    for name in (
        "key",
        "foreign",
        *(f"{it}{of}" for it in ("line", "sent", "damaged") for of in ("", "_size")),
    ):
        getattr(library, f"corruption_{name}").argtypes = [pointer]
    return library
