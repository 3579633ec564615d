"""Missions over HTTP: the library with versions, problems by entry, kinds of steps, and trials."""

import errno
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier
from typing import Any

import pytest
from sqlalchemy import update
from sqlmodel import col

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import MissionLimits
from robot_runtime.errors import RefusedError
from robot_runtime.missions.leaf import NODES
from robot_runtime.missions.library import SHIPPED
from server.cli import main
from server.features.missions import library as library_module
from server.features.missions.library import VERSIONS_MAX, MissionLibrary, UnknownMissionError
from server.features.missions.nodes import list_node_kinds
from server.features.missions.trials import MissionTrials
from server.platform.disk_space import FileWriteError
from server.platform.edited_meanwhile import ChangedMeanwhileError
from server.platform.models import Chunk
from server.platform.runs import RunOverError
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.auto_recording import AutoRecorder
from server.recording.recorder import Recorder
from tests.runtime.missions.water import DIVE, HOLD, mission
from tests.server.analysis.dives import STARTED_STEADY, dive, record_dive
from tests.server.blocks import state_block
from tests.server.library.missions import DIVE_AT, MISSION_END, mission_blocks
from tests.server.serving import Served
from tests.server.waiting import until

OWN = mission(DIVE, HOLD)


def test_a_mission_is_kept_with_its_versions(tmp_path: Path) -> None:
    library = MissionLibrary(tmp_path / "missions", MissionLimits())
    assert [mission.name for mission in library.describe()] == list(SHIPPED)
    library.keep(OWN)
    library.keep(OWN)
    later = mission(HOLD, DIVE)
    library.keep(later)
    assert library.texts()["test"] == later
    assert [(version.version, version.text) for version in library.versions("test")] == [(2, later), (1, OWN)]
    own = library.describe()[-1]
    assert (own.name, own.shipped, own.versions) == ("test", False, 2)
    for number in range(VERSIONS_MAX):
        library.keep(OWN + f"# {number}\n")
    assert [version.version for version in library.versions("test")][-1] == 3
    assert len(library.versions("test")) == VERSIONS_MAX


def test_two_who_store_a_mission_at_once_make_two_versions(tmp_path: Path) -> None:
    texts = [OWN + f"# {number}\n" for number in range(8)]
    ready = Barrier(len(texts))

    def keep(text: str) -> None:
        library = MissionLibrary(tmp_path / "missions", MissionLimits())
        ready.wait()
        library.keep(text)

    with ThreadPoolExecutor(len(texts)) as people:
        list(people.map(keep, texts))
    versions = MissionLibrary(tmp_path / "missions", MissionLimits()).versions("test")
    assert [version.version for version in versions] == [8, 7, 6, 5, 4, 3, 2, 1]
    assert {version.text for version in versions} == {*texts}


def test_a_version_that_somebody_has_stored_meanwhile_is_not_replaced_unasked(tmp_path: Path) -> None:
    library = MissionLibrary(tmp_path / "missions", MissionLimits())
    library.keep(OWN, "Ann", base="")
    mine, theirs = mission(HOLD, DIVE), mission(HOLD)
    opened = library.describe()[-1].mark
    library.keep(theirs, "Ben", base=opened)
    with pytest.raises(ChangedMeanwhileError, match="The mission test was saved by Ben since you opened it"):
        library.keep(mine, "Ann", base=opened)
    with pytest.raises(ChangedMeanwhileError):
        library.keep(mine, "Ann", base="")
    library.keep(mine, "Ann", base=library.describe()[-1].mark)
    assert [version.author for version in library.versions("test")] == ["Ann", "Ben", "Ann"]
    opened = library.describe()[-1].mark
    library.delete("test")
    with pytest.raises(ChangedMeanwhileError, match="was deleted"):
        library.keep(theirs, "Ben", base=opened)
    assert "test" not in library.texts()


def test_a_mission_deleted_while_it_is_stored_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    ready = Barrier(9)

    def change(number: int) -> bool:
        library = MissionLibrary(tmp_path / "missions", MissionLimits())
        ready.wait()
        if number:
            library.keep(OWN + f"# {number}\n")
            return True
        try:
            library.delete("test")
        except UnknownMissionError:
            return False
        return True

    MissionLibrary(tmp_path / "missions", MissionLimits()).keep(OWN)
    with ThreadPoolExecutor(9) as people:
        assert all(people.map(change, range(9)))
    folder = tmp_path / "missions" / "test"
    results = sorted(int(path.stem) for path in folder.glob("*.toml")) if folder.exists() else []
    assert results == list(range(1, len(results) + 1))
    assert [path.name for path in folder.parent.iterdir()] == (["test"] if results else [])


