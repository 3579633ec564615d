"""Tuning runs over HTTP, with a runtime that the test plays."""

import asyncio
import json
from math import pi, sin
from types import SimpleNamespace
from typing import Any

import httpx
import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.commands import RobotCommand
from robot_runtime.contract.documents import Control, Experiment
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents, row
from server.features.tuning import evaluation
from server.features.tuning import runner as tuning_runner
from server.features.tuning.runner import TuningRunner
from server.features.tuning.runs import TuningStore
from server.features.tuning.schemas import ControllerInForce, StepStart
from server.platform.store import Store
from tests.server.serving import Served, next_text
from tests.server.waiting import until

STEP: dict[str, Any] = {
    "kind": "step",
    "loop": "depth",
    "start": 0.4,
    "target": 0.7,
    "tolerance": 0.03,
    "settle": 10.0,
    "duration": 6.0,
    "low": 0.0,
    "high": 1.5,
}
RELAY: dict[str, Any] = {
    "kind": "relay",
    "loop": "depth",
    "set_point": 0.6,
    "amplitude": 0.5,
    "hysteresis": 0.01,
    "cycles": 3,
    "duration": 60.0,
    "low": 0.0,
    "high": 1.5,
}
PID = {
    "name": "pid",
    "title": "PID",
    "gains": [
        {"name": name, "value": value, "minimum": 0.0, "maximum": 50.0, "unit": "", "meaning": ""}
        for name, value in {"kp": 3.0, "ki": 0.4, "kd": 2.0}.items()
    ],
}


class TunedRobot:
    """A runtime as of one robot in automatic."""

    def __init__(self, served: Served) -> None:
        self._served = served
        self._numbers: dict[str, int] = {}

    def arm(self, mode: str = "automatic") -> None:
        loop = {"name": "depth", "on": False, "set_point": 0.5, "controller": "pid", "controllers": [PID]}
        self._served.runtime.state = {"mode": mode, "loops": [loop]}

    def notify(self, run: int, phase: Any, since: float, **more: Any) -> None:
        text: dict[str, Any] = {"progress": 0.5, "cycles": 0, "bias": 0.0, "text": "", "kind": "step"} | more
        report = Experiment(time=since, number=run, loop="depth", phase=phase, since=since, **text)
        self._publish("experiment", 1, pack_documents([report]))

    def tick(self, ticks: list[tuple[float, float, float, float]]) -> None:
        """Time, set point, depth and output of each."""
        rows = b"".join(
            row(
                time,
                Control(
                    set_point=expected, depth=depth, error=expected - depth, output=output, latency=0.0
                ).to_bytes(),
            )
            for time, expected, depth, output in ticks
        )
        self._publish("control", len(ticks), rows)

    def _publish(self, name: str, count: int, payload: bytes) -> None:
        first = self._numbers.get(name, 0)
        self._numbers[name] = first + count
        self._served.runtime.publish(Block.of(BY_NAME[name], count, first, payload))


@pytest.fixture
def robot(served: Served) -> TunedRobot:
    return TunedRobot(served)


async def begin(served: Served, request: dict[str, Any]) -> int:
    answer = await served.api.post("/tuning/runs", json=request)
    assert answer.status_code == 201, answer.text
    run = answer.json()["run"]
    fields = {name: value for name, value in request.items() if name != "kind"}
    assert served.runtime.asked[-1] == (f"{request['kind']}_experiment", {"number": run, **fields})
    return int(run)


async def over(served: Served) -> dict[str, Any]:
    """Return the ended run."""
    await until(lambda: served.get(TuningRunner).state().active is None, "the run's end")
    last = served.get(TuningRunner).state().last
    assert last is not None
    answer: dict[str, Any] = (await served.api.get(f"/tuning/runs/{last.id}")).raise_for_status().json()
    return answer


