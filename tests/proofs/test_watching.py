"""The silence of a line, found in what was seen at the emulated board."""

from tests.proofs.watching import SILENCE, FinSight, find_silence

APART = SILENCE / 5


def looks(heard: list[float], rate: float) -> list[FinSight]:
    """Return the chip's received bytes at each look; the board's time passes at this rate."""
    times = [10 + APART * number for number in range(len(heard))]
    return [
        FinSight(time, time * rate, moving=False, powered=True, heard=packet)
        for time, packet in zip(times, heard, strict=True)
    ]


def test_a_silence_begins_with_the_last_byte_that_came_late() -> None:
    seen = looks([1, 2, 3, 4, *[5] * 10], 1.0)
    assert find_silence(seen, seen[1].time) == seen[4].time


def test_where_the_next_runtime_s_bytes_come_before_a_silence_all_counts_from_the_fault() -> None:
    seen = looks([*[5] * 8, *range(6, 20)], 0.5)
    assert find_silence(seen, seen[1].time) == seen[1].time
