"""The predicted step response: the robot's runtime and firmware swim it in simulated time."""

import json
from dataclasses import replace
from typing import Any

from robot_runtime.contract.commands import ArmCommand, LoopCommand
from robot_runtime.contract.craft import CraftDocument
from robot_runtime.contract.topics import EXPERIMENT
from robot_runtime.control.controllers import check_controller
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario, read_scenario_table
from robot_runtime.experiments.scenario.events import CommandEvent
from robot_runtime.experiments.scenario.rig import MakeBoard
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.transport.blocks import read_blocks
from server.features.tuning.curve import SampleBuffer
from server.features.tuning.evaluation import measure_run
from server.features.tuning.schemas import ENDED, PredictedStep, PredictionQuery, StepStart

SETTLE_MAX = 6.0
"""s at the start: the simulated robot begins there."""
DURATION_MAX = 30.0
"""s after the step."""
_RUN, _SEED = 1, 1
_ARM_AT, _CHOOSE_AT, _STEP_AT = 0.1, 0.5, 0.6
_LATEST = 10.0
"""s after which a step that has not begun never begins."""
_MARGIN, _SURFACE = 2.0, 0.1
"""m of water below the deepest set point; a start above the other floats."""


def predict_step(
    query: PredictionQuery, control: dict[str, Any], craft: CraftDocument, make_board: MakeBoard
) -> PredictedStep:
    """Return the response of this craft to a step, with the controller and the gains of the query.

    `control` is the robot's section [control]. Raise ValueError where there is no such controller, or
    not such gains, and RefusedError, ConfigError, BoardError, PortError.
    """
    check_controller(query.step.loop, query.controller, {query.controller: query.gains})
    step = query.step.model_copy(
        update={
            "settle": min(query.step.settle, SETTLE_MAX),
            "duration": min(query.step.duration, DURATION_MAX),
        }
    )
    watch = _Watch(step.loop)
    run = ScenarioRun(_scenario(step, query, control, craft), make_board, watch, craft)
    watch.run = run
    run.perform(lambda _: {})
    last = watch.last
    if watch.problem or last is None or last["phase"] not in ENDED:
        raise RefusedError(watch.problem or "The step did not begin in the simulation.")
    phase, text = last["phase"], last["text"]
    results, curve, problem = measure_run(step, watch.samples, watch.starts, phase, text)
    return PredictedStep(model=craft.title, problem=problem, figures=results.get("figures", {}), curve=curve)


def _scenario(
    step: StepStart, query: PredictionQuery, control: dict[str, Any], craft: CraftDocument
) -> Scenario:
    """Return the scenario of the step: the robot arms at its start and takes it."""
    start: dict[str, Any] = {}
    depth = control["set_point"]
    if step.loop == "depth":
        depth = step.start
    elif step.loop == "heading":
        start["heading"] = step.start
    if depth > _SURFACE:
        start["down"] = depth
    floor = max(depth, step.target if step.loop == "depth" else 0.0) + _MARGIN
    table = {
        "name": "prediction",
        "title": "PredictedStep",
        "seed": _SEED,
        "duration": step.settle + step.duration + _LATEST,
        "scene": {"kind": "natural", "depth": floor},
        "craft": "robot",
        "start": start,
        "control": {**control, "set_point": depth},
    }
    scenario = read_scenario_table(table, craft.craft)
    choice = LoopCommand(name=step.loop, controller=query.controller, gains=query.gains)
    events = (
        CommandEvent(at=_ARM_AT, command=ArmCommand(mode="automatic")),
        CommandEvent(at=_CHOOSE_AT, command=choice),
        CommandEvent(at=_STEP_AT, command=step.command(_RUN)),
    )
    return replace(scenario, events=events)


class _Watch:
    """The reader of a run's output; it ends the run with the experiment."""

    def __init__(self, loop: str) -> None:
        self.run: ScenarioRun | None = None
        self.samples = SampleBuffer(loop)
        self.starts: dict[str, float] = {}
        self.last: dict[str, Any] | None = None
        self.problem = ""

    def blocks(self, data: bytes) -> None:
        """Take the samples, and the experiment's documents."""
        for block in read_blocks(data):
            if block.topic is not EXPERIMENT:
                self.samples.see(block)
                continue
            for document in json.loads(block.payload):
                self.last = document
                self.starts.setdefault(document["phase"], document["since"])
                if document["phase"] in ENDED and self.run is not None:
                    self.run.cancel()

    def event(self, event: str, **more: Any) -> None:
        """Keep the reasons of refusals."""
        if event == "ended" and more.get("problem"):
            self.problem = str(more["problem"])
