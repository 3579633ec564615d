"""Parameters over HTTP: changes with their authors, undo, profiles and their files."""

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any, cast

import pytest

from robot_runtime.contract.commands import ParametersCommand, SteeringCommand
from server.driving.changes import Changes, Send
from server.driving.profiles import ProfileError, read_file
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.platform.store import Store, StoreError
from tests.server.blocks import state_block
from tests.server.serving import Served, serve
from tests.server.waiting import until

LISTED: list[dict[str, Any]] = [
    {"name": "depth.pid.kp", "value": 3.0},
    {"name": "vision.colour", "value": "red"},
]


@pytest.fixture
async def served(settings: Settings) -> AsyncIterator[Served]:
    async with serve(settings) as served:
        await served.heard("stream")
        served.runtime.publish(state_block(0))
        await until(served.get(HealthMonitor).state, "the state")
        await served.reached()
        whole: dict[str, Any] = {
            "type": "number",
            "default": 0,
            "minimum": 0,
            "maximum": 9,
            "unit": "",
            "meaning": "",
        }
        whole |= {"choices": [], "where": "runtime", "while_armed": True, "pending": False}
        served.runtime.parameters["parameters"] = [whole | parameter for parameter in LISTED]
        yield served


async def change(served: Served, before: float, after: float) -> None:
    served.runtime.answer = {"changed": {"depth.pid.kp": [before, after]}}
    answer = await served.api.post("/robot/commands/parameters", json={"values": {"depth.pid.kp": after}})
    assert answer.raise_for_status().json()["changed"] == [
        {"name": "depth.pid.kp", "before": before, "after": after}
    ]


async def test_changes_are_listed_with_who_made_them_and_undone_one_by_one(served: Served) -> None:
    await change(served, 3.0, 4.0)
    served.runtime.answer = {"changed": {"control.steering": ["none", "beacons"]}}
    (await served.api.post("/robot/commands/steering", json={"by": "beacons"})).raise_for_status()
    newest, first = (await served.api.get("/parameters/changes")).json()
    assert [change["who"] for change in (newest, first)] == ["the shell of this computer"] * 2
    assert (newest["undoable"], first["undoable"]) == (True, False)

    # Only the newest, which the page has seen.
    assert (await served.api.post("/parameters/undo", json={"change": first["id"]})).status_code == 409
    (await served.api.post("/parameters/undo", json={"change": newest["id"]})).raise_for_status()
    assert served.runtime.asked[-1] == (
        "parameters",
        {"values": {"control.steering": "none"}, "expected": {"control.steering": "beacons"}},
    )
    newest, first = (await served.api.get("/parameters/changes")).json()
    assert (newest["undone"], newest["undoable"], first["undoable"]) == (
        "the shell of this computer",
        False,
        True,
    )

    served.runtime.refusal = "depth.pid.kp is 7.0 now, and not 4.0 any more"
    refused = await served.api.post("/parameters/undo", json={"change": first["id"]})
    assert (refused.status_code, refused.json()["detail"]) == (409, served.runtime.refusal)
    assert (await served.api.get("/parameters/changes")).json()[1]["undoable"]

    served.runtime.refusal = None
    (await served.api.post("/parameters/undo", json={"change": first["id"]})).raise_for_status()
    over = await served.api.post("/parameters/undo", json={"change": first["id"]})
    assert "no change to undo" in over.json()["detail"]


class OneParameter:
    """A robot with one parameter, in place of the bridge; `stored` delays every second write."""

    run = "run"

    def __init__(self, store: Store) -> None:
        self.value, self.writes = 0.0, 0
        self._write = store.write

    async def command(self, _: str, payload: dict[str, Any]) -> dict[str, Any]:
        before, (self.value,) = self.value, payload["values"].values()
        return {"changed": {"p": [before, self.value]}}

    async def write(self, *arguments: Any, **options: Any) -> Any:
        self.writes += 1
        for _ in range(20 * (self.writes % 2)):
            await asyncio.sleep(0)
        return await self._write(*arguments, **options)


