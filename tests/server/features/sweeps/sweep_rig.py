"""A short scenario and sweeps of it."""

from pathlib import Path
from typing import Any

from robot_runtime.experiments.scenario.boards import BUILD
from robot_runtime.experiments.sweep.document import Sweep, SweepRun
from server.features.sweeps.order import reopen
from server.features.sweeps.run_task import RunTask, identify, plan_task
from server.platform.openssl import LEAF, SIGNS, Signer, make_certificate

SCENARIO = """
name = "short"
title = "Short"
duration = 12
[scene]
kind = "natural"
depth = 4.0
[control]
controller = "pid"
set_point = 0.4
[[events]]
at = 1
do = "arm"
"""
HEAD = 'format = 1\nname = "eight"\nscenario = "short"\n'
EIGHT = f"""{HEAD}seeds = 2
[vary]
"control.gains.pid.kp" = [1.5, 4.0]
"control.gains.pid.kd" = [0.5, 2.0]
"""


def keep_scenario(folder: Path) -> None:
    """Put the scenario into a folder of scenarios."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "short.toml").write_text(SCENARIO)


def tasks_of(sweep: Sweep) -> list[tuple[SweepRun, RunTask]]:
    """Return all runs of a sweep with their tasks."""
    identity = identify(BUILD)
    runs = [run for variant, values in enumerate(sweep.grid(), 1) for run in sweep.runs_of(variant, values)]
    return [(run, plan_task(sweep, run, "", identity)) for run in runs]


def read(text: str = EIGHT) -> Sweep:
    """Return a sweep of the scenario."""
    return reopen(text, SCENARIO)


def without_seconds(outcome: Any) -> tuple[Any, ...]:
    """Return an outcome without the time that it took."""
    return outcome.key, outcome.problem, outcome.simulated, outcome.figures, outcome.words


def make_certificates(folder: Path) -> Path:
    """Make a folder as a scheduler, its workers and sweeps have it."""
    folder.mkdir()
    signer = Signer(folder / "ca.pem", folder / "ca.key")
    make_certificate(signer.certificate, signer.key, "lab authority", SIGNS)
    own = ("subjectAltName=IP:127.0.0.1", "extendedKeyUsage=serverAuth,clientAuth", *LEAF)
    make_certificate(folder / "certificate.pem", folder / "key.pem", "lab", own, signer)
    return folder
