"""Corrupted frames through the chip's decoder and the host's: how many were believed."""

from tests.proofs.corruption import Counts, measure_all

_FRAMES = 10_500_000


def measure() -> dict[str, float]:
    """Frames that were corrupted on both ways together, and those of them that were believed."""
    counts = sum(measure_all(_FRAMES).values(), Counts())
    return {
        "link.corrupted_frames": counts.corrupted,
        "link.undetected_corruptions": counts.undetected,
    }
