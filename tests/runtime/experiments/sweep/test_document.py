"""The sweep's document: its variants and runs, and what it refuses in reason."""

import time

import pytest

from robot_runtime.contract.limits import ConfigError
from robot_runtime.experiments.sweep.document import RUNS_MAX, Sweep, check_variants, read_sweep

SCENARIO = """
name = "short"
title = "Short"
duration = 12
[scene]
kind = "natural"
depth = 4.0
[control]
controller = "pid"
[[events]]
at = 1
do = "arm"
[[events]]
at = 5
do = "current"
north = 0.1
"""
HEAD = 'format = 1\nname = "one"\nscenario = "short"\n'
FIGURES = {"rmse": True, "overshoot": True, "deepest": False}


def read(text: str, head: str = HEAD) -> Sweep:
    sweep = read_sweep(head + text, {"short": SCENARIO}, FIGURES)
    check_variants(sweep)
    return sweep


def test_the_grid_has_each_variant_with_each_seed() -> None:
    sweep = read(
        'seeds = 3\n[vary]\n"control.gains.pid.kp" = [1.5, 3.0]\n'
        "control.gains.pid.kd = { from = 0.5, to = 4.0, steps = 8 }\n"
    )
    assert (sweep.variants, sweep.runs) == (16, 48)
    variants = [*sweep.grid()]
    assert variants[0] == (1.5, 0.5)
    assert variants[-1] == (3.0, 4.0)
    runs = [*sweep.runs_of(2, variants[1])]
    assert [(run.number, run.seed, run.values) for run in runs] == [
        (4, 1, (1.5, 1.0)),
        (5, 2, (1.5, 1.0)),
        (6, 3, (1.5, 1.0)),
    ]
    table = sweep.scenario_of(runs[2])
    assert table["control"]["gains"]["pid"] == {"kp": 1.5, "kd": 1.0}
    assert table["seed"] == 3
    assert "gains" not in sweep.table["control"]


def test_what_a_seed_draws_is_the_same_in_every_variant() -> None:
    sweep = read(
        'seeds = [4, 7]\n[vary]\n"control.gains.pid.kp" = [1.5, 3.0]\n'
        '"water.current.north" = { uniform = [-0.1, 0.1] }\n'
    )
    assert sweep.variants == 2
    drawn = [
        [run.values[1] for run in sweep.runs_of(variant, values)]
        for variant, values in enumerate(sweep.grid(), 1)
    ]
    assert drawn[0] == drawn[1]
    assert len({*drawn[0]}) == 2


def test_samples_and_entries_of_lists_vary() -> None:
    sweep = read(
        '[vary]\n"water.current.east" = { uniform = [-0.1, 0.1], samples = 5 }\n'
        '"events.1.north" = [0.0, 0.2]\n'
    )
    assert sweep.variants == 10
    last = [*sweep.grid()][-1]
    assert sweep.scenario_of(next(sweep.runs_of(10, last)))["events"][1]["north"] == 0.2


def test_a_search_tries_whole_generations() -> None:
    sweep = read(
        'seeds = 2\n[search]\nvariants = 33\n[vary]\n"control.gains.pid.kp" = { from = 1, to = 5 }\n'
        '"control.gains.pid.kd" = { from = 1, to = 5 }\n'
    )
    assert (sweep.generation, sweep.variants, sweep.runs) == (10, 30, 60)


@pytest.mark.parametrize("seeds", ["1000000000", "1001", "0", "true", "[1, 1]", "[]", "-1", "[4294967296]"])
def test_impossible_seeds_are_refused(seeds: str) -> None:
    with pytest.raises(ConfigError, match="seeds"):
        read(f"seeds = {seeds}\n")


def test_a_thousand_million_runs_are_refused_at_once() -> None:
    steps = "{ from = 0.5, to = 4.0, steps = 1000 }"
    began = time.process_time()
    with pytest.raises(ConfigError, match=r"1,000,000,000 runs; there can be 100,000") as refused:
        read(
            f'seeds = 1000\n[vary]\n"control.gains.pid.kp" = {steps}\n"control.gains.pid.kd" = {steps}\n',
        )
    assert refused.value.problems[0].path == ("vary",)
    assert time.process_time() - began < 1
    assert RUNS_MAX == 100_000


