"""Reading links: what they open, for how long, and that they open nothing else."""

import json
import time
from collections.abc import Iterator

import httpx
import pytest
from fastapi.routing import iter_route_contexts
from starlette.routing import BaseRoute
from websockets.exceptions import InvalidStatus

from robot_runtime.errors import RefusedError
from server.app import create_app
from server.http.audit import AuditLog
from server.http.sign_in.devices import DAY_SECONDS, LINKS_MAX, Devices
from server.http.sign_in.identity import SHELL
from server.http.sign_in.policy import Need, need_of
from server.platform.audit_file import read_entries
from server.platform.store import Store
from tests.server.serving import Served
from tests.server.sign_in.browsers import Browser, browser
from tests.server.sign_in.test_token_scopes import Clocks
from tests.server.waiting import until

OWN = "/api/sessions/{session}"
GIVEN = dict.fromkeys(
    ("run", "device", "layout", "profile", "panel", "mark", "name", "link", "note", "export", "sweep"), "999"
)


async def record(served: Served) -> int:
    """Record a short session; return its number."""
    number: int = (await served.api.post("/sessions", json={})).raise_for_status().json()["id"]
    (await served.api.post(f"/sessions/{number}/stop")).raise_for_status()
    return number


async def make_link(served: Served, session: int, seconds: float = 1000.0) -> httpx.Response:
    return await served.api.post(
        "/access/reading-links", json={"session": session, "ends": time.time() + seconds}
    )


async def open_link(visitor: Browser, token: str) -> httpx.Response:
    answer = await visitor.api.post("/access/read", json={"token": token})
    if answer.is_success and (secret := answer.json()["page_secret"]) is not None:
        visitor.api.headers["x-mucat"] = secret
    return answer


def operations(routes: list[BaseRoute]) -> Iterator[tuple[str, str, bool]]:
    """Method, address and whether a reader may ask, of every operation that has an address of its own."""
    for route in iter_route_contexts(routes):
        for method in sorted(getattr(route, "methods", None) or ()):
            path = str(route.path)
            if path.startswith("/api/") and ":path" not in path:
                reads = method == "GET" and path.startswith(OWN) and need_of(route) is Need.VIEWER
                yield method, path, reads or need_of(route) is Need.NOTHING


async def test_of_all_routes_only_those_that_read_its_session_answer_a_reader(served: Served) -> None:
    own, other = await record(served), await record(served)
    token = (await make_link(served, own)).raise_for_status().json()["token"]
    async with browser(served, None) as reader:
        (await open_link(reader, token)).raise_for_status()
        answered = set()
        asked = list(operations(create_app(served.settings).routes))
        for method, template, reads in asked:
            for session in (own, other) if template.startswith(OWN) else (own,):
                path = template.removeprefix("/api").format(session=session, **GIVEN)
                answer = await reader.api.request(method, path, content=b"" if method == "GET" else b"{}")
                admitted = reads and session == own
                assert (answer.status_code != 403 or "reading link opens" in answer.text) is admitted, (
                    method,
                    path,
                    answer.text[:200],
                )
                if answer.is_success and template.startswith(OWN):
                    answered.add(template)
        assert {OWN, f"{OWN}/timeline", f"{OWN}/signals"} <= answered
        assert len(asked) > 100


@pytest.mark.parametrize("name", ["{0}", "0{0}", "+{0}", " {0}", "{0}%0A", "{1}", "{1}/../{0}", "{0}/../{1}"])
async def test_no_spelling_of_another_session_s_number_opens_it(served: Served, name: str) -> None:
    own, other = await record(served), await record(served)
    token = (await make_link(served, own)).json()["token"]
    async with browser(served, None) as reader:
        await open_link(reader, token)
        answer = await reader.api.get(f"/sessions/{name.format(own, other)}")
        assert answer.status_code == (200 if name in ("{0}", "{1}/../{0}") else 403)
        if answer.is_success:
            assert answer.json()["id"] == own


async def test_a_reader_has_no_live_stream_and_the_cookie_alone_opens_pictures_only(served: Served) -> None:
    own = await record(served)
    token = (await make_link(served, own)).json()["token"]
    async with browser(served, None) as reader:
        await open_link(reader, token)
        with pytest.raises(InvalidStatus):
            async with reader.connect():
                raise AssertionError("the live socket opened")
        del reader.api.headers["x-mucat"]
        assert (await reader.api.get(f"/sessions/{own}")).status_code == 401
        # It is admitted, and finds no picture.
        assert (await reader.api.get(f"/sessions/{own}/thumbnail?time=0")).status_code == 404


async def test_a_link_ends_by_a_press_for_all_who_read_by_it(served: Served) -> None:
    own = await record(served)
    made = (await make_link(served, own)).json()
    async with browser(served, None) as reader, browser(served, None) as second:
        for visitor in (reader, second):
            await open_link(visitor, made["token"])
            assert (await visitor.api.get(f"/sessions/{own}")).status_code == 200
        [listed] = (await served.api.get(f"/access/reading-links?session={own}")).json()
        assert listed["used"] is not None
        assert listed["ended"] == ""
        number = made["link"]["id"]
        assert (await served.api.delete(f"/access/reading-links/{number}")).status_code == 204
        assert (await served.api.delete(f"/access/reading-links/{number}")).status_code == 404
        for visitor in (reader, second):
            assert (await visitor.api.get(f"/sessions/{own}")).status_code == 401
        answer = await open_link(second, made["token"])
        assert answer.status_code == 403
        assert "was ended" in answer.json()["detail"]


