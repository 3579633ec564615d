"""Sweeps by HTTP, from a shell and from Python: the same table to the bit; queue, cancel, resume."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from mucat import Lab, RobotError
from server.cli import main
from server.features.sweeps.runner import SweepRunner
from server.features.sweeps.store import SweepStore
from server.platform.models import SweepRow
from server.platform.settings import Settings
from tests.server.features.doors.rig import make_token
from tests.server.features.sweeps.sweep_rig import EIGHT, HEAD, SCENARIO, keep_scenario
from tests.server.serving import Served, serve
from tests.waiting import SECONDS


async def ended(served: Served, sweep: int) -> dict[str, object]:
    """Wait for the end of a sweep; return it as listed."""
    async with asyncio.timeout(SECONDS):
        await served.get(SweepRunner).wait()
    listed = (await served.api.get("/sweeps")).json()
    return next(entry for entry in listed if entry["id"] == sweep)


def states_of(message: dict[str, Any]) -> list[tuple[int, str]]:
    """Return the sweeps that pages are sent about, each with its state."""
    return [(entry["id"], entry["state"]) for entry in message["sweeps"]]


@pytest.fixture
def shell_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The table of the sweep from a shell, with a data folder of its own."""
    document, out, folder = tmp_path / "eight.toml", tmp_path / "eight.csv", tmp_path / "shell"
    document.write_text(EIGHT)
    (tmp_path / "robot.toml").write_text("")
    keep_scenario(folder / "scenarios")
    where = ["--data", str(folder), "--config", str(tmp_path / "robot.toml")]
    assert main(["scenario", "sweep", str(document), "--table", str(out), *where]) == 0
    assert "eight: complete. 8 of 8 runs. Best: control.gains.pid.kp = " in capsys.readouterr().out
    return out.read_text()


async def test_shell_http_and_python_give_the_same_table(shell_table: str, settings: Settings) -> None:
    keep_scenario(settings.data.scenarios)
    async with serve(settings) as served:
        check = (await served.api.post("/sweeps/check", json={"text": EIGHT})).json()
        assert (check["runs"], check["variants"], check["stored"], check["seconds"]) == (8, 4, 0, None)
        assert [entry["unit"] for entry in check["parameters"]] == ["1/m", "s/m"]
        started = await served.api.post("/sweeps", json={"text": EIGHT})
        sweep = started.json()["sweep"]
        summary = await ended(served, sweep)
        assert (summary["state"], summary["done"], summary["failed"]) == ("complete", 8, 0)
        table = (await served.api.get(f"/sweeps/{sweep}/table")).text
        assert table == shell_table
        check = (await served.api.post("/sweeps/check", json={"text": EIGHT})).json()
        assert check["stored"] == 8
        assert check["seconds"] == 0
        token = await make_token(served, name="lab")
        lab = Lab(f"http://127.0.0.1:{served.settings.server.port}", token)
        states: list[dict[str, object]] = []
        frame = await asyncio.to_thread(lab.sweep, EIGHT, states.append)
        assert states[-1]["state"] == "complete"
        # Written again, the numbers are the same to the last digit.
        assert frame.to_csv(index=False) == table
        assert frame.attrs["units"]["rmse"] == "m"
        detail = (await served.api.get(f"/sweeps/{sweep}")).json()
        assert len(detail["variants"]) == 4
        assert detail["best"]["variant"] == summary["best"]["variant"]  # type: ignore[index]
        assert detail["best"]["next"]["variant"] != detail["best"]["variant"]
        with pytest.raises(RobotError, match="the library has"):
            await asyncio.to_thread(lab.sweep, EIGHT.replace('"short"', '"long"'))


async def test_a_run_becomes_a_session_with_the_same_figures(settings: Settings) -> None:
    keep_scenario(settings.data.scenarios)
    async with serve(settings) as served:
        text = (
            EIGHT.replace("[1.5, 4.0]", "[1.5]")
            .replace("[0.5, 2.0]", "[0.5]")
            .replace("seeds = 2", "seeds = [7]")
        )
        sweep = (await served.api.post("/sweeps", json={"text": text})).json()["sweep"]
        await ended(served, sweep)
        [run] = (await served.api.get(f"/sweeps/{sweep}/runs", params={"variant": 1})).json()
        assert (run["state"], run["seed"], run["session"]) == ("complete", 7, None)
        begun = await served.api.post(f"/sweeps/{sweep}/runs/{run['number']}/session")
        assert begun.status_code == 201
        from server.features.scenarios.runs import ScenarioRunner

        async with asyncio.timeout(SECONDS):
            await served.get(ScenarioRunner).wait()
        last = served.get(ScenarioRunner).state().last
        assert last is not None
        assert last.state == "complete"
        [run] = (await served.api.get(f"/sweeps/{sweep}/runs")).json()
        assert run["session"] == last.session
        compared = await served.api.post(
            "/compare", json={"sessions": [last.session], "signals": [], "align": {"by": "armed"}}
        )
        figures = compared.json()["sessions"][0]["figures"]
        for name, value in run["figures"].items():
            if name in figures:
                assert figures[name]["value"] == value, name
        profile = await served.api.post(f"/sweeps/{sweep}/profile", json={"variant": 1, "name": "Best"})
        assert profile.json()["values"] == {
            "depth.controller": "pid",
            "depth.pid.kp": 1.5,
            "depth.pid.kd": 0.5,
        }


