"""The rules of missions, in simulated time and with the robot's own firmware."""

import pytest

from robot_runtime.contract.packets import StatusFlag
from tests.runtime.experiments.scenario.staging import document, perform
from tests.runtime.missions.water import DIVE, HOLD, begin, end_of, is_at_rest, mission, statuses, swim

SURFACE = "{ do = 'surface' }"
SETS = "{ do = 'set', parameter = 'depth.pid.kp', value = 4.5 }"
FLAT = 'at = 5; do = "fault"; sensor = "battery"; kind = "drift"; speed = -0.5'


def test_a_mission_dives_holds_and_ends_with_stop() -> None:
    report = swim(40, mission(DIVE, HOLD, SURFACE))
    last = end_of(report)
    assert (last["phase"], last["text"], last["progress"]) == ("succeeded", "It is done.", 1.0)
    assert statuses(last) == {"": "done", "1": "done", "2": "done", "3": "done"}
    assert 0.5 < last["deepest"] < 0.75
    held = [sample.depth for sample in report.between("depth", last["time"] - 7, last["time"])]
    assert max(abs(depth - 0.6) for depth in held) < 0.15
    assert is_at_rest(report, last["time"] + 0.2)
    assert report.rows["depth"][-1][1].depth < 0.45
    assert report.documents["state"][-1]["mode"] == "disarmed"
    first = report.documents["mission"][0]
    assert first["document"] == last["document"] == mission(DIVE, HOLD, SURFACE)
    assert [document["sequence"] for document in report.documents["mission"]] == list(
        range(len(report.documents["mission"]))
    )


def test_the_same_document_and_seed_give_the_same_bytes() -> None:
    text = mission(DIVE, SURFACE)
    assert swim(12, text).bytes == swim(12, text).bytes
    assert swim(12, text).bytes != swim(12, text, seed=8).bytes


def test_a_refusal_names_all_reasons_and_arms_nothing() -> None:
    text = mission(
        "{ do = 'wait_for', sees = 'marker 3' }",
        "{ do = 'set', parameter = 'depth.pid.kp', value = 1e6 }",
        "{ do = 'set', parameter = 'nothing', value = 1 }",
        "{ do = 'is', sees = 'pink' }",
        DIVE,
    )
    report = swim(3, text, 'at = 0.5; do = "fault"; sensor = "pressure"; kind = "bus"')
    answer = report.ended["problem"]
    for message in (
        "Step 1: The camera looks for no markers.",
        "Step 2: depth.pid.kp is 1e+06; it must lie between",
        "Step 3: There is no parameter 'nothing'.",
        "Step 4: Nothing is called 'pink'",
        "The pressure sensor does not answer.",
    ):
        assert message in answer
    assert "mission" not in report.documents
    assert not any(status.flags & StatusFlag.ARMED for _, status in report.rows["status"])


def test_a_mission_needs_a_disarmed_robot_and_refuses_a_second_one() -> None:
    armed = perform(document(4, 'at = 0.5; do = "arm"', begin(mission(DIVE), at=2)))
    assert "The robot is armed already." in armed.ended["problem"]
    twice = swim(6, mission(DIVE, HOLD), begin(mission(DIVE), at=4))
    assert "A mission runs." in twice.ended["problem"]


@pytest.mark.parametrize(
    "command",
    [
        'do = "set_points"; default = 1.0',
        'do = "controller"; name = "bang_bang"',
        'do = "loop"; name = "heading"; on = true',
        'do = "steering"; by = "beacons"',
        'do = "vision"; rate = 5',
    ],
)
def test_nothing_else_tunes_the_robot_meanwhile(command: str) -> None:
    report = swim(5, mission(DIVE), f"at = 3; {command}")
    assert "A mission runs. Wait for its end, or end it first." in report.ended["problem"]


def test_what_it_sets_is_put_back_at_every_end() -> None:
    text = mission(SETS, DIVE, HOLD)
    ends = {
        "stop": 'at = 6; do = "stop"',
        "end": 'at = 6; do = "mission_end"',
        "fault": 'at = 6; do = "fault"; sensor = "pressure"; kind = "bus"',
        "done": "",
    }
    for name, event in ends.items():
        report = swim(25, text, *([event] if event else []))
        kp = [
            {parameter["name"]: parameter["value"] for parameter in document["parameters"]}["depth.pid.kp"]
            for document in report.documents["parameters"]
        ]
        assert 4.5 in kp, name
        assert kp[-1] == 3.0, name


