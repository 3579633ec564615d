import pytest

from server.library.content import depth_loop

HEADING = {"name": "heading", "set_point": 1.0, "controller": "tilt", "controllers": []}
DEPTH = {"name": "depth", "set_point": 0.7, "controller": "pid", "controllers": []}


@pytest.mark.parametrize(
    "state",
    [
        {"mode": "disarmed", "loops": [DEPTH, HEADING]},
        # Version 0.1.0 had the depth loop's fields twice, and the first versions had no loops.
        {"mode": "disarmed", "set_point": 0.7, "controller": "pid", "loops": [DEPTH, HEADING]},
        {"mode": "disarmed", "set_point": 0.7, "controller": "pid"},
    ],
)
def test_the_depth_loop_is_found_in_states_of_every_version(state: dict[str, object]) -> None:
    loop = depth_loop(state)
    assert (loop["set_point"], loop["controller"]) == (0.7, "pid")


def test_a_session_without_a_state_has_no_depth_loop() -> None:
    assert depth_loop({}) == {}
