"""The runner of missions, tick by tick, without a board."""

import pytest

from robot_runtime.contract.vision_settings import VisionSettings
from tests.runtime.missions.mission_rig import MissionRig
from tests.runtime.missions.water import HOLD, mission


def test_a_stop_between_two_ticks_ends_it_though_the_robot_is_armed_again() -> None:
    rig = MissionRig()
    rig.prepare(mission(HOLD))
    rig.tick(0.5)
    assert rig.last.phase == "running"
    rig.runner.change_mode("disarmed")
    rig.runner.change_mode("automatic")
    rig.tick()
    assert (rig.last.phase, rig.last.text) == ("ended", "The robot was stopped.")
    assert not rig.runner.active
    assert rig.stops == []
    rig.prepare(mission(HOLD))
    rig.tick()
    assert (rig.last.number, rig.last.phase) == (2, "running")


AGAIN = """{ do = 'repeat', times = 2, steps = [
  { do = 'dive', depth = 0.6, timeout = 3 },
  { do = 'wait_for', sees = 'yellow', timeout = 40 },
  { do = 'until', timeout = 40, steps = [
    { do = 'invert', steps = [{ do = 'is', sees = 'yellow' }] }, { do = 'hold', seconds = 1 }] }] }"""
"""As in the shipped `follow_colour`."""


def _second_round(rig: MissionRig) -> None:
    rig.senses.look = lambda _: rig.clock.now() % 8 < 4
    rig.prepare(mission(AGAIN))
    while not (rig.documents and rig.last.steps[1].rounds):
        rig.tick()


def test_the_steps_of_a_repetition_have_not_begun_again() -> None:
    rig = MissionRig()
    _second_round(rig)
    rig.tick()
    done = {step.path: step.status for step in rig.last.steps if step.status != "waiting"}
    assert done == {"": "running", "1": "running", "1.1": "running"}


def test_a_failure_in_a_second_round_names_its_step() -> None:
    rig = MissionRig()
    _second_round(rig)
    rig.senses.measured = 0.0
    while rig.runner.active:
        rig.tick()
    assert rig.last.text == "Step 1.1, dive to 0.6 m: After 3 s it was at 0.00 m, not at 0.6 m."


UNSEEN = "{ do = 'wait_for', sees = 'red', timeout = 1 }"


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        (
            mission(
                f"{{ do = 'try', steps = [{UNSEEN}] }}",
                "{ do = 'invert', steps = [{ do = 'is', above = 1 }] }",
            ),
            "Step 2, not: Its step succeeded.",
        ),
        (
            mission(
                f"{{ do = 'first_of', steps = [{UNSEEN}, {HOLD}] }}",
                f"{{ do = 'all', steps = [{HOLD}, {UNSEEN}] }}",
            ),
            "Step 2.2, wait for red: It saw no red for 1 s.",
        ),
        (
            mission("{ do = 'hold', seconds = 60 }", do="timeout").replace(
                "[mission]", "[mission]\nseconds = 5"
            ),
            "The mission: It was not done after 5 s.",
        ),
    ],
    ids=["a try", "a first_of", "the mission itself"],
)
def test_the_step_by_which_it_failed_is_named(text: str, answer: str) -> None:
    assert MissionRig().swim(text).text == answer


def test_progress_is_steady_over_the_rounds_of_a_repetition() -> None:
    rig = MissionRig()
    rig.swim(mission("{ do = 'repeat', times = 4, steps = [{ do = 'hold', seconds = 2 }] }"))
    progress = [document.progress for document in rig.documents]
    assert progress == sorted(progress)
    assert progress[-2] < 1.0


def test_what_failed_in_a_first_of_stays_failed_while_the_next_one_runs() -> None:
    rig = MissionRig()
    lost = f"{{ do = 'sequence', steps = [{UNSEEN}] }}"
    choice = f"{{ do = 'first_of', steps = [{lost}, {lost}, {HOLD}] }}"
    rig.prepare(mission(f"{{ do = 'repeat', times = 2, steps = [{choice}] }}"))
    states = dict.fromkeys(("1.1.1.1", "1.1.2.1", "1.1.3"), "")
    seen = []
    while rig.runner.active:
        rig.tick()
        if (now := {path: rig.status(path) for path in states}) != states:
            states = now
            seen.append(tuple(now.values()))
    lines = [
        ("running", "waiting", "waiting"),
        ("failed", "running", "waiting"),
        ("failed", "failed", "running"),
        ("failed", "failed", "done"),
    ]
    assert seen == [*lines, *lines]
    progress = [document.progress for document in rig.documents]
    assert progress == sorted(progress)


def test_a_marker_beyond_its_dictionary_is_refused() -> None:
    rig = MissionRig()
    rig.core.set_vision(VisionSettings(markers="4x4_50"))
    assert rig.senses.check_sight("marker 49") == ""
    answer = "There is no marker 50 in the dictionary 4x4_50; its last is marker 49."
    assert rig.senses.check_sight("marker 50") == answer
