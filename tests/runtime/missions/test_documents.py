"""A mission's document: the shipped ones are valid; all problems are told at once, each by its place."""

import pytest

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import LEVELS_MAX, NODES_MAX, MissionLimits
from robot_runtime.missions.document import called_by, read_mission
from robot_runtime.missions.leaf import NODES, Leaf
from robot_runtime.missions.library import SHIPPED, shipped_missions
from tests.documents.blocks import read_blocks
from tests.runtime.missions.water import DIVE, HEAD, HOLD, mission


def problems(text: str, library: dict[str, str] | None = None, **limits: float) -> list[str]:
    """Return the problems of a text; it must have some."""
    with pytest.raises(ConfigError) as refused:
        read_mission(text, library, MissionLimits(**limits))
    return refused.value.texts


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_missions_are_valid_under_their_name(name: str) -> None:
    read = read_mission(shipped_missions()[name])
    assert read.name == name
    assert read.title
    assert read.longest <= read.limits.time


def test_the_missions_of_the_help_are_valid() -> None:
    texts = [block.text for block in read_blocks("use/missions.md") if block.language == "toml"]
    assert [read_mission(text).name for text in texts] == ["look_east"]


def test_every_problem_is_told_with_its_place() -> None:
    text = mission(
        "{ do = 'dive', depth = 11, timeout = 30 }",
        "{ do = 'fly' }",
        "{ do = 'repeat', times = 2, steps = [{ do = 'turn' }, { do = 'hold', seconds = 1e9, x = 2 }] }",
        "{ do = 'all', steps = [{ do = 'dive', depth = 1 }, { do = 'sequence', steps = [" + HOLD + "] }] }",
        "{ do = 'until', timeout = 9, steps = [" + HOLD + ", { do = 'is', below = 1 }] }",
        "{ do = 'while_true', steps = [{ do = 'is', below = 1 }] }",
        "7",
    )
    text = text.replace('name = "test"', 'name = "T est"').replace("time = 200", "time = 9000")
    report = problems(text)
    assert report[0].startswith("name is 'T est'")
    assert report[1] == "limits: time is 9000; it must lie between 1 and 3600"
    assert report[2] == "step 1: depth is 11; it must lie between 0 and 10"
    assert report[3].startswith("step 2: do is 'fly'; it must be one of ")
    assert report[4] == "step 3.1: needs heading or by, one of the two"
    assert report[5].startswith("step 3.2: 'x' is not known here")
    assert report[6] == "step 3.2: seconds is 1000000000.0; it must lie between 0.1 and 3600"
    assert report[7] == "step 4: steps 4.1 and 4.2 would both steer the depth, side by side"
    assert report[8] == "step 5: its first step must be a condition (is)"
    assert report[9] == "step 6: steps has 1; while_true needs 2 at least"
    assert report[10] == "step 7 must be a table"
    assert len(report) == 11


def test_a_document_only_tightens_the_robots_limits() -> None:
    text = mission(DIVE, limits="depth = 2.0\ntime = 100", head=HEAD.replace("alone = 0", "alone = 99"))
    assert problems(text, depth=1.5, time=50.0, alone=60.0) == [
        "alone is 99 s; robot.toml allows 60 s ([missions] alone)",
        "limits.depth is 2 m; robot.toml allows 1.5 m ([missions] depth, [control] deepest)",
        "limits.time is 100 s; robot.toml allows 50 s ([missions] time)",
    ]
    assert read_mission(text).limits.depth == 2.0
    assert read_mission(mission(DIVE, limits="time = 50"), None, MissionLimits(depth=1.5)).limits.depth == 1.5
    loose = mission(DIVE, limits="battery = 6.0\nunwatched = 0")
    assert problems(loose, battery=6.5, unwatched=30.0) == [
        "limits.battery is 6 V; robot.toml allows 6.5 V ([missions] battery)",
        "limits.unwatched is 0 s; robot.toml allows 30 s ([missions] unwatched)",
    ]


def test_the_depth_and_the_longest_time_must_fit_the_limits() -> None:
    steps = "{ do = 'repeat', times = 5, steps = [" + HOLD + "] }"
    report = problems(mission(DIVE, steps, limits="depth = 0.5\ntime = 60"))
    assert report == [
        "step 1 goes to 0.6 m, and the depth is limited to 0.5 m",
        "mission may take 71 s, and limits.time is 60 s; shorten its timeouts and repetitions",
    ]


def test_calls_are_read_from_the_library_and_circles_are_refused() -> None:
    def call(name: str, own: str) -> str:
        return mission(DIVE, f"{{ do = 'call', mission = '{name}' }}").replace('"test"', f'"{own}"')

    library = {"a": call("b", "a"), "b": mission(HOLD, limits="depth = 1.0"), "c": call("c", "c")}
    read = read_mission(call("a", "test"), library)
    assert [step.number for step in read.root.walk()] == [
        "",
        "1",
        "2",
        "2.1",
        "2.1.1",
        "2.1.2",
        "2.1.2.1",
        "2.1.2.1.1",
    ]
    assert read.limits.depth == 1.0
    assert called_by(call("a", "test"), library) == {"a": library["a"], "b": library["b"]}
    assert problems(call("x", "test"), library) == ["step 2: mission is 'x'; the library has a, b, c"]
    assert problems(library["c"], library) == [
        "step 2: mission is 'c', which would call itself: c → c",
    ]
    deep = {"a": call("b", "a"), "b": call("a", "b")}
    assert "test → a → b → a" in problems(call("a", "test"), deep)[0]


