"""Corrupted frames that the chip's decoder and the host's accept."""

from tests.proofs.corruption import FrameCounts, measure_all

_FRAMES = 10_500_000


def measure() -> dict[str, float]:
    """Return the corrupted frames of both decoders together, and the accepted ones."""
    counts = sum(measure_all(_FRAMES).values(), FrameCounts())
    return {
        "link.corrupted_frames": counts.corrupted,
        "link.undetected_corruptions": counts.undetected,
    }
