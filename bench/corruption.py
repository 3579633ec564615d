"""Corrupted frames that the chip's decoder and the host's accept."""

from tests.proofs.corruption import Counts, measure_all

_FRAMES = 10_500_000


def measure() -> dict[str, float]:
    """Corrupted frames of both decoders together, and those that were accepted."""
    counts = sum(measure_all(_FRAMES).values(), Counts())
    return {
        "link.corrupted_frames": counts.corrupted,
        "link.undetected_corruptions": counts.undetected,
    }