async def test_a_step_is_stored_with_its_curve_and_figures(served: Served, robot: TunedRobot) -> None:
    robot.arm()
    async with served.connect() as socket:
        run = await begin(served, STEP)
        while (report := await next_text(socket, "tuning"))["active"] is None:
            pass
        assert (report["active"]["run"], report["active"]["phase"]) == (run, "settling")
    robot.notify(run, "settling", 100.0)
    robot.tick([(100.0 + 0.1 * index, 0.4, 0.4, 0.1) for index in range(50)])
    robot.notify(run, "running", 105.0)
    robot.tick([(105.0 + 0.1 * index, 0.7, min(0.4 + 0.02 * index, 0.7), 0.5) for index in range(61)])
    robot.notify(run, "complete", 111.0, progress=1.0)
    stored = await over(served)
    assert (stored["id"], stored["state"], stored["problem"]) == (run, "complete", "")
    assert stored["force"] == {
        "controller": "pid",
        "title": "PID",
        "gains": {"kp": 3.0, "ki": 0.4, "kd": 2.0},
    }
    assert stored["settings"] == STEP
    assert stored["name"] == "PID, 0.4 m to 0.7 m"
    assert stored["curve"]["times"][0] == pytest.approx(-3.0)
    assert stored["curve"]["times"][-1] == pytest.approx(5.9)
    assert stored["figures"]["rise_time"]["value"] == pytest.approx(1.2)
    assert stored["figures"]["overshoot"]["value"] == pytest.approx(0.0, abs=1e-3)
    assert stored["figures"]["effort"]["value"] == pytest.approx(50.0)
    listed = (await served.api.get("/tuning/runs")).json()
    assert [entry["id"] for entry in listed["runs"]] == [run]
    assert {figure["name"] for figure in listed["figures"]} == set(stored["figures"])
    assert (await served.api.get("/tuning/runs?loop=roll")).json()["runs"] == []


async def test_a_relay_proposes_gains(served: Served, robot: TunedRobot) -> None:
    robot.arm()
    run = await begin(served, RELAY)
    robot.notify(run, "settling", 100.0, kind="relay")
    robot.notify(run, "running", 104.0, kind="relay")
    ticks = [0.1 * index for index in range(161)]
    robot.tick(
        [
            (
                100.0 + at,
                0.6,
                0.6 - 0.07 * sin(at * 2 * pi / 4),
                0.6 if at % 4 < 1.99 or at % 4 > 3.99 else -0.4,
            )
            for at in ticks
        ]
    )
    robot.notify(run, "complete", 116.0, kind="relay", cycles=3)
    stored = await over(served)
    assert (stored["state"], stored["problem"]) == ("complete", "")
    cycle = stored["cycle"]
    assert cycle["period"] == pytest.approx(4.0)
    assert cycle["swing"] == pytest.approx(0.07, abs=1e-4)
    assert cycle["amplitude"] == pytest.approx(0.5)
    assert cycle["bias"] == pytest.approx(0.1)
    assert cycle["ultimate_gain"] == pytest.approx(4 * 0.5 / (pi * (0.07**2 - 0.01**2) ** 0.5), rel=1e-3)
    rules = [proposal["rule"] for proposal in stored["proposals"]]
    assert rules[0] == "ziegler_nichols"
    assert all(proposal["problem"] == "" and proposal["source"] for proposal in stored["proposals"])


async def test_a_run_that_was_stopped_keeps_its_curve_without_figures(
    served: Served, robot: TunedRobot
) -> None:
    robot.arm()
    run = await begin(served, STEP)
    robot.notify(run, "settling", 100.0)
    robot.tick([(100.0 + 0.1 * index, 0.4, 0.3, 0.1) for index in range(20)])
    refused = await served.api.delete(f"/tuning/runs/{run}")
    assert (refused.status_code, "is active" in refused.text) == (409, True)
    stale = await served.api.post(f"/tuning/stop?run={run + 1}")
    assert (stale.status_code, "This experiment is over" in stale.text) == (409, True)
    assert served.runtime.asked[-1] != ("end_experiment", {})
    assert (await served.api.post(f"/tuning/stop?run={run}")).status_code == 204
    assert served.runtime.asked[-1] == ("end_experiment", {})
    robot.notify(run, "stopped", 102.0, text="It was stopped.")
    stored = await over(served)
    assert (stored["state"], stored["problem"], stored["figures"]) == ("stopped", "It was stopped.", {})
    assert len(stored["curve"]["times"]) == 20


