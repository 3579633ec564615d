"""A short version of the corrupted frames of `make soak`; weaker checksums fail it."""

from functools import reduce
from operator import xor

import pytest

from robot_runtime.link import framing
from tests.proofs.corruption import ENDS, MODELS, End, measure, prepare

FRAMES = 4000


@pytest.fixture(scope="module", autouse=True)
def built() -> None:
    prepare()


@pytest.mark.parametrize("model", MODELS)
def test_neither_end_accepts_a_corruption(model: str) -> None:
    chip, host = (measure(end, model, FRAMES) for end in ENDS)
    assert chip == host
    assert chip.undetected == 0
    assert chip.corrupted > 0.98 * FRAMES
    # Whole frames are accepted, so the decoders work.
    assert chip.accepted > 0.2 * FRAMES


@pytest.mark.parametrize("end", ENDS)
def test_the_checksum_of_the_thesis_lets_corruptions_pass(end: End, monkeypatch: pytest.MonkeyPatch) -> None:
    def xor8(data: bytes) -> int:
        return reduce(xor, data, 0)

    monkeypatch.setattr(framing, "crc32", xor8)
    monkeypatch.setattr(framing, "_OPEN_RESIDUE", 0)
    counts = measure(end, "doubled bytes", FRAMES, "xor8")
    assert counts.undetected > 0.02 * FRAMES


def test_crc16_lets_corruptions_pass() -> None:
    assert measure("chip", "wrong checksum", 300_000, "crc16").undetected > 0