async def test_sweeps_queue_and_are_cancelled_and_resumed(settings: Settings) -> None:
    keep_scenario(settings.data.scenarios)
    many = EIGHT.replace("seeds = 2", "seeds = 400")
    async with serve(settings) as served:
        first = (await served.api.post("/sweeps", json={"text": many})).json()["sweep"]
        second = (await served.api.post("/sweeps", json={"text": EIGHT})).json()["sweep"]
        listed = (await served.api.get("/sweeps")).json()
        assert (listed[0]["id"], listed[0]["state"]) == (second, "waiting")
        assert (await served.api.delete(f"/sweeps/{first}")).status_code == 409
        sent: list[dict[str, Any]] = []
        served.get(SweepRunner)._notify = sent.append
        assert (await served.api.post(f"/sweeps/{second}/cancel")).status_code == 204
        assert (second, "cancelled") in states_of(sent[-1])
        store = served.get(SweepStore)
        async with asyncio.timeout(SECONDS):
            while not await asyncio.to_thread(store.runs, first):
                await asyncio.sleep(0.1)
        assert (await served.api.post(f"/sweeps/{first}/cancel")).status_code == 204
        summary = await ended(served, first)
        assert summary["state"] == "cancelled"
        done = summary["done"]
        assert len(await asyncio.to_thread(store.runs, first)) == done
        assert (await served.api.post(f"/sweeps/{first}/cancel")).status_code == 409
        many_again = (await served.api.post("/sweeps", json={"text": many})).json()["sweep"]
        assert (await served.api.post(f"/sweeps/{second}/resume")).status_code == 204
        assert (second, "waiting") in states_of(sent[-1])
        assert (await served.api.post(f"/sweeps/{many_again}/cancel")).status_code == 204
        assert (await ended(served, second))["state"] == "complete"
        assert (await served.api.post(f"/sweeps/{second}/resume")).status_code == 409
        assert (await served.api.delete(f"/sweeps/{first}")).status_code == 204
        assert (await served.api.get(f"/sweeps/{first}")).status_code == 404


async def test_a_killed_servers_sweep_is_interrupted_and_goes_on(settings: Settings) -> None:
    keep_scenario(settings.data.scenarios)
    row = SweepRow(
        name="eight",
        title="eight",
        scenario="short",
        text=EIGHT,
        scenario_text=SCENARIO,
        craft="",
        who="",
        state="running",
        runs=8,
        done=3,
        best_figure="rmse",
        parameters=json.dumps(["control.gains.pid.kp", "control.gains.pid.kd"]),
        made=0.0,
    )
    async with serve(settings) as served:
        number = await served.get(SweepStore).add(row)
    async with serve(settings) as served:
        listed = (await served.api.get("/sweeps")).json()
        assert listed[0]["state"] == "interrupted"
        (await served.api.post(f"/sweeps/{number}/resume")).raise_for_status()
        assert (await ended(served, number))["done"] == 8


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (HEAD + '[vary]\n"control.gains.pid.kq" = [1]\n', "kq"),
        (
            HEAD
            + "seeds = 1000\n"
            + "[vary]\n"
            + "".join(
                f'"control.gains.pid.{name}" = {{ from = 1, to = 2, steps = 1000 }}\n'
                for name in ("kp", "kd")
            ),
            "1,000,000,000 runs",
        ),
        ("format = 7\n", "this version reads 1"),
        (tomli_w.dumps({"format": 1, "name": "x", "scenario": "nowhere"}), "the library has"),
    ],
)
async def test_what_cannot_be_run_is_refused_in_words(served: Served, text: str, reason: str) -> None:
    keep_scenario(served.settings.data.scenarios)
    check = await served.api.post("/sweeps/check", json={"text": text})
    assert reason in str(check.json()["problems"])
    refused = await served.api.post("/sweeps", json={"text": text})
    assert refused.status_code == 422
    assert reason in refused.json()["detail"]


async def test_every_scenario_has_a_template_that_can_be_run(served: Served) -> None:
    for scenario in (await served.api.get("/scenarios")).json():
        text = (await served.api.get("/sweeps/template", params={"scenario": scenario["name"]})).json()[
            "text"
        ]
        check = (await served.api.post("/sweeps/check", json={"text": text})).json()
        assert check["problems"] == [], text
        assert check["runs"] > 1
