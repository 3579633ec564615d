"""The past that the manual's pictures show: dives in simulated time, a sweep and a fit."""

from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import httpx

from robot_runtime.experiments.scenario.library import shipped_scenarios
from server.cli import main
from server.platform.settings import DataFolder

POOL = """
name = "pool"
title = "Three controllers in the pool"
description = "Bang-bang, PID and the model-based controller follow the same card."
duration = 78
seed = 7

[scene]
kind = "pool"
depth = 3.0
length = 10.0
width = 5.0

[[scene.targets]]
colour = "red"
position = [2.6, -0.5, 0.9]
size = 0.3

[control]
controller = "bang_bang"
set_point = 0.5
set_point_detected = 1.0

[vision]
camera = "scene"
colour = "yellow"

[[events]]
at = 1
do = "arm"
"""
POOL_CONTROLLERS = (("bang_bang", 1.0), ("pid", 26.0), ("predictive", 51.0))
"""Each with its beginning, in s of the scenario."""
CARD_AFTER, CARD_SECONDS = 7.0, 10.0
HELD = """
name = "held"
title = "Held in a current"
duration = 20
seed = {seed}

[scene]
kind = "natural"
depth = 4.0

[control]
controller = "{controller}"
set_point = 0.8
set_point_detected = 0.8

[[events]]
at = 1
do = "arm"

[[events]]
at = 10
do = "waves"
amplitude = 0.04
period = 2.5
direction = 1.0

[[events]]
at = 19
do = "stop"
"""
SEEDS = (1, 2, 3)
SWEEP = """format = 1
name = "gains_in_waves"
title = "Gains in waves"
scenario = "held"
seeds = 2

[vary]
"control.gains.pid.kp" = [1.0, 2.0, 4.0, 8.0]
"control.gains.pid.kd" = [0.5, 1.0, 2.0, 4.0, 6.0]

[figures]
from = 6
best = "rmse"
"""
OTHER_CRAFT = """
title = "Another craft"
[craft]
fin_drag = 0.22
buoyancy_height = 0.0085
"""
TRIAL_SECONDS = 62.0
"""Of the sea trial, so that the fit is soon done."""
WORK_SECONDS = 600.0


def record_all(folder: Path, scratch: Path) -> None:
    """Fill the data folder there with recordings; documents go into the folder `scratch`."""
    scratch.mkdir()
    for seed in SEEDS:
        for controller in ("bang_bang", "pid", "predictive"):
            _swim(folder, scratch, HELD.format(seed=seed, controller=controller))
    (scratch / "other.toml").write_text(OTHER_CRAFT)
    swum = scratch / "swum.toml"
    swum.write_text('[craft]\nfile = "other.toml"\n')
    for seed in SEEDS[:2]:
        _swim(folder, scratch, _trial(seed), swum)
    _swim(folder, scratch, shipped_scenarios()["hover_in_a_current"])
    _swim(folder, scratch, shipped_scenarios()["figure_14"])
    _swim(folder, scratch, _pool())
    own = DataFolder(folder).scenarios
    own.mkdir(parents=True, exist_ok=True)
    (own / "held.toml").write_text(HELD.format(seed=1, controller="pid"))


def compute_sweep(api: httpx.Client) -> None:
    """Have the server compute the sweep."""
    api.post("/sweeps", json={"text": SWEEP}).raise_for_status()
    _wait(lambda: all(sweep["state"] == "complete" for sweep in api.get("/sweeps").json()), "the sweep")


def fit_craft(api: httpx.Client) -> None:
    """Have the server fit one sea trial, which the other checks. Its result goes with the server."""
    fitted, check = find_sessions(api)["Sea trial"]
    api.post("/identification", json={"sessions": [fitted], "left_out": check}).raise_for_status()
    _wait(lambda: api.get("/identification").json()["active"] is None, "the fit")


def find_sessions(api: httpx.Client) -> dict[str, list[int]]:
    """Return the numbers of all sessions by their names, the oldest first."""
    numbers: dict[str, list[int]] = {}
    sessions: list[dict[str, Any]] = api.get("/sessions").json()
    for session in sorted(sessions, key=lambda session: int(session["id"])):
        numbers.setdefault(session["name"], []).append(session["id"])
    return numbers


def _wait(done: Callable[[], bool], what: str) -> None:
    end = monotonic() + WORK_SECONDS
    while not done():
        assert monotonic() < end, f"waited {WORK_SECONDS:g} s in vain for the end of {what}"
        # Each look costs the server time that it computes with.
        sleep(0.5)


def _swim(folder: Path, scratch: Path, text: str, config: Path | None = None) -> None:
    path = scratch / "scenario.toml"
    path.write_text(text)
    options = [] if config is None else ["--config", str(config)]
    assert main(["scenario", "run", str(path), "--data", str(folder), *options]) == 0


def _pool() -> str:
    events = []
    for controller, at in POOL_CONTROLLERS:
        events.append(f'at = {at}\ndo = "loop"\nname = "depth"\ncontroller = "{controller}"')
        events.append(f'at = {at + CARD_AFTER}\ndo = "card"\ncolour = "yellow"')
        events.append(f'at = {at + CARD_AFTER + CARD_SECONDS}\ndo = "card"')
    events.append('at = 76\ndo = "stop"')
    return POOL + "".join(f"\n[[events]]\n{event}\n" for event in events)


def _trial(seed: int) -> str:
    """Return the beginning of the sea trial."""
    head, *events = shipped_scenarios()["sea_trial"].split("[[events]]")
    head = head.replace("seed = 1", f"seed = {seed}").replace(
        "duration = 120", f"duration = {TRIAL_SECONDS:g}"
    )
    early = [event for event in events if float(event.split("at = ")[1].split()[0]) < TRIAL_SECONDS]
    return "[[events]]".join([head, *early])