async def test_a_run_that_cannot_be_measured_fails_with_its_curve(
    monkeypatch: pytest.MonkeyPatch, served: Served, robot: TunedRobot
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("of zero")

    monkeypatch.setattr(evaluation, "measure_run", fail)
    robot.arm()
    run = await begin(served, STEP)
    robot.notify(run, "settling", 100.0)
    robot.tick([(100.0 + 0.1 * index, 0.4, 0.3, 0.1) for index in range(20)])
    robot.notify(run, "complete", 102.0)
    stored = await over(served)
    assert (stored["id"], stored["state"], len(stored["curve"]["times"])) == (run, "failed", 20)
    assert stored["problem"] == "Internal error (ZeroDivisionError('of zero')); the server's log has details."


async def test_runs_are_named_and_deleted(served: Served, robot: TunedRobot) -> None:
    robot.arm()
    run = await begin(served, STEP)
    robot.notify(run, "failed", 102.0, text="It ended at 1.6 m, which is beyond the limits, 0 m to 1.5 m.")
    await over(served)
    named = await served.api.patch(f"/tuning/runs/{run}", json={"name": "with tape"})
    assert named.json()["name"] == "with tape"
    assert (await served.api.patch(f"/tuning/runs/{run}", json={"name": ""})).status_code == 422
    assert (await served.api.delete(f"/tuning/runs/{run}")).status_code == 204
    for answer in (
        await served.api.delete(f"/tuning/runs/{run}"),
        await served.api.patch(f"/tuning/runs/{run}", json={"name": "x"}),
        await served.api.get(f"/tuning/runs/{run}"),
    ):
        assert (answer.status_code, "may have been deleted" in answer.text) == (404, True)


async def refused(served: Served, expected: Any, status: int) -> str:
    text = expected if isinstance(expected, str) else json.dumps(expected)
    answer: httpx.Response = await served.api.post(
        "/tuning/runs", content=text, headers={"Content-Type": "application/json"}
    )
    assert answer.status_code == status, answer.text
    return str(answer.json()["detail"])


async def test_an_experiment_that_cannot_start_is_refused_and_stores_nothing(
    served: Served, robot: TunedRobot
) -> None:
    robot.arm("disarmed")
    assert "The robot is disarmed. Arm it" in await refused(served, STEP, 409)
    robot.arm("manual")
    assert "The robot is manual" in await refused(served, STEP, 409)
    robot.arm()
    assert "no loop 'roll'" in await refused(served, STEP | {"loop": "roll"}, 409)
    for wrong in (
        STEP | {"target": 21},
        STEP | {"kind": "sine"},
        STEP | {"loop": "surge"},
        STEP | {"more": 1},
        RELAY | {"cycles": 2.5},
        RELAY | {"amplitude": 0},
        json.dumps(STEP).replace("0.7", "NaN"),
    ):
        assert "not valid" in await refused(served, wrong, 422)
    served.runtime.refusal = "No, since the runtime knows better."
    assert "the runtime knows better" in await refused(served, STEP, 409)
    served.runtime.refusal = None
    served.get(TuningRunner)._occupied = lambda: "The scenario “Dive” is being run."
    assert "The scenario “Dive”" in await refused(served, STEP, 409)
    served.get(TuningRunner)._occupied = lambda: None
    nothing = await served.api.post("/tuning/stop")
    assert (nothing.status_code, nothing.json()["detail"]) == (409, "No experiment is running.")
    assert (await served.api.get("/tuning/runs")).json()["runs"] == []
    await begin(served, STEP)
    assert "already running" in await refused(served, STEP, 409)


async def test_an_experiment_of_another_server_is_ended(served: Served, robot: TunedRobot) -> None:
    robot.arm()
    robot.notify(7, "running", 100.0)
    await until(lambda: ("end_experiment", {}) in served.runtime.asked, "it to be ended")


@pytest.mark.parametrize(("phases", "ended"), [(["running"], 1), (["running", "complete"], 0)])
async def test_an_experiment_of_another_server_that_is_over_is_not_ended_again(
    monkeypatch: pytest.MonkeyPatch, phases: list[Any], ended: int
) -> None:
    asked: list[RobotCommand] = []

    async def command(_: str, command: RobotCommand) -> None:
        asked.append(command)

    nobody: Any = None
    changes: Any = SimpleNamespace(command=command)
    runner = TuningRunner(nobody, nobody, changes, SimulatedClock(100.0), nobody, nobody, nobody)
    for number, phase in enumerate(phases):
        report = Experiment(
            time=100.0,
            number=7,
            loop="depth",
            phase=phase,
            since=100.0,
            progress=0.5,
            cycles=0,
            bias=0.0,
            text="",
            kind="step",
        )
        runner.see(Block.of(BY_NAME["experiment"], 1, number, pack_documents([report])))
    monkeypatch.setattr(tuning_runner, "CHECK_SECONDS", 0)
    checking = asyncio.create_task(runner.run())
    for _ in range(10):
        await asyncio.sleep(0)
    checking.cancel()
    assert len(asked) == ended


def test_a_killed_server_leaves_its_run_interrupted(store: Store) -> None:
    runs = TuningStore(store)
    force = ControllerInForce(controller="pid", title="PID", gains={})
    run = asyncio.run(runs.begin(StepStart(**STEP), "one", force, {}))
    asyncio.run(runs.mark_interrupted())
    stored = runs.detail(run)
    assert (stored.state, stored.curve.times) == ("interrupted", [])
    assert "The server ended" in stored.problem