def _call_step(name: str) -> str:
    return f"{{ do = 'call', mission = '{name}' }}"


def test_a_called_mission_that_goes_too_deep_is_a_problem_of_the_call() -> None:
    library = {"deep": mission(HOLD, "{ do = 'dive', depth = 2.5 }"), "way": mission(_call_step("deep"))}
    goes = "goes to 2.5 m, and the depth is limited to 1 m"
    text = mission(DIVE, _call_step("deep"), _call_step("way"), limits="time = 400\ndepth = 1")
    with pytest.raises(ConfigError) as refused:
        read_mission(text, library)
    assert refused.value.texts == [
        f"step 2: mission is 'deep': step 2 {goes}",
        f"step 3: mission is 'way': step 1: mission is 'deep': step 2 {goes}",
    ]
    assert [getattr(problem, "path", None) for problem in refused.value.problems] == [
        ("mission", "steps", 1, "mission"),
        ("mission", "steps", 2, "mission"),
    ]


def test_a_called_mission_limits_only_what_it_names() -> None:
    head = HEAD.replace("alone = 0", "alone = 60").replace("pause = 20", "pause = 300")
    bare = 'format = 1\nname = "b"\n'
    text = mission(_call_step("b"), head=head)
    limits = read_mission(text, {"b": mission(HOLD, head=bare)}).limits
    assert (limits.alone, limits.pause) == (60, 300)
    limits = read_mission(text, {"b": mission(HOLD, head=f"{bare}alone = 5\n")}).limits
    assert (limits.alone, limits.pause) == (5, 300)


def test_a_document_of_any_size_is_refused_in_bounded_time() -> None:
    many = mission(*["{ do = 'surface' }"] * 2_000)
    assert f"mission has more than {NODES_MAX} steps" in problems(many)[0]
    nested = "{ do = 'try', steps = [" * 20 + DIVE + "] }" * 20
    assert problems(mission(nested)) == [
        f"step {'.'.join(['1'] * (LEVELS_MAX))}: steps is deeper than {LEVELS_MAX} levels"
    ]
    assert "is larger than" in problems(mission(*["{ do = 'surface' }"] * 10_000))[0]
    fork = {f"m{i}": mission(*[f"{{ do = 'call', mission = 'm{i + 1}' }}"] * 9) for i in range(8)}
    assert any("has more than 200 steps" in problem for problem in problems(fork["m0"], fork))
    # As deep as the bytes allow.
    steep = "{ do = 'try', steps = [" * 2_200 + DIVE + "] }" * 2_200
    assert problems(mission(steep)) == ["the mission is not TOML: it is nested too deeply"]
    ring = {f"m{i}": fork["m0"].replace("'m1'", f"'m{(i + 1) % 3}'") for i in range(3)}
    assert any("which would call itself" in problem for problem in problems(ring["m0"], ring))


@pytest.mark.parametrize(
    ("step", "answer"),
    [
        ("{ do = 'hold', seconds = 3601 }", "seconds is 3601; it must lie between 0.1 and 3600"),
        ("{ do = 'hold', seconds = -1 }", "seconds is -1; it must lie between 0.1 and 3600"),
        ("{ do = 'hold', seconds = nan }", "seconds is nan; it must be a number"),
        ("{ do = 'hold', seconds = true }", "seconds is True; it must be a number"),
        ("{ do = 'dive', depth = inf }", "depth is inf; it must be a number"),
        (
            "{ do = 'wait_for', sees = 'light', timeout = 0 }",
            "timeout is 0; it must lie between 0.1 and 3600",
        ),
        ("{ do = 'timeout', seconds = 1e9, steps = [7] }", "seconds is 1000000000.0; it must lie between"),
        (
            "{ do = 'repeat', times = 1001, steps = [{ do = 'surface' }] }",
            "times is 1001; it must lie between",
        ),
        ("{ do = 7 }", "do is 7; it must be one of"),
        ('{ do = "mark", text = "a\\u0000b" }', "text has 1 to"),
    ],
)
def test_values_beyond_their_limits_are_refused_at_their_step(step: str, answer: str) -> None:
    assert any(
        problem.startswith("step 2: ") and answer in problem for problem in problems(mission(DIVE, step))
    )


@pytest.mark.parametrize(
    ("text", "output"),
    [
        ("", "format is missing"),
        ("mission = 3", "mission must be a table"),
        ("[[", "the mission is not TOML"),
        (mission(DIVE).replace("format = 1", "format = 2"), "format is 2; it must be one of 1"),
        (mission(DIVE) + "[trial]\n", ""),
        ("trial = 1\n" + mission(DIVE), "trial must be a table"),
        ("speed = 1\n" + mission(DIVE), "is not known here; known are format, name"),
    ],
)
def test_the_head_is_read_strictly(text: str, output: str) -> None:
    if output:
        assert any(output in problem for problem in problems(text))
    else:
        read_mission(text)


def test_every_leaf_tells_its_meaning_and_fits_one_line() -> None:
    for name, cls in NODES.items():
        assert cls.__doc__
        assert cls.do == name
        if issubclass(cls, Leaf):
            assert "label" in dir(cls)
