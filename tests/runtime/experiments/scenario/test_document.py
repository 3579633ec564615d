"""The scenario's document: the shipped ones are valid, and all errors are reported at once."""

from importlib.resources import files

import pytest

from robot_runtime.contract.commands import summary
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.vision_settings import COLOURS
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.events import (
    EVENTS,
    Colour,
    CommandEvent,
    LineFaultChange,
    WaterEvent,
)
from robot_runtime.experiments.scenario.library import SHIPPED, shipped_scenarios
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import StartPose, Trim

WHOLE = """
name = "whole"
title = "Everything that there is"
description = "For its test."
duration = 20
seed = 4294967295
[scene]
kind = "pool"
depth = 2.0
length = 6
width = 4.0
turbidity = 0.5
beacons = [[1, 2, 0.5]]
[[scene.targets]]
colour = "red"
position = [2.0, 0.0, 0.8]
[start]
north = -1.0
down = 0.5
heading = 1.57
[water]
current = { north = 0.1, turning = 0.01 }
waves = { amplitude = 0.05, period = 2, direction = 0.5 }
[trim]
buoyancy = 1.01
forward = 0.001
right = 0
above = 0.02
[robot]
mass = 3.2
damping_linear = [1, 2, 2, 0.005, 0.005, 0.005]
pressure = { noise = 10 }
[control]
rate = 20
controller = "pid"
set_point = 0.7
gains.pid.kp = 4
[vision]
camera = "scene"
rate = 10
colour = "red"
"""
BARE = """
name = "bare"
title = "What must be there"
duration = 20
[scene]
kind = "natural"
depth = 3
"""
ALL_EVENTS = {
    "arm": "",
    "stop": "",
    "acknowledge": "",
    "set_points": "detected = 1.5",
    "controller": "name = 'pid'\ngains = { kd = 1 }",
    "loop": "name = 'heading'\non = true\nset_point = 1.5\ncontroller = 'pid'\ngains = { kd = 1 }",
    "steering": "by = 'beacons'",
    "mode": "mode = 'manual'",
    "mission": "text = 'format = 1'",
    "mission_pause": "on = false",
    "mission_skip": "",
    "mission_end": "",
    "card": "colour = 'yellow'",
    "vision": "rate = 8",
    "beacons": "positions = []",
    "current": "north = 0.1",
    "waves": "amplitude = 0.02",
    "trim": "buoyancy = 1\nforward = 0\nright = 0\nabove = 0.01",
    "fault": "sensor = 'pressure'\nkind = 'dropout'\nshare = 0.5",
    "line": "direction = 'to_board'\nkind = 'burst'\nrate = 0.001\nlength = 20",
    "marker": "text = 'Here'",
}


def event(do: str, rest: str = "", at: float = 1) -> str:
    return f"[[events]]\nat = {at}\ndo = '{do}'\n{rest}\n"


def problems(text: str) -> list[str]:
    with pytest.raises(ConfigError) as refused:
        read_scenario(text)
    return refused.value.texts


def test_the_shipped_scenarios_are_valid() -> None:
    folder = files("robot_runtime.experiments.scenario") / "shipped"
    assert {f"{name}.toml" for name in SHIPPED} == {file.name for file in folder.iterdir()}
    read = {name: read_scenario(text) for name, text in shipped_scenarios().items()}
    assert {name: scenario.name for name, scenario in read.items()} == {name: name for name in SHIPPED}
    assert all(any(event.do == "arm" for event in scenario.events) for scenario in read.values())


def test_figure_14_is_the_thesis_evaluation() -> None:
    scenario = read_scenario(shipped_scenarios()["figure_14"])
    assert (scenario.control.controller, scenario.control.rate, scenario.vision.rate) == ("bang_bang", 10, 4)
    assert (scenario.control.set_point, scenario.control.set_point_detected) == (0.5, 1.0)


