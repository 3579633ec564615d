"""Scopes and ends of tokens, and the end of browsers that nobody uses."""

import sqlite3
from contextlib import closing, suppress
from dataclasses import dataclass

import pytest
from websockets.exceptions import ConnectionClosed

from robot_runtime.errors import RefusedError
from server.http.sign_in.access import Access
from server.http.sign_in.devices import DAY_SECONDS, Devices
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.serving import Served, next_text
from tests.server.sign_in.browsers import browser, closing_of


@dataclass
class Clocks:
    """The date and the steady clock of a computer, s."""

    utc: float = 2e9
    steady: float = 0.0

    def forward(self, days: float) -> None:
        self.utc += days * DAY_SECONDS
        self.steady += days * DAY_SECONDS

    def devices(self, store: Store) -> Devices:
        return Devices(store, lambda: self.utc, lambda: self.steady)


async def test_a_token_operates_or_administers_as_its_scope_says(served: Served) -> None:
    async with browser(served, None) as program:
        for scope, statuses in (
            ("read", (200, 403, 403, 403)),
            ("operate", (200, 200, 403, 403)),
            ("administer", (200, 200, 201, 200)),
        ):
            made = await served.api.post("/access/tokens", json={"name": scope, "scope": scope})
            token, device = made.json()["token"], made.json()["device"]["id"]
            headers = {"authorization": f"Bearer {token}"}
            answers = [
                await program.api.request(method, path, json=body, headers=headers)
                for method, path, body in (
                    ("GET", "/access/me", None),
                    ("POST", "/control/take?over=true", None),
                    ("POST", "/access/codes", {}),
                    ("PATCH", f"/access/devices/{device}", {"name": "renamed"}),
                )
            ]
            assert tuple(answer.status_code for answer in answers) == statuses, scope
            if scope == "operate":
                assert "“administer”" in answers[2].json()["detail"]


async def test_an_operator_s_role_does_not_widen_the_scope_of_a_token(served: Served) -> None:
    made = (await served.api.post("/access/tokens", json={"name": "logger"})).json()
    position = f"/access/devices/{made['device']['id']}"
    assert (await served.api.patch(position, json={"role": "operator"})).json()["limited"]
    headers = {"authorization": f"Bearer {made['token']}"}
    async with browser(served, None) as program:
        assert (await program.api.post("/control/take?over=true", headers=headers)).status_code == 200
        assert (await program.api.post("/access/codes", json={}, headers=headers)).status_code == 403


async def test_a_token_is_refused_in_words_after_its_end_and_its_live_socket_closes(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    made = (await served.api.post("/access/tokens", json={"name": "logger"})).json()
    device = served.get(Access).devices.get(made["device"]["id"])
    assert device.ends == pytest.approx(device.paired + 90 * DAY_SECONDS)
    headers = {"authorization": f"Bearer {made['token']}"}
    with monkeypatch.context() as soon:
        soon.setattr(Devices, "count_seconds", lambda *_: 0.0)
        async with served.connect(additional_headers=headers) as socket:
            with suppress(ConnectionClosed):
                await socket.send('{"op": "ping", "id": 1}')
            with pytest.raises(ConnectionClosed):
                await next_text(socket, "pong")
            assert await closing_of(socket) == (1008, "This token has ended.")
    device.ends = device.paired
    async with browser(served, None) as program:
        answer = await program.api.get("/robot", headers=headers)
    assert answer.status_code == 401
    assert answer.json()["detail"].startswith("This token ended on 20")
    assert "make a new one under people" in answer.json()["detail"].lower()
    (listed,) = (await served.api.get("/access/devices")).json()
    assert listed["ended"] == answer.json()["detail"]
    monkeypatch.setattr(served.get(Access).devices, "_utc", lambda: 300.0)
    (listed,) = (await served.api.get("/access/devices")).json()
    assert listed["ended"].startswith("The clock of the robot's computer has not been set")


async def test_a_token_never_ends_only_where_that_is_chosen(store: Store) -> None:
    clocks = Clocks()
    devices = clocks.devices(store)
    short, _ = await devices.add_program("short", "read", 2)
    ever, _ = await devices.add_program("ever", "read", None)
    clocks.forward(1.99)
    assert devices.find_valid(short.id) is short
    remaining = devices.count_seconds(short.id), devices.count_seconds(ever.id), devices.count_seconds(0)
    assert remaining == (pytest.approx(0.01 * DAY_SECONDS), None, None)
    clocks.forward(0.01)
    assert devices.find_valid(short.id) is None
    clocks.forward(10_000)
    assert devices.find_valid(ever.id) is ever


async def test_a_browser_ends_after_90_days_without_use(store: Store) -> None:
    clocks = Clocks()
    devices = clocks.devices(store)
    tablet, _ = await devices.add_browser("tablet", "operator")
    for _ in range(3):
        clocks.forward(89)
        assert devices.find_valid(tablet.id) is tablet
        devices.see(tablet)
    await devices.close()
    again = clocks.devices(store)
    again.load()
    assert [operator.id for operator in again.operators] == [tablet.id]
    clocks.forward(90.01)
    assert again.find_valid(tablet.id) is None
    assert again.operators == []
    reason = again.explain_end(again.get(tablet.id))
    assert reason is not None
    assert reason.startswith("This browser was not used for 90 days")


async def test_a_browser_in_use_survives_that_the_computer_learns_the_date(store: Store) -> None:
    clocks = Clocks()
    devices = clocks.devices(store)
    tablet, _ = await devices.add_browser("tablet", "operator")
    devices.see(tablet)
    clocks.utc += 1000 * DAY_SECONDS
    assert devices.find_valid(tablet.id) is tablet
    await devices.close()


async def test_a_browser_that_was_used_before_the_clock_was_set_stays_signed_in(store: Store) -> None:
    clocks = Clocks(utc=300.0)
    devices = clocks.devices(store)
    tablet, _ = await devices.add_browser("tablet", "operator")
    # The next start of the computer has a network, and with it the date.
    again = Clocks().devices(store)
    again.load()
    assert again.find_valid(tablet.id) is not None


async def test_while_the_clock_is_not_set_no_token_counts_that_ends(store: Store) -> None:
    clocks = Clocks()
    devices = clocks.devices(store)
    (short, _), (ever, _) = [
        await devices.add_program(*program) for program in (("a", "read", 2), ("b", "read", None))
    ]
    clocks.utc = 300.0
    assert (devices.find_valid(short.id), devices.find_valid(ever.id)) == (None, ever)
    reason = devices.explain_end(short)
    assert reason is not None
    assert reason.startswith("The clock of the robot's computer has not been set")
    with pytest.raises(RefusedError, match="make a token that never ends"):
        await devices.add_program("c", "read", 2)
    await devices.add_program("d", "read", None)
    clocks.utc = 2e9 + DAY_SECONDS
    assert devices.find_valid(short.id) is short


def test_tokens_of_the_last_version_keep_their_rights_and_never_end(settings: Settings, store: Store) -> None:
    with closing(sqlite3.connect(settings.data.database)) as database:
        database.execute(
            "INSERT INTO device (name, role, kind, secret, paired, seen) "
            "VALUES ('old', 'operator', 'program', 'x', 0, 0)"
        )
        database.commit()
    devices = Devices(store)
    devices.load()
    (old,) = devices.all()
    assert (old.role, old.limited, old.ends, devices.explain_end(old)) == ("operator", False, None, None)
