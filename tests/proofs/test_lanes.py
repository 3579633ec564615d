"""A short version of the lanes of `make missions`."""

import pytest

from tests.board.rig import ROOT, build
from tests.proofs.lanes import CRAFT_ERROR, SPACING, TOLERANCE, survey


@pytest.mark.parametrize("seed", [1, 2])
def test_the_lanes_lie_apart_as_planned_and_the_way_is_as_uncertain_as_it_says(seed: int) -> None:
    build(ROOT / "firmware", "host")
    lanes = survey(seed, CRAFT_ERROR)
    assert lanes.spacings == pytest.approx([SPACING] * 2, abs=TOLERANCE * SPACING)
    assert lanes.covered >= 0.95
    # Not by deviations that are too large to say anything.
    assert lanes.spread > 0.4