def test_every_entry_is_parsed() -> None:
    scenario = read_scenario(WHOLE + "".join(event(do, rest) for do, rest in ALL_EVENTS.items()))
    assert scenario.seed == 4294967295
    assert (scenario.scene.basin.length, scenario.scene.beacons) == (6.0, ((1.0, 2.0, 0.5),))
    assert (scenario.scene.targets[0].position, scenario.scene.targets[0].size) == ((2.0, 0.0, 0.8), 0.2)
    assert scenario.start == StartPose(north=-1.0, down=0.5, heading=1.57)
    assert scenario.water.current.turning == 0.01
    assert scenario.trim == Trim(1.01, 0.001, 0.0, 0.02)
    assert (scenario.robot.mass, scenario.robot.pressure.noise) == (3.2, 10)
    assert scenario.robot.pressure.walk == SimulationParameters().pressure.walk
    assert scenario.control.gains == {"pid": {"kp": 4.0}}
    assert {event.do for event in scenario.events} == EVENTS.keys() == ALL_EVENTS.keys()
    assert all(event.label for event in scenario.events)
    # A list of what happens says it in a few words, not as the manual does.
    commands = [event.command for event in scenario.events if isinstance(event, CommandEvent)]
    assert [command.label for command in commands if command.label == summary(type(command))] == []


def test_mistakes_of_the_board_are_checked_by_name() -> None:
    whole = read_scenario('mistakes = ["imu-strap", "leads-reversed:back-left"]\n' + BARE)
    assert whole.mistakes == ("imu-strap", "leads-reversed:back-left")
    with pytest.raises(ConfigError) as refusal:
        read_scenario('mistakes = ["imu-strap", "leads-reversed:left", "none"]\n' + BARE)
    (first, second) = refusal.value.problems
    assert (first.path, second.path) == (("mistakes", 1), ("mistakes", 2))
    assert "is written leads-reversed:FIN" in first.text
    assert "there is no mistake 'none'" in second.text


def test_missing_entries_get_the_robot_s_defaults() -> None:
    scenario = read_scenario(BARE)
    assert (scenario.robot, scenario.trim, scenario.start.down) == (SimulationParameters(), None, None)
    assert (scenario.scene.beacons, scenario.water.waves.amplitude, scenario.events) == ((), 0, ())


def test_events_come_in_order_of_time_and_those_of_one_moment_as_written() -> None:
    text = (
        BARE
        + event("stop", at=5)
        + event("arm", at=2)
        + event("card", "colour = 'red'", 2)
        + event("card", at=2)
    )
    assert [(event.at, event.do) for event in read_scenario(text).events] == [
        (2, "arm"),
        (2, "card"),
        (2, "card"),
        (5, "stop"),
    ]
    cards = [
        event
        for event in read_scenario(text).events
        if isinstance(event, CommandEvent) and event.do == "card"
    ]
    assert [card.command.payload() for card in cards] == [{"colour": "red"}, {}]


@pytest.mark.parametrize(
    ("rest", "command"),
    [
        ("kind = 'bit_errors'\nrate = 1e-4", "line from_board bit_errors 0.0001"),
        ("kind = 'burst'\nrate = 0.001\nlength = 20", "line from_board burst 0.001 20"),
        ("kind = 'stall'\nseconds = 2", "line from_board stall 2"),
        ("kind = 'cut'\non = true", "line from_board cut on"),
        ("kind = 'cut'\non = false", "line from_board cut off"),
        ("kind = 'clean'", "line from_board clean"),
    ],
)
def test_a_line_event_is_the_emulated_boards_command(rest: str, command: str) -> None:
    (line,) = read_scenario(BARE + event("line", f"direction = 'from_board'\n{rest}")).events
    assert isinstance(line, LineFaultChange)
    assert line.command == command


def test_questions_are_those_of_the_simulator() -> None:
    text = BARE + event("waves", "amplitude = 0.1\nperiod = 3") + event("fault", ALL_EVENTS["fault"])
    waves, fault = read_scenario(text).events
    assert isinstance(waves, WaterEvent)
    assert isinstance(fault, WaterEvent)
    assert waves.question == {"amplitude": 0.1, "period": 3.0, "direction": 0.0}
    assert fault.question == {"sensor": "pressure", "kind": "dropout", "share": 0.5}


