from typing import Any

import pytest
from pydantic import ValidationError

from server.driving.drive_filter import LATE_SECONDS
from tests.server.driving.people import ANNA, BEN, ArbiterRig


def test_driving_commands_reach_the_robot() -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(ANNA) as anna:
        seen.arbiter.take(anna)
        seen.arbiter.drive(anna, seen.drive(sequence=0))
        seen.arbiter.drive(anna, seen.drive(sequence=5, axes=[-1, 1, 0, 0.5, 0, 0]))
        assert seen.driven == [
            {"lease": 1_000_001, "sequence": 0, "taken": 1000.0, "axes": [0, 0, 1, 0, 0, 0]},
            {"lease": 1_000_001, "sequence": 5, "taken": 1000.0, "axes": [-1, 1, 0, 0.5, 0, 0]},
        ]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"lease": 1_000_000}, "other_lease"),
        ({"lease": 1_000_002}, "other_lease"),
        ({"sequence": 8}, "not_newer"),
        ({"sequence": 7}, "not_newer"),
        ({"taken": 1000.0 - LATE_SECONDS - 0.001}, "too_old"),
        ({"taken": 1000.0 + LATE_SECONDS + 0.001}, "from_the_future"),
    ],
)
def test_stale_or_foreign_driving_commands_are_dropped_and_counted(changes: Any, reason: str) -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(ANNA) as anna:
        seen.arbiter.take(anna)
        seen.arbiter.drive(anna, seen.drive(sequence=8))
        seen.arbiter.drive(anna, seen.drive(**{"sequence": 9} | changes))
        assert len(seen.driven) == 1
        counts = seen.arbiter.driving.counts.model_dump()
        assert {name: count for name, count in counts.items() if count} == {"passed": 1, reason: 1}
        # A dropped command does not raise the newest number.
        seen.arbiter.drive(anna, seen.drive(sequence=9))
        assert len(seen.driven) == 2


def test_only_the_holder_drives_and_its_first_number_is_free() -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(ANNA) as anna, seen.arbiter.page(BEN) as ben:
        seen.arbiter.drive(anna, seen.drive())
        seen.arbiter.take(anna)
        seen.arbiter.drive(ben, seen.drive())
        assert (seen.driven, seen.arbiter.driving.counts.not_in_control) == ([], 2)
        seen.arbiter.drive(anna, seen.drive(sequence=900))
        seen.arbiter.take(ben, over=True)
        seen.arbiter.drive(anna, seen.drive(sequence=901))
        seen.arbiter.drive(ben, seen.drive(sequence=0))
        assert [command["sequence"] for command in seen.driven] == [900, 0]


@pytest.mark.parametrize(
    "changes",
    [
        {"axes": [0, 0, 0, 0, 0]},
        {"axes": [0, 0, 0, 0, 0, 0, 0]},
        {"axes": [0, 0, 0, 0, 0, 1.001]},
        {"axes": [0, 0, 0, 0, 0, float("nan")]},
        {"axes": [0, 0, 0, 0, 0, float("inf")]},
        {"axes": [0, 0, 0, 0, 0, 10**400]},
        {"axes": [0, 0, 0, 0, 0, True]},
        {"axes": [0, 0, 0, 0, 0, "1"]},
        {"axes": None},
        {"lease": "1"},
        {"lease": 1.5},
        {"lease": -1},
        {"lease": True},
        {"sequence": None},
        {"sequence": 2**53 + 1},
        {"taken": float("inf")},
        {"taken": "now"},
        {"taken": 10**400},
    ],
)
def test_invalid_bytes_are_no_driving_command(changes: Any) -> None:
    with pytest.raises(ValidationError):
        ArbiterRig().drive(**changes)