async def test_changes_made_at_once_are_in_the_history_in_the_robot_s_order(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = OneParameter(store)
    monkeypatch.setattr(store, "write", robot.write)
    changes = Changes(store, cast(Any, robot))
    await asyncio.gather(
        *(changes.command("Ann", ParametersCommand(values={"p": float(n)})) for n in range(1, 9))
    )
    listed = changes.newest()
    assert [change.values[0].after for change in reversed(listed)] == [float(n) for n in range(1, 9)]
    for item in listed:
        await changes.undo("Ben", item.id)
    assert robot.value == 0.0


async def test_an_undo_that_cannot_be_stored_is_done_and_the_one_before_it_can_follow(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(_: object) -> None:
        raise StoreError("The disk is full.")

    async with serve(settings) as served:
        await change(served, 2.0, 3.0)
        await change(served, 3.0, 4.0)
        newest, first = (await served.api.get("/parameters/changes")).json()
        with monkeypatch.context() as full:
            full.setattr(served.get(Store), "write", fail)
            answer = await served.api.post("/parameters/undo", json={"change": newest["id"]})
        assert answer.raise_for_status().json()["changed"][0]["after"] == 3.0
        listed = (await served.api.get("/parameters/changes")).json()
        assert [(change["undone"] != "", change["undoable"]) for change in listed] == [
            (True, False),
            (False, True),
        ]
        (await served.api.post("/parameters/undo", json={"change": first["id"]})).raise_for_status()


async def test_gains_and_vision_settings_are_in_the_history_and_undone(served: Served) -> None:
    await change(served, 3.0, 4.0)
    served.runtime.answer = {"changed": {"depth.pid.kp": [4.0, 6.5]}}
    proposed = {"name": "depth", "controller": "pid", "gains": {"kp": 6.5}}
    (await served.api.post("/robot/commands/loop", json=proposed)).raise_for_status()
    served.runtime.answer = {"changed": {"vision.colour": ["red", "green"]}}
    looks = (await served.api.get("/vision")).json()["settings"]
    (
        await served.api.post("/robot/commands/vision_settings", json=looks | {"colour": "green"})
    ).raise_for_status()

    listed = (await served.api.get("/parameters/changes")).json()
    assert [(change["values"][0]["name"], change["values"][0]["after"]) for change in listed] == [
        ("vision.colour", "green"),
        ("depth.pid.kp", 6.5),
        ("depth.pid.kp", 4.0),
    ]
    for item, before in zip(listed, ("red", 4.0, 3.0), strict=True):
        (await served.api.post("/parameters/undo", json={"change": item["id"]})).raise_for_status()
        assert list(served.runtime.asked[-1][1]["values"].values()) == [before]


async def test_parameters_that_a_scenario_left_changed_are_in_the_history(served: Served) -> None:
    changes, swim = served.get(Changes), SteeringCommand(by="beacons")

    async def tuned(before: float, after: float, send: Send) -> None:
        served.runtime.answer = {"changed": {"depth.pid.kp": [before, after]}}
        await send(swim)

    async def listed() -> list[tuple[str, str, float, float]]:
        answer = (await served.api.get("/parameters/changes")).json()
        values = [(change["who"], change["why"], change["values"][0]) for change in answer]
        return [(who, why, value["before"], value["after"]) for who, why, value in values]

    await change(served, 2.0, 3.0)
    async with changes.together("Anna", "Scenario “Dive”") as send:
        await tuned(3.0, 9.0, send)
        await tuned(9.0, 3.0, send)
    shell = "the shell of this computer"
    assert await listed() == [(shell, "", 2.0, 3.0)]

    async with changes.together("Anna", "Scenario “Dive”") as send:
        await tuned(3.0, 9.0, send)
        await change(served, 9.0, 5.0)
        await tuned(5.0, 3.0, send)
    assert (await listed())[:-1] == [
        ("Anna", "Scenario “Dive”", 5.0, 3.0),
        (shell, "", 9.0, 5.0),
        ("Anna", "Scenario “Dive”", 3.0, 9.0),
    ]


@pytest.mark.parametrize(
    "body",
    [
        '{"values": {"depth.pid.kp": NaN}}',
        '{"values": {"depth.pid.kp": Infinity}}',
        '{"values": {"depth.pid.kp": null}}',
        '{"values": {"depth.pid.kp": [1]}}',
        '{"values": {}}',
        '{"values": [1]}',
        '{"values": {"depth.pid.kp": 1}, "partly": 2}',
        '{"values": {"depth.pid.kp": 1}, "whole": true}',
        "{}",
        "no JSON",
    ],
)
async def test_an_invalid_value_does_not_reach_the_runtime(body: str, served: Served) -> None:
    answer = await served.api.post(
        "/robot/commands/parameters", content=body, headers={"content-type": "application/json"}
    )
    assert answer.status_code == 422
    assert [name for name, _ in served.runtime.asked] == []


async def test_a_profile_is_stored_downloaded_uploaded_restored_and_deleted(served: Served) -> None:
    saved = (await served.api.post("/profiles", json={"name": " calm ", "note": "pool"})).json()
    assert (saved["name"], saved["values"]) == ("calm", {"depth.pid.kp": 3.0, "vision.colour": "red"})
    again = await served.api.post("/profiles", json={"name": "calm"})
    assert (again.status_code, "already" in again.json()["detail"]) == (409, True)

    file = await served.api.get(f"/profiles/{saved['id']}/file")
    assert 'filename="profile-calm.json"' in file.headers["content-disposition"]
    text = file.text.replace('"calm"', '"from elsewhere"').replace("vision.colour", "vision.hue")
    taken = (await served.api.post("/profiles/file", json={"text": text})).raise_for_status().json()
    assert taken["unknown"] == ["vision.hue"]
    assert [profile["name"] for profile in (await served.api.get("/profiles")).json()] == [
        "calm",
        "from elsewhere",
    ]

    served.runtime.answer = {
        "changed": {"depth.pid.kp": [5.0, 3.0]},
        "left_out": {"vision.hue": "there is no parameter 'vision.hue'"},
    }
    restored = await served.api.post(f"/profiles/{taken['profile']['id']}/restore")
    assert restored.raise_for_status().json()["left_out"] == [
        {"name": "vision.hue", "why": "there is no parameter 'vision.hue'"}
    ]
    assert served.runtime.asked[-1] == (
        "parameters",
        {"values": {"depth.pid.kp": 3.0, "vision.hue": "red"}, "partly": True},
    )
    assert (await served.api.get("/parameters/changes")).json()[0]["why"] == "Profile “from elsewhere”"

    (await served.api.delete(f"/profiles/{saved['id']}")).raise_for_status()
    assert (await served.api.delete(f"/profiles/{saved['id']}")).status_code == 404
    assert (await served.api.post(f"/profiles/{saved['id']}/restore")).status_code == 404


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("no JSON", "it is not JSON"),
        ("[1]", "it has no format"),
        ("{}", "it has no format"),
        (
            {"format": 2, "version": "9.1"},
            "is a profile of format 2, written by version 9.1 of µ-CAT. This is",
        ),
        ({"format": True, "name": "a", "parameters": {}}, "format True"),
        ({"format": 1, "name": "a"}, "parameters: Field required"),
        ({"format": 1, "name": "", "parameters": {}}, "name: String should have at least 1"),
        ({"format": 1, "name": "a", "parameters": {"x": [1]}}, "parameters.x"),
        ({"format": 2, "name": "Later", "parameters": {}}, "is a profile of format 2. This is version"),
        ('{"format": 1, "name": "a", "parameters": {"x": NaN}}', "holds NaN in line 1"),
        (
            '{"format": 1, "name": "Twice",\n"parameters": {"depth.pid.kp": 2.0, "depth.pid.kp": 40.0}}',
            "names the key 'depth.pid.kp' twice, the second time in line 2",
        ),
        ("[" * 100_000, "it is not JSON"),
    ],
)
def test_a_file_that_is_no_profile_of_this_version_is_refused_with_the_reason(
    content: dict[str, Any] | str, why: str
) -> None:
    text = content if isinstance(content, str) else json.dumps(content)
    with pytest.raises(ProfileError) as refused:
        read_file(text)
    assert why in str(refused.value)


def test_unknown_entries_of_the_same_format_are_ignored() -> None:
    text = json.dumps(
        {"format": 1, "name": "a", "mood": "calm", "parameters": {"x": 1, "y": "red", "z": True}}
    )
    assert read_file(text).parameters == {"x": 1, "y": "red", "z": True}