def test_cards_have_the_colours_that_the_vision_node_knows() -> None:
    assert set(Colour.__args__) == set(COLOURS)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("name = [", "the scenario is not TOML: "),
        (BARE.replace("[scene]", "[sea]"), "'sea' is not known here; known are name, title, "),
        (BARE.replace("[scene]", "[sea]"), "scene is missing"),
        (BARE.replace("duration = 20", ""), "duration is missing"),
        (BARE.replace("duration = 20", "duration = 0"), "duration is 0; it must lie between 1 and 3600"),
        (BARE.replace("duration = 20", "duration = '20'"), "duration is '20'; it must be a number"),
        (BARE.replace('"bare"', '"../bare"'), "name is '../bare'; it is 1 to 60 small letters, "),
        (BARE.replace("What must be there", " "), "title must be a text of 1 to 100 characters"),
        ("seed = 1.5\n" + BARE, "seed is 1.5; it must be a whole number"),
        ("seed = -1\n" + BARE, "seed is -1; it must lie between 0 and 4294967295"),
        (BARE.replace("depth = 3", ""), "scene: depth is missing"),
        (
            BARE.replace("depth = 3", "depth = -3"),
            "scene: the water's depth is -3 m; it must be between 0.5 ",
        ),
        (BARE.replace('"natural"', '"lake"'), "scene: kind is 'lake'; it must be one of 'pool', 'natural'"),
        (BARE.replace('"natural"', '"pool"'), "scene: a pool has length and width, natural water neither"),
        (BARE + "beacons = [[1, 2]]", "scene: beacons[0] is [1, 2]; it must be a list of 3 numbers"),
        (BARE + "beacons = [[1, 2, 'x']]", "scene: beacons[0][2] is 'x'; it must be a number"),
        (BARE + "[start]\ndown = 3", "start: a start at 3 m is in the floor, which is at 3 m"),
        (
            WHOLE.replace("north = -1.0", "north = -2.9"),
            "start: a start -2.9 m north is in a wall, which is at 3",
        ),
        (
            BARE + "[water]\ncurrent = { north = 3 }",
            "water: current: a current must be finite and at most 2 m/s",
        ),
        (
            BARE + "[water]\nwaves = { amplitude = 1 }",
            "water: waves: waves of 1 m amplitude and 2 s period break",
        ),
        (
            BARE + "[trim]\nbuoyancy = 2\nforward=0\nright=0\nabove=0",
            "trim: buoyancy is 2 times the weight; ",
        ),
        (BARE + "[robot]\nmass = -3", "robot: mass is -3; it must lie between 0.75 and 12"),
        (BARE + "[robot]\nmass = 100", "robot: mass is 100; it must lie between 0.75 and 12"),
        (BARE + "[robot]\nmass = nan", "robot: mass is nan; it must be a number"),
        (BARE + "[robot]\nbouyancy = 1", "robot: 'bouyancy' is not known here; known are mass, "),
        (BARE + "[robot]\nfloor = 2", "robot: floor belongs to [scene] depth"),
        (
            BARE + "[robot]\nadded_mass = [1, 1, 99, 0.004, 0.012, 0.01]",
            "robot: added_mass[2] is 99; it must lie",
        ),
        (
            BARE + "[robot]\npressure = { noise = -1 }",
            "robot: pressure: a sensor's noise is -1.0; it must not be",
        ),
        (
            BARE + "[robot]\npressure = { latency = 9 }",
            "robot: pressure.latency is 9; it must lie between 0 and 5",
        ),
        (BARE + "[control]\ncontroller = 'p'", "control: there is no controller 'p'; there are bang_bang, "),
        (BARE + "[control]\ngains.pid.kq = 1", "control: PID has no gain 'kq'; it has kp, ki, kd"),
        (BARE + "[control]\nset_point = 11", "control: set_point is 11; it must lie between 0 and 10"),
        (BARE + "[vision]\ncolour = 'pink'", "vision: colour is 'pink'; it must be one of 'red', "),
        ("events = 3\n" + BARE, "events must be tables, each headed [[events]]"),
        ("events = [3]\n" + BARE, "event 1 must be a table"),
        (BARE + "[[events]]\nat = 1", "event 1: do is missing; it must be one of arm, stop, "),
        (BARE + event("fly"), "event 1: do is 'fly'; it must be one of arm, stop, "),
        (BARE + event("arm", "now = true"), "event 1: 'now' is not known here; known are at, mode, alone"),
        (BARE + event("arm", at=-1), "event 1: at is -1; it must lie between 0 and 3600"),
        (BARE + event("arm", at=20.5), "event arm at 20.5 s comes after the end; the scenario lasts 20 s"),
        (BARE + event("set_points"), "event 1: set_points needs default, detected or both"),
        (BARE + event("vision"), "event 1: vision needs rate, colour or both"),
        (BARE + event("card", "colour = 'pink'"), "event 1: colour is 'pink'; it must be one of 'red', "),
        (
            BARE + event("loop", "name = 'pitch'\nset_point = 0.6"),
            "event 1: set_point must lie between -28.6° (-0.5 rad) and 28.6° (0.5 rad)",
        ),
        (BARE + event("loop", "name = 'roll'"), "event 1: loop needs on, set_point, controller or gains"),
        (
            BARE + event("loop", "name = 'roll'\non = true\ngains = { ki = 1 }"),
            "event 1: gains need the name of their controller",
        ),
        (
            BARE + event("controller", "name = 'x'"),
            "event 1: there is no controller 'x'; there are bang_bang, ",
        ),
        (BARE + event("beacons", "positions = [[0, 0, 2000]]"), "event 1: a beacon's down is 2000 m; "),
        (
            BARE + event("current", "north = 2\neast = 2"),
            "event 1: a current must be finite and at most 2 m/s",
        ),
        (BARE + event("waves", "amplitude = 1"), "event at 1 s: waves of 1 m amplitude and 2 s period break"),
        (BARE + event("waves"), "event 1: amplitude is missing"),
        (BARE + event("fault", "sensor = 'sonar'\nkind = 'stuck'"), "event 1: there is no sensor 'sonar'; "),
        (BARE + event("fault", "sensor = 'battery'\nkind = 'drift'"), "event 1: the fault drift takes speed"),
        (
            BARE + event("line", "direction = 'up'\nkind = 'clean'"),
            "event 1: direction is 'up'; it must be one of",
        ),
        (BARE + event("line", "direction = 'to_board'\nkind = 'cut'"), "event 1: a line's cut takes on"),
        (BARE + event("line", "direction = 'to_board'\nkind = 'clean'\nrate = 0.1"), "takes nothing more"),
        (BARE + event("marker", "text = ''"), "event 1: a marker's text has 1 to 200 characters"),
        ("#" * 60_001, "the scenario is larger than 60000 bytes"),
    ],
)
def test_errors_are_named(text: str, problem: str) -> None:
    assert any(problem in item for item in problems(text)), problems(text)


def test_all_problems_are_reported_together() -> None:
    text = (
        BARE.replace("duration = 20", "duration = 2")
        .replace('"bare"', '"B"')
        .replace("depth = 3", "deep = 3")
    )
    text += "[robot]\nmass = -1\n" + event("arm", at=3) + event("fly") + event("marker", "text = ''")
    result = problems(text)
    for word in ("name is", "scene: 'deep'", "scene: depth", "mass", "arm at 3 s", "event 2", "event 3"):
        assert sum(word in problem for problem in result) == 1, (word, result)


@pytest.mark.parametrize("text", ["a = " + "[" * 5000, "\x00", 'name = "\\ud800"'])
def test_invalid_documents_are_refused_with_the_reason(text: str) -> None:
    assert problems(text)[0].startswith("the scenario is not TOML")
