"""Fits over HTTP: in a process of their own, cancelled, adopted and undone."""

import asyncio
import re
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from robot_runtime.config import CraftConfig
from robot_runtime.contract.craft import load_craft
from server.features.identification.runner import IdentificationRunner
from server.platform.settings import Settings
from server.processes import side_process
from server.stream.feed import Feed
from tests.server.blocks import state_block
from tests.server.features.identification.conftest import RecordedTrials
from tests.server.serving import Served, serve
from tests.server.waiting import until
from tests.waiting import SECONDS

ROOT = Path(__file__).resolve().parents[4]
QUICK = """#!{python}
import sys
sys.path.insert(0, "{root}")
from robot_runtime.experiments.identification import fit
from server.features.identification import __main__ as process
fit.ROUNDS, fit.STEPS_MAX, process.NICENESS = 2, 4, 0
del sys.argv[:2]
sys.exit(process.main())
"""
STUCK = "#!{python}\nimport time\ntime.sleep(3600)\n"
WRONG = "#!{python}\nprint('?')\n"
BROKEN = "#!{python}\nimport os\nos._exit(3)\n"


def use(monkeypatch: pytest.MonkeyPatch, folder: Path, work: str) -> None:
    """Fit by this program."""
    script = folder / "python"
    script.write_text(work.format(python=sys.executable, root=ROOT))
    script.chmod(0o700)

    monkeypatch.setattr(side_process, "sys", SimpleNamespace(executable=str(script)))


async def state(served: Served) -> dict:  # type: ignore[type-arg]
    answer = await served.api.get("/identification")
    assert answer.status_code == 200
    return dict(answer.json())


async def start(served: Served, **choice: object) -> int:
    return (await served.api.post("/identification", json=choice)).status_code


async def test_a_fitted_craft_is_adopted_and_the_adoption_undone(
    trials: RecordedTrials, settings: Settings, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    use(monkeypatch, tmp_path, QUICK)
    own = replace(settings, data=trials.data)

    async with serve(own) as served:
        before = (await state(served))["craft"]
        assert (before["title"], before["can_undo"], before["problem"]) == ("", False, "")
        assert await start(served, sessions=[1], left_out=2) == 201
        async with asyncio.timeout(SECONDS):
            while (result := await state(served))["active"] is not None:
                assert result["active"]["sessions"] == [1]
                await asyncio.sleep(0.05)
        last = result["last"]
        assert last["problem"] == ""
        thrust = last["result"]["numbers"][0]
        assert (thrust["name"], thrust["before"]) == ("thrust", 0.31)
        assert thrust["value"] == pytest.approx(0.22, rel=0.05)
        assert last["result"]["check"]["id"] == 2
        assert len(last["result"]["check"]["channels"]) == 7
        stale = await served.api.post(f"/identification/adopt?run={'0' * 16}")
        assert (stale.status_code, "This fit is over" in stale.text) == (409, True)
        assert not trials.data.craft.exists()
        adopted = await served.api.post(f"/identification/adopt?run={last['run']}")
        assert adopted.status_code == 200
        effects = " ".join(adopted.json()["affected"])
        assert re.search(
            r"The model-based controller has thrust 0\.\d+ instead of 0\.268 m/s², .*drag", effects
        )
        assert ("controller", "predictive") in [
            (name, question.get("name")) for name, question in served.runtime.asked
        ]
        craft = load_craft(trials.data.craft)
        assert craft.craft.fin_drag == pytest.approx(thrust["value"])
        now = (await state(served))["craft"]
        assert (now["title"], now["can_undo"]) == ("Fitted to Sea trial", True)
        assert (await served.api.post("/identification/undo")).status_code == 200
        assert not trials.data.craft.exists()
        assert (await state(served))["craft"]["can_undo"] is False
        assert (await served.api.post("/identification/undo")).status_code == 409


async def test_a_fit_is_cancelled_at_once(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    use(monkeypatch, tmp_path, STUCK)

    async with serve(settings) as served:
        assert await start(served, sessions=[1]) == 201
        assert await start(served, sessions=[1]) == 409
        first = (await state(served))["active"]["run"]
        assert (await served.api.post(f"/identification/cancel?run={first}")).status_code == 204
        await until(lambda: served.get(IdentificationRunner)._active is None, "the fit to end")
        assert (await state(served))["last"]["problem"] == "It was cancelled."
        assert (await served.api.post("/identification/adopt")).status_code == 409
        assert await start(served, sessions=[1]) == 201
        stale = await served.api.post(f"/identification/cancel?run={first}")
        assert (stale.status_code, "This fit is over" in stale.text) == (409, True)
        assert (await state(served))["active"]["run"] != first
        assert (await served.api.post("/identification/cancel")).status_code == 204


@pytest.mark.parametrize(
    ("work", "why"),
    [
        (BROKEN, "The process of the fit has ended with exit status 3. The computer may lack memory."),
        (WRONG, "The process of the fit has ended with exit status 0. ? The computer may lack memory."),
        (QUICK, "There is no session 999; choose one from the list of sessions."),
    ],
)
async def test_a_fit_that_fails_says_why(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, work: str, why: str
) -> None:
    use(monkeypatch, tmp_path, work)

    async with serve(settings) as served:
        assert await start(served, sessions=[999]) == 201
        await until(lambda: served.get(IdentificationRunner)._active is None, "the fit to end")
        assert (await state(served))["last"]["problem"] == why


async def test_a_craft_that_robot_toml_names_is_not_replaced(settings: Settings, tmp_path: Path) -> None:
    named = tmp_path / "mine.toml"
    named.write_text('title = "Mine"\n[craft]\nmass = 2.5\n')

    async with serve(replace(settings, craft=CraftConfig(file=str(named)))) as served:
        craft = (await state(served))["craft"]
        assert (craft["title"], craft["can_undo"]) == ("Mine", False)
        assert craft["problem"].startswith(f"robot.toml names the craft file {named}.")


async def test_no_craft_is_changed_while_the_robot_is_armed(settings: Settings) -> None:
    settings.data.craft_before.write_text('title = "Before"\n')

    async with serve(settings) as served:
        served.get(Feed).deliver([state_block(0, armed=True)])
        refused = await served.api.post("/identification/undo")
        assert (refused.status_code, refused.json()["detail"]) == (
            409,
            "The robot is armed. Disarm it first.",
        )
        assert (await state(served))["craft"]["problem"] == "The robot is armed. Disarm it first."
        assert not settings.data.craft.exists()
        served.get(Feed).deliver([state_block(1, armed=False)])
        assert (await served.api.post("/identification/undo")).status_code == 200
        assert load_craft(settings.data.craft).title == "Before"