def test_a_full_disk_is_told_as_such(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(library_module, "write_whole", fail)
    with pytest.raises(FileWriteError, match="is full") as refused:
        MissionLibrary(tmp_path / "missions", MissionLimits()).keep(OWN)
    assert refused.value.status == 507


def test_a_listing_reads_each_mission_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    library = MissionLibrary(tmp_path / "missions", MissionLimits())
    for number in range(3):
        library.keep(OWN.replace('"test"', f'"test{number}"'))
    read: list[Path] = []
    whole = library_module._read

    def count(path: Path) -> str | None:
        read.append(path)
        return whole(path)

    monkeypatch.setattr(library_module, "_read", count)
    assert len(library.describe()) == len(SHIPPED) + 3
    assert len(read) == 3


def test_a_mission_of_ones_own_is_deleted_with_its_versions(tmp_path: Path) -> None:
    library = MissionLibrary(tmp_path / "missions", MissionLimits())
    library.keep(OWN)
    library.keep(mission(HOLD, DIVE))
    library.delete("test")
    assert list(library.texts()) == list(SHIPPED)
    for name in ("test", "../missions", ""):
        with pytest.raises(UnknownMissionError):
            library.delete(name)
    with pytest.raises(RefusedError, match="ships with the program"):
        library.delete("two_depths")
    assert (tmp_path / "missions").is_dir()


def test_what_is_not_valid_or_ships_is_not_kept(tmp_path: Path) -> None:
    library = MissionLibrary(tmp_path / "missions", MissionLimits(depth=0.5))
    with pytest.raises(ConfigError, match=r"goes to 0.6 m, and the depth is limited to 0.5 m"):
        library.keep(OWN)
    with pytest.raises(RefusedError, match="ships with the program"):
        library.keep(mission(HOLD).replace('"test"', '"two_depths"'))
    with pytest.raises(UnknownMissionError):
        library.versions("../test")
    assert not (tmp_path / "missions").exists()


def test_every_leaf_and_branch_is_listed_with_its_limits() -> None:
    kinds = {kind.do: kind for kind in list_node_kinds()}
    assert kinds.keys() == NODES.keys()
    depth = kinds["dive"].fields[0]
    assert (depth.name, depth.kind, depth.minimum, depth.maximum, depth.unit) == (
        "depth",
        "number",
        0,
        10,
        "m",
    )
    assert kinds["turn"].fields[0].minimum == pytest.approx(-3.1416, abs=1e-4)
    assert kinds["repeat"].branch
    assert kinds["set"].fields[1].kind == "value"
    assert all(kind.meaning for kind in kinds.values())


async def test_the_page_is_told_problems_by_entry_and_keeps_missions(served: Served) -> None:
    check: dict[str, Any] = (await served.api.post("/missions/check", json={"text": OWN})).json()
    assert check["problems"] == []
    assert [step["path"] for step in check["summary"]["steps"]] == ["", "1", "2"]
    bad = mission("{ do = 'repeat', times = 0, steps = [{ do = 'fly' }] }")
    check = (await served.api.post("/missions/check", json={"text": bad})).json()
    paths = [problem["path"] for problem in check["problems"]]
    assert paths == [["mission", "steps", 0, "times"], ["mission", "steps", 0, "steps", 0, "do"]]
    assert (await served.api.post("/missions", json={"text": OWN})).status_code == 201
    versions = (await served.api.get("/missions/versions/test")).json()
    assert [version["text"] for version in versions] == [OWN]
    assert (await served.api.get("/missions/state")).json() is None
    started = await served.api.post("/missions/start", json={"text": bad})
    assert started.status_code == 422


async def test_a_trial_tells_the_outcome_of_each_seed(settings: Settings) -> None:
    trials = MissionTrials(settings)
    trials.start("test", mission(DIVE, "{ do = 'wait_for', sees = 'red', timeout = 1 }"), {}, 2)
    with pytest.raises(RefusedError, match="A trial is running"):
        trials.start("test", OWN, {}, 1)
    await trials.wait()
    state = trials.state()
    assert (state.running, state.problem) == (False, "")
    assert [(result.seed, result.phase, result.failed) for result in state.results] == [
        (1, "failed", "2"),
        (2, "failed", "2"),
    ]
    assert all(0.5 < result.deepest < 0.75 for result in state.results)
    assert all(2 * result.elapsed == pytest.approx(len(result.curve), abs=2) for result in state.results)
    assert all(max(result.curve) == pytest.approx(result.deepest, abs=0.06) for result in state.results)
    trials.start("test", OWN + "[trial]\nseed = 4\n", {}, 1)
    await trials.wait()
    assert "trial.seed is the trial's own" in trials.state().problem
    earlier = trials.state().run
    trials.start("test", OWN, {}, 100)
    with pytest.raises(RunOverError, match="This trial is over"):
        trials.cancel(earlier)
    trials.cancel(trials.state().run)
    await trials.wait()
    assert trials.state().problem == "It was cancelled."
    with pytest.raises(RefusedError, match="No trial is running"):
        trials.cancel()
    json.loads(trials.state().model_dump_json())


async def test_a_trial_that_fails_says_so(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")

    trials = MissionTrials(settings)
    trials.start("test", OWN, {}, 1)
    await trials.wait()
    assert trials.state().problem == "The simulation has ended with exit status 1."
    assert not trials.state().running


async def test_the_session_that_a_mission_starts_names_who_started_it(served: Served) -> None:
    started = await served.api.post("/missions/start", json={"text": OWN})
    assert (started.status_code, served.runtime.asked[-1][0]) == (201, "mission")
    served.runtime.publish(state_block(0, armed=True))
    recorder = served.get(Recorder)
    await until(lambda: recorder.session is not None, "the session to begin")
    await served.get(AutoRecorder).close()
    assert recorder.session is not None
    session = recorder.session.id
    await recorder.stop(session)
    timeline = (await served.api.get(f"/sessions/{session}/timeline")).json()
    answer = "“the shell of this computer” started a mission."
    assert answer in [event["text"] for event in timeline["events"]]


async def test_a_check_names_what_the_robot_s_vision_settings_cannot_see(served: Served) -> None:
    async def unseen(text: str) -> list[str]:
        answer = (await served.api.post("/missions/check", json={"text": text})).json()
        assert answer["problems"] == []
        return list(answer["unseen"])

    typo = mission("{ do = 'wait_for', sees = 'purpel', timeout = 9 }")
    (output,) = await unseen(typo)
    assert output.startswith("Step 1: Nothing is called 'purpel'; there are red,")
    assert await unseen(mission("{ do = 'wait_for', sees = 'red', timeout = 9 }")) == []
    assert await unseen(OWN) == []
    # Those in force decide, not those of a file.
    served.runtime.vision["colours"]["purpel"] = served.runtime.vision["colours"]["red"]
    assert await unseen(typo) == []


def test_the_shell_s_check_names_what_the_camera_would_never_see(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "typo.toml"
    file.write_text(mission("{ do = 'wait_for', sees = 'purpel', timeout = 9 }"))
    common = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert main(["mission", "check", str(file), *common]) == 0
    assert "Step 1: Nothing is called 'purpel'; there are red," in capsys.readouterr().out
    assert main(["mission", "check", "search_marker", *common]) == 0
    assert "Choose their dictionary in the vision settings." in capsys.readouterr().out
    assert main(["mission", "check", "follow_colour", *common]) == 0
    assert "would not begin" not in capsys.readouterr().out


async def test_a_check_has_the_plan_of_a_valid_mission(served: Served) -> None:
    check = (await served.api.post("/missions/check", json={"text": OWN})).json()
    assert [(step["path"], step["end_depth"], step["known"]) for step in check["plan"]["steps"]] == [
        ("1", 0.6, True),
        ("2", 0.6, True),
    ]
    assert check["plan"]["complete"]
    assert (await served.api.post("/missions/check", json={"text": "a ="})).json()["plan"] is None


async def test_the_runs_of_a_mission_come_from_the_sessions_that_held_it(
    served: Served, settings: Settings
) -> None:
    store = served.get(Store)
    first = await record_dive(store, settings, [*dive(), *mission_blocks()])
    await record_dive(store, settings, dive())
    twice = await record_dive(store, settings, [*dive(), *mission_blocks(), *mission_blocks(shift=3.5)])
    for _ in range(2):
        runs = (await served.api.get("/missions/runs/look")).json()
        assert [run["session"]["id"] for run in runs] == [twice, twice, first]
    last = runs[-1]
    assert (last["start"], last["end"]) == (DIVE_AT - STARTED_STEADY, MISSION_END - STARTED_STEADY)
    assert (last["phase"], last["deepest"]) == ("failed", 0.61)
    assert (await served.api.get("/missions/runs/other")).json() == []
    (await served.api.delete(f"/sessions/{twice}")).raise_for_status()
    third = await record_dive(store, settings, [*dive(), *mission_blocks()])
    damage = update(Chunk).where(col(Chunk.topic) == "mission", col(Chunk.session_id) == third)
    await store.execute(damage.values(data=b"no chunk"))
    # What cannot be read is left out.
    assert [run["session"]["id"] for run in (await served.api.get("/missions/runs/look")).json()] == [first]
