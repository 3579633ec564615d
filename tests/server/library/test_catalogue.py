"""Sessions over HTTP: search, notes, bookmarks, deletion and its undoing."""

from typing import Any

import pytest

from server.health.monitor import HealthMonitor
from server.library.content import Recording
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import depth_block, state_block, thumbnail_block
from tests.server.serving import Served, next_text
from tests.server.waiting import until


async def record(served: Served, name: str, note: str = "") -> int:
    started = (await served.api.post("/sessions", json={"name": name, "note": note})).json()
    await served.api.post(f"/sessions/{started['id']}/stop")
    return int(started["id"])


async def names(served: Served, **query: Any) -> list[str]:
    answer = await served.api.get("/sessions", params=query)
    assert answer.status_code == 200, answer.text
    return [session["name"] for session in answer.json()]


async def test_sessions_are_found_by_words_tags_and_origin(served: Served) -> None:
    ids = [await record(served, "Hover", "im KÄLTEN Becken"), await record(served, "Dive 100%")]
    assert await names(served) == ["Dive 100%", "Hover"]
    output = {"tags": ["pool", "Bang-bang", "pool"], "name": " Hovering ", "kept": True}
    answer = await served.api.patch(f"/sessions/{ids[0]}", json=output)
    result = answer.json()
    assert (result["name"], result["tags"], result["kept"]) == ("Hovering", ["Bang-bang", "pool"], True)
    for query, expected in (
        ({"search": "kälten hover"}, ["Hovering"]),
        ({"search": "bang"}, ["Hovering"]),
        ({"search": "KA\u0308lten"}, ["Hovering"]),
        ({"search": "kalten"}, ["Hovering"]),
        ({"search": "%"}, ["Dive 100%"]),
        ({"search": "hover dive"}, []),
        ({"tag": "POOL"}, ["Hovering"]),
        ({"tag": ["pool", "sea"]}, []),
        ({"origin": "operator"}, ["Dive 100%", "Hovering"]),
        ({"origin": "arming"}, []),
    ):
        assert await names(served, **query) == expected, query
    await served.api.patch(f"/sessions/{ids[0]}", json={"tags": []})
    assert await names(served, tag="pool") == []


async def test_texts_that_somebody_else_has_changed_meanwhile_are_not_replaced_unasked(
    served: Served,
) -> None:
    session = await record(served, "Dive", "calm")
    path, base = f"/sessions/{session}", {"name": "Dive", "note": "calm", "tags": ["pool", "Sea"]}
    theirs = {"name": "Second dive", "note": "windy", "tags": ["Sea", "pool", "deep"]}
    await served.api.patch(path, json={"tags": base["tags"]})
    # What is changed from what it was is changed, also where another text has changed meanwhile.
    assert (await served.api.patch(path, json={"tags": theirs["tags"], "base": base})).status_code == 200
    assert (await served.api.patch(path, json={"name": "Second dive", "base": base})).status_code == 200
    assert (await served.api.patch(path, json={"note": "windy", "base": base})).status_code == 200
    for text, mine, message in (
        ("name", "My dive", "The name, now “Second dive”, was saved since you opened it."),
        ("note", "mine", "The note of “Second dive” was saved since you opened it."),
        ("tags", ["pool"], "A tag of “Second dive” was saved since you opened it."),
    ):
        refused = await served.api.patch(path, json={text: mine, "kept": True, "base": base})
        assert (refused.status_code, refused.json()["kind"]) == (409, "changed")
        assert message in refused.json()["detail"]
    answer = (await served.api.get(path)).json()
    assert (answer["name"], answer["note"], answer["kept"]) == ("Second dive", "windy", False)
    # The same by both is no conflict, and a program that names no base replaces any.
    same = {"name": theirs["name"], "note": theirs["note"], "tags": theirs["tags"], "base": base}
    assert (await served.api.patch(path, json=same)).status_code == 200
    assert (await served.api.patch(path, json={"note": "mine"})).json()["note"] == "mine"


async def test_a_session_in_the_bin_can_be_restored_until_it_is_purged(served: Served) -> None:
    api, first, second = served.api, await record(served, "first"), await record(served, "second")
    assert (await api.post(f"/sessions/{first}/purge")).status_code == 409
    assert (await api.delete(f"/sessions/{first}")).json()["deleted"] is not None
    assert (await names(served), await names(served, deleted=True)) == (["second"], ["first"])
    storage = (await api.get("/storage")).json()
    assert (storage["sessions"], storage["bin"]) == (1, 1)
    assert 0 < storage["database"] < storage["free"] < storage["total"]
    assert (await api.post(f"/sessions/{first}/restore")).json()["deleted"] is None
    assert await names(served) == ["second", "first"]
    await api.delete(f"/sessions/{second}")
    assert (await api.post(f"/sessions/{second}/purge")).status_code == 204
    assert (await api.get(f"/sessions/{second}")).status_code == 404
    assert (await api.post(f"/sessions/{second}/restore")).status_code == 404
    assert await names(served, deleted=True) == []


