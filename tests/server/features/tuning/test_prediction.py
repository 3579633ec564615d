"""Predicted step responses, against the same steps of a robot that dives to their start by itself."""

import asyncio
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robot_runtime.config import ControlConfig
from robot_runtime.contract.craft import DEFAULT_DOCUMENT
from robot_runtime.experiments.scenario.boards import boards
from server.features.tuning import predictor
from server.features.tuning.prediction import DURATION_MAX, predict_step
from server.features.tuning.predictor import PredictionError, StepPredictor
from server.features.tuning.schemas import PredictedStep, PredictionQuery
from server.platform.settings import Settings
from tests.runtime.control.flight import Flight
from tests.server.features.tuning.rig import TuningRig
from tests.server.serving import Served
from tests.server.waiting import until

STEP: dict[str, Any] = {
    "kind": "step",
    "loop": "depth",
    "start": 0.4,
    "target": 0.7,
    "tolerance": 0.03,
    "settle": 20.0,
    "duration": 12.0,
    "low": 0.0,
    "high": 1.5,
}


def query(controller: str = "pid", gains: dict[str, float] | None = None, **step: Any) -> dict[str, Any]:
    return {"step": STEP | step, "controller": controller, "gains": gains or {}}


def predict(asked: dict[str, Any]) -> PredictedStep:
    parsed = PredictionQuery.model_validate(asked)
    return predict_step(parsed, asdict(ControlConfig()), DEFAULT_DOCUMENT, boards()["host"])


@pytest.mark.parametrize(
    ("controller", "gains"),
    [("pid", {}), ("pid", {"kp": 8.0, "kd": 6.0}), ("predictive", {})],
)
def test_a_robot_swims_as_predicted(controller: str, gains: dict[str, float]) -> None:
    prediction = predict(query(controller, gains))
    with Flight() as flight:
        rig = TuningRig(flight)
        rig.use(controller, gains)
        flown = rig.step(0.4, 0.7, 12.0)
        curve = rig.curve
    values = np.interp(curve.times, prediction.curve.times, prediction.curve.values)
    away = float(np.sqrt(np.mean((values - curve.values)[np.array(curve.times) >= 0] ** 2)))
    # Flown twice, one and the same step differs by 2 cm: nobody knows the phase of the fins' strokes.
    assert away < 0.04
    figures = {name: figure.value for name, figure in prediction.figures.items()}
    assert figures["rise_time"] == pytest.approx(flown["rise_time"], rel=0.15)
    assert figures["overshoot"] == pytest.approx(flown["overshoot"], abs=15)
    assert figures["rmse"] == pytest.approx(flown["rmse"], rel=0.25)


@pytest.mark.parametrize("loop", ["heading", "pitch", "roll"])
def test_angles_are_predicted(loop: str) -> None:
    prediction = predict(
        query(loop=loop, start=0.0, target=0.3, low=-1.5, high=1.5, tolerance=0.1, duration=6.0)
    )
    assert prediction.problem == ""
    assert prediction.curve.set_points[-1] == pytest.approx(0.3)
    assert max(prediction.curve.values) > 0.15
    assert max(prediction.curve.outputs) > 0.1


def test_a_step_that_leaves_its_limits_is_predicted_up_to_there() -> None:
    prediction = predict(query("bang_bang", low=0.3, high=0.72))
    assert "beyond the limits" in prediction.problem
    assert prediction.figures == {}
    assert max(prediction.curve.values) > 0.6


def test_no_more_than_half_a_minute_is_predicted() -> None:
    assert predict(query(duration=300.0)).curve.times[-1] == pytest.approx(DURATION_MAX, abs=0.2)


async def test_a_viewer_sees_the_prediction_of_the_robot_s_own_craft(served: Served) -> None:
    served.settings.craft_file.write_text('title = "Heavier"\n[craft]\nmass = 3.1\n')
    answer = await served.api.post("/tuning/prediction", json=query(duration=2.0))
    assert answer.status_code == 200, answer.text
    assert answer.json()["model"] == "Heavier"
    assert answer.json()["curve"]["times"][-1] == pytest.approx(2.0, abs=0.2)
    assert served.runtime.asked == []


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        (query("magic"), "there is no controller 'magic'"),
        (query("pid", {"kp": 800.0}), "kp is 800.0; it must be a number between 0 and 50"),
        (query("pid", {"speed": 1.0}), "no gain 'speed'"),
        (query(target=0.4), "start and target are the same"),
    ],
)
async def test_what_cannot_be_predicted_is_refused_with_the_reason(
    served: Served, asked: dict[str, Any], why: str
) -> None:
    answer = await served.api.post("/tuning/prediction", json=asked)
    assert answer.status_code == 422
    assert why in answer.json()["detail"]


async def test_a_missing_firmware_is_told(settings: Settings, tmp_path: Path) -> None:
    alone = StepPredictor(replace(settings, build=tmp_path))
    try:
        with pytest.raises(PredictionError, match=r"cannot load .*libhost_board\.so"):
            await alone.predict(PredictionQuery.model_validate(query()))
    finally:
        await alone.close()


async def test_the_process_is_started_when_needed_and_ends_when_nobody_asks(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(predictor, "IDLE_SECONDS", 0.01)
    alone, asked = StepPredictor(settings), PredictionQuery.model_validate(query(duration=2.0))
    try:
        first = await alone.predict(asked)
        await until(lambda: alone._process is None, "the process to be left")
        assert await alone.predict(asked) == first
    finally:
        await alone.close()


async def test_a_server_that_ends_meanwhile_ends_the_process(settings: Settings) -> None:
    alone = StepPredictor(settings)
    asking = asyncio.create_task(alone.predict(PredictionQuery.model_validate(query(duration=30.0))))
    await until(lambda: alone._process is not None, "the process")
    process = alone._process
    asking.cancel()
    await alone.close()
    await asyncio.gather(asking, return_exceptions=True)
    assert process is not None
    assert process.ended