@pytest.mark.parametrize(
    ("text", "path", "reason"),
    [
        ("[vary]\nwater.current.north = 0.1\n", ("vary", "water", "current", "north"), "is a list of values"),
        ('[vary]\n"control.gains.pid.kp" = [1, 900]\n', ("vary", "control.gains.pid.kp", 1), "900"),
        ('[vary]\n"control.gain.pid.kp" = [1]\n', ("vary", "control.gain.pid.kp", 0), "'gain' is not known"),
        ('[vary]\n"robot.mass" = { from = 0.1, to = 900, steps = 3 }\n', ("vary", "robot.mass"), "must lie"),
        ('[vary]\n"control.controller" = ["pid", "lqr"]\n', ("vary", "control.controller", 1), "lqr"),
        ('[vary]\nmission = ["first_dive", "none"]\n', ("vary", "mission", 1), "the library has"),
        ("[vary]\nseed = [1, 2]\n", ("vary", "seed"), "`seeds` says which"),
        ('[vary]\n"events.9.north" = [1]\n', ("vary", "events.9.north", 0), "entries 0 to 1"),
        ('[vary]\n"duration.x" = [1]\n', ("vary", "duration.x", 0), "a value where a table would be"),
        ('[vary]\n"control.gains.pid.kp" = [1, 1]\n', ("vary", "control.gains.pid.kp"), "twice"),
        (f'[vary]\n"events.{"9" * 5000}.north" = [1]\n', ("vary", f"events.{'9' * 5000}.north", 0), "0 to 1"),
        ('[vary]\n"control.gains.pid.kp" = []\n', ("vary", "control.gains.pid.kp"), "has 0 values"),
        ('[vary]\n"control.gains.pid.kp" = [nan]\n', ("vary", "control.gains.pid.kp", 0), "must be a number"),
        (
            '[vary]\n"control.gains.pid.kp" = { from = 1, to = 2 }\n',
            ("vary", "control.gains.pid.kp"),
            "needs steps",
        ),
        ('[vary]\n"a" = { uniform = [2, 1] }\n', ("vary", "a"), "the first must be the smaller"),
        ("[figures]\nbest = 'deepest'\n", ("figures", "best"), "there are rmse, overshoot"),
        ("[figures]\nbest = 'speed'\n", ("figures", "best"), "there are rmse, overshoot"),
        ("[figures]\nlimits = { speed = 1 }\n", ("figures", "limits", "speed"), "is no figure"),
        ("[figures]\nfrom = 5\nto = 4\n", ("figures", "to"), "after `from`"),
        ("[search]\n", ("search",), "needs an entry"),
        ("[search]\nvariants = 5\n", ("search", "variants"), "must lie between 10"),
        ("colour = 1\n", ("colour",), "known are format, name, title, scenario, seeds, vary"),
    ],
)
def test_what_cannot_be_run_is_named(text: str, path: tuple[str | int, ...], reason: str) -> None:
    with pytest.raises(ConfigError) as refused:
        read(text)
    assert path in [problem.path for problem in refused.value.problems]
    assert reason in "; ".join(refused.value.texts)


@pytest.mark.parametrize(
    ("head", "reason"),
    [
        (HEAD.replace("1", "2", 1), "this version reads 1"),
        (HEAD.replace('"one"', '"One two"'), "small letters"),
        (HEAD.replace('"short"', '"long"'), "the library has short"),
        ("format = 1\n", "name is missing"),
        ("format =", "is not TOML"),
        (HEAD + "seeds = = 2\n", "is not TOML.*line 4"),
        (HEAD + "seeds = [1, 2\n", "is not TOML"),
        (HEAD + "seeds = 1,5\n", r"1,5 in line 4; write 1\.5"),
        (HEAD + "#" * 1_000_000, "is larger than 60000 bytes"),
    ],
)
def test_a_wrong_head_is_named(head: str, reason: str) -> None:
    with pytest.raises(ConfigError, match=reason):
        read("", head)


def test_a_variant_that_is_wrong_as_a_whole_is_named() -> None:
    """Each value is right by itself: the waves are too high for the water of the shallower scene."""
    with pytest.raises(ConfigError, match="water: waves"):
        read('[vary]\n"scene.depth" = [4.0, 0.5]\n"water.waves.amplitude" = [0.05, 0.3]\n')