async def test_bookmarks_are_set_live_and_later(served: Served) -> None:
    api = served.api
    session = (await api.post("/sessions", json={"name": "marked"})).json()["id"]
    path = f"/sessions/{session}/markers"
    async with served.connect() as socket:
        live = (await api.post(path, json={"text": " bubbles "})).json()
        assert live["text"] == "bubbles"
        report = await next_text(socket, "session")
        while report["recording"]["markers"] == 0:
            report = await next_text(socket, "session")
    assert (await api.delete(f"/sessions/{session}")).status_code == 409
    assert (await api.post(path, json={"time": 1e6})).status_code == 409
    duration = (await api.post(f"/sessions/{session}/stop")).json()["duration"]
    assert 0 <= live["time"] <= duration
    assert "Give the time of the bookmark" in (await api.post(path, json={})).json()["detail"]
    late = (await api.post(path, json={"time": duration, "text": "end"})).json()
    changed = await api.patch(f"{path}/{late['id']}", json={"time": 0, "text": "start"})
    assert (changed.json()["time"], changed.json()["text"]) == (0, "start")
    # Whoever began from another note than there is now replaces it only if that is meant.
    stale = {"text": "begin", "base": "end"}
    refused = await api.patch(f"{path}/{late['id']}", json=stale)
    assert (refused.status_code, refused.json()["kind"]) == (409, "changed")
    assert "The note at 0.0 s was saved since you opened it." in refused.json()["detail"]
    assert (await api.patch(f"{path}/{late['id']}", json=stale | {"text": "start"})).status_code == 200
    marks = (await api.get(f"/sessions/{session}")).json()["marks"]
    assert [mark["text"] for mark in marks] == ["start", "bubbles"]
    assert (await api.delete(f"{path}/{live['id']}")).status_code == 204
    assert (await api.delete(f"{path}/{live['id']}")).status_code == 404
    other = await record(served, "other")
    assert (await api.patch(f"/sessions/{other}/markers/{late['id']}", json={})).status_code == 404
    assert (await api.get("/sessions")).json()[1]["markers"] == 1


async def test_the_note_of_a_bookmark_has_a_name_and_is_found_by_its_words(served: Served) -> None:
    session = await record(served, "dive")
    await record(served, "another")
    path = f"/sessions/{session}/markers"
    made = (await served.api.post(path, json={"time": 0, "text": "# Depth lost\n\nat the *stairs*"})).json()
    assert (made["name"], made["text"]) == ("Depth lost", "# Depth lost\n\nat the *stairs*")
    assert await names(served, search="stairs depth") == ["dive"]
    await served.api.patch(f"{path}/{made['id']}", json={"text": "nothing"})
    assert await names(served, search="stairs") == []


async def test_a_note_that_is_too_long_is_refused_with_the_most_it_may_have(served: Served) -> None:
    session = await record(served, "dive")
    path = f"/sessions/{session}/markers"
    made = (await served.api.post(path, json={"time": 0, "text": "short"})).json()
    for length, status, limit in [(10_001, 422, "10000"), (1_000_000, 413, "65536 bytes")]:
        text = "a" * length
        for answer in [
            await served.api.post(path, json={"time": 0, "text": text}),
            await served.api.patch(f"{path}/{made['id']}", json={"text": text}),
            await served.api.patch(f"/sessions/{session}", json={"note": text}),
        ]:
            assert answer.status_code == status
            assert limit in str(answer.json()["detail"])
    marks = (await served.api.get(f"/sessions/{session}")).json()["marks"]
    assert [mark["text"] for mark in marks] == ["short"]


async def test_a_session_lists_its_contents(settings: Settings, served: Served) -> None:
    served.runtime.publish(state_block(0, set_point_default=0.7))
    await until(lambda: served.get(HealthMonitor).state() is not None, "the state")
    session = (await served.api.post("/sessions", json={"name": "whole"})).json()["id"]
    now = served.container.clock.now()
    small = [thumbnail_block(n, now + n, bytes([n])) for n in range(2)]
    served.runtime.publish(depth_block(5, 10, start=now - 0.1), depth_block(20, 1, start=now))
    served.runtime.publish_bytes(b"".join(block.data for block in small))
    store = served.get(Store)

    def counts() -> dict[str, int]:
        return Recording.open(store, session).counts()

    await until(lambda: {"depth": 11, "thumbnail": 2}.items() <= counts().items(), "the samples")
    detail = (await served.api.get(f"/sessions/{session}")).json()
    assert detail["robot_state"]["set_point_default"] == 0.7
    assert detail["configuration"] == settings.config.read_text()
    assert len(detail["software"]) == 16
    (gap,) = detail["gaps"]
    assert (gap["topic"], gap["kind"], gap["missed"]) == ("depth", "missed", 5)
    topics = {topic["name"]: topic for topic in detail["topics"]}
    assert (topics["depth"]["count"], topics["thumbnail"]["kind"]) == (11, "picture")
    assert {"name": "depth", "unit": "m"}.items() <= topics["depth"]["columns"][1].items()
    picture = f"/sessions/{session}/thumbnail"
    start = find_row(store, session).started_steady
    answer = await served.api.get(picture, params={"time": now - start + 0.5})
    assert (answer.headers["content-type"], answer.content) == ("image/jpeg", b"\1")
    assert (await served.api.get(picture, params={"time": 1e6})).status_code == 404


@pytest.mark.parametrize(
    "body",
    [
        {"name": ""},
        {"name": " "},
        {"name": "x" * 101},
        {"tags": ["a,b"]},
        {"tags": [""]},
        {"tags": ["x"] * 21},
        {"kept": "perhaps"},
        {"state": "complete"},
    ],
)
async def test_invalid_descriptions_of_a_session_are_refused(body: dict[str, Any], served: Served) -> None:
    session = await record(served, "as it was")
    before = (await served.api.get(f"/sessions/{session}")).json()
    assert (await served.api.patch(f"/sessions/{session}", json=body)).status_code == 422
    assert (await served.api.get(f"/sessions/{session}")).json() == before
    assert (await served.api.patch("/sessions/99", json={"name": "x"})).status_code == 404