async def test_a_changed_or_foreign_link_is_refused_with_a_sentence(served: Served) -> None:
    token = (await make_link(served, await record(served))).json()["token"]
    async with browser(served, None) as reader:
        for wrong in (token[:-1], f"{token}A", token.swapcase(), "nonsense", "€" * 200):
            answer = await open_link(reader, wrong)
            assert answer.status_code == 403
            assert "Ask whoever gave it to you" in answer.json()["detail"]
        assert (await reader.api.post("/access/read", json={"token": "x" * 201})).status_code == 422


async def test_a_browser_that_is_signed_in_keeps_its_sign_in(served: Served) -> None:
    token = (await make_link(served, await record(served))).json()["token"]
    async with browser(served, "viewer") as viewer:
        answer = (await open_link(viewer, token)).json()
        assert (answer["page_secret"], answer["identity"]["session"]) == (None, None)
        assert (await viewer.api.get("/sessions")).status_code == 200


async def test_a_reader_signs_in_by_a_code(served: Served) -> None:
    token = (await make_link(served, await record(served))).json()["token"]
    async with browser(served, None) as reader:
        await open_link(reader, token)
        code = (await served.api.post("/access/codes", json={"role": "viewer"})).json()["code"]
        assert (await reader.pair(code)).status_code == 200
        assert (await reader.api.get("/sessions")).status_code == 200


async def test_only_sessions_that_are_there_and_ends_to_come_make_a_link(served: Served) -> None:
    assert (await make_link(served, 999)).status_code == 404
    own = await record(served)
    assert (await make_link(served, own, -1.0)).status_code == 409
    far = (await make_link(served, own, 1e9)).json()["link"]["ends"]
    assert far == pytest.approx(time.time() + 366 * DAY_SECONDS, abs=60)


async def test_links_are_no_devices(served: Served) -> None:
    number = (await make_link(served, await record(served))).json()["link"]["id"]
    assert number not in [device["id"] for device in (await served.api.get("/access/devices")).json()]
    changed = await served.api.patch(f"/access/devices/{number}", json={"role": "operator"})
    assert changed.status_code == 404
    assert (await served.api.delete(f"/access/devices/{number}")).status_code == 404


async def test_the_audit_log_names_links_and_never_their_token(served: Served) -> None:
    own = await record(served)
    made = (await make_link(served, own)).json()
    async with browser(served, None) as reader:
        await open_link(reader, made["token"])
        await reader.api.get("/sessions")
    await served.api.delete(f"/access/reading-links/{made['link']['id']}")
    folder = served.get(AuditLog).folder
    await until(
        lambda: any(entry.action == "End a reading link" for entry in read_entries(folder)), "the log"
    )
    log = (await served.api.get("/audit")).json()["entries"]
    acts = {(entry["action"], entry["who"], entry["outcome"]) for entry in log}
    reader_name, shell = f"reading link for session {own}", SHELL.name
    assert {
        ("Make a reading link for a session", shell, "done"),
        ("Open a reading link in this browser", reader_name, "done"),
        ("End a reading link", shell, "done"),
    } <= acts
    assert (reader_name, "refused") in {(who, outcome) for _, who, outcome in acts}
    assert made["token"] not in json.dumps(log)


async def test_a_link_ends_at_its_moment_and_survives_a_restart(store: Store) -> None:
    clocks = Clocks()
    devices = clocks.devices(store)
    link, token = await devices.add_link(7, clocks.utc + DAY_SECONDS)
    clocks.forward(0.99)
    again = clocks.devices(store)
    again.load()
    opened = again.find_link(token)
    assert opened is not None
    assert opened[0].session == 7
    assert again.explain_end(opened[0]) is None
    clocks.forward(0.02)
    assert "This reading link ended on 2033-05-19 at 03:33 UTC." in (again.explain_end(opened[0]) or "")
    assert again.find_valid(link.id) is None


async def test_a_session_has_so_many_links_at_most_and_they_bar_no_browser(store: Store) -> None:
    clocks = Clocks()
    devices: Devices = clocks.devices(store)
    for _ in range(LINKS_MAX):
        await devices.add_link(7, clocks.utc + DAY_SECONDS)
    with pytest.raises(RefusedError, match="50 reading links already"):
        await devices.add_link(7, clocks.utc + DAY_SECONDS)
    await devices.add_link(8, clocks.utc + DAY_SECONDS)
    assert devices.all() == []
    assert len(devices.links(7)) == LINKS_MAX


async def test_a_computer_without_a_date_makes_no_link(store: Store) -> None:
    with pytest.raises(RefusedError, match="clock of the robot's computer"):
        await Clocks(utc=100.0).devices(store).add_link(7, 200.0)