def test_stop_ends_it_for_good() -> None:
    report = swim(12, mission(DIVE, HOLD), 'at = 5; do = "stop"', 'at = 8; do = "arm"')
    last = end_of(report)
    assert (last["phase"], last["text"]) == ("ended", "The robot was stopped.")
    assert last["time"] == pytest.approx(5.0, abs=0.2)
    assert statuses(last)["1"] == "stopped"
    assert report.texts("event").count("Armed.") == 2
    assert len([document for document in report.documents["mission"] if document["time"] > 5.3]) == 0


def test_a_failsafe_ends_it() -> None:
    report = swim(12, mission(DIVE, HOLD), 'at = 5; do = "fault"; sensor = "pressure"; kind = "bus"')
    last = end_of(report)
    assert last["phase"] == "ended"
    assert last["text"] == "The robot was stopped for a fault; see its alarms."
    assert is_at_rest(report, last["time"] + 0.2)


def test_a_pause_stops_its_clocks_and_holds_the_depth() -> None:
    text = mission(DIVE, "{ do = 'hold', seconds = 4 }")
    plain = end_of(swim(30, text))
    report = swim(30, text, 'at = 8; do = "mission_pause"', 'at = 14; do = "mission_pause"; on = false')
    last = end_of(report)
    assert last["phase"] == "succeeded"
    assert last["paused"] == pytest.approx(6.0, abs=0.25)
    assert last["elapsed"] == pytest.approx(plain["elapsed"], abs=0.25)
    assert all(abs(sample.depth - 0.6) < 0.15 for sample in report.between("depth", 9, 14))


def test_a_pause_that_lasts_too_long_ends_it() -> None:
    report = swim(40, mission(DIVE, HOLD), 'at = 5; do = "mission_pause"')
    last = end_of(report)
    assert (last["phase"], last["text"]) == ("failed", "It was paused for longer than 20 s.")
    assert last["time"] == pytest.approx(25.1, abs=0.4)
    assert is_at_rest(report, last["time"] + 0.2)


def test_taking_over_pauses_it_and_handing_back_goes_on() -> None:
    report = swim(
        30,
        mission(DIVE, HOLD),
        'at = 6; do = "mode"; mode = "manual"',
        'at = 8; do = "mode"; mode = "automatic"',
    )
    phases = [document["phase"] for document in report.documents["mission"]]
    assert "paused" in phases
    last = end_of(report)
    assert last["phase"] == "succeeded"
    assert last["paused"] == pytest.approx(2.0, abs=0.25)


def test_skip_ends_the_running_step_as_a_success() -> None:
    report = swim(
        20,
        mission("{ do = 'hold', seconds = 100, within = 5 }", "{ do = 'mark', text = 'after' }"),
        'at = 5; do = "mission_skip"',
    )
    last = end_of(report)
    assert last["phase"] == "succeeded"
    assert last["steps"][1]["text"] == "It was skipped."
    assert last["elapsed"] == pytest.approx(4.0, abs=0.4)
    assert "after" in report.texts("event")


@pytest.mark.parametrize(
    ("limits", "events", "message"),
    [
        ("depth = 0.62\ntime = 100", (), "below its limit of 0.62 m"),
        (
            "depth = 2.0\ntime = 100\nbattery = 6.9",
            (FLAT,),
            "its limit is 6.9 V",
        ),
    ],
)
def test_its_limits_end_it_beside_the_tree(limits: str, events: tuple[str, ...], message: str) -> None:
    text = mission("{ do = 'dive', depth = 0.6, timeout = 30, within = 0.01 }", HOLD, HOLD, limits=limits)
    report = swim(60, text, *events)
    last = end_of(report)
    assert last["phase"] == "failed"
    assert message in last["text"]
    assert is_at_rest(report, last["time"] + 0.2)


def test_a_failed_step_is_named_with_its_reason() -> None:
    report = swim(20, mission(DIVE, "{ do = 'wait_for', sees = 'red', timeout = 3 }"))
    last = end_of(report)
    assert last["text"] == "Step 2, wait for red: It saw no red for 3 s."
    assert statuses(last) == {"": "failed", "1": "done", "2": "failed"}
