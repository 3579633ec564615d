"""Sign-in, roles and revocation over HTTP."""

import asyncio
import json
import sqlite3
from contextlib import closing
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection
from websockets.exceptions import InvalidStatus

from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import read_blocks
from server.health.monitor import HealthMonitor
from server.http.sign_in.access import Access
from server.http.sign_in.devices import Devices
from server.http.sign_in.pairing_codes import PairingCodes
from server.platform.settings import Settings
from server.platform.store import Store
from server.stream.hub import Hub
from tests.server.blocks import state_block
from tests.server.serving import Served, next_text, serve
from tests.server.sign_in.browsers import browser, closing_of, new_code
from tests.server.waiting import SECONDS, until


async def test_every_operation_needs_a_sign_in(served: Served) -> None:
    async with browser(served, None) as stranger:
        for method, path in (("GET", "/robot"), ("POST", "/robot/stop"), ("GET", "/nowhere")):
            answer = await stranger.api.request(method, path)
            assert (answer.status_code, answer.headers["www-authenticate"]) == (401, "Bearer")
            assert "mucat pair" in answer.json()["detail"]
        assert served.runtime.asked == []
        with pytest.raises(InvalidStatus):
            await stranger.connect()
        me = (await stranger.api.get("/access/me")).json()
        assert me == {
            "signed_in": False,
            "robot": "tested",
            "identity": None,
            "ended": "",
            "pairing_open": False,
            "operators_only": [],
            "ends": None,
            "lab": False,
        }


async def test_everybody_may_ask_whether_the_robot_works_and_learns_nothing_more(
    monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    async with browser(served, None) as stranger:
        served.get(HealthMonitor).see(state_block(0))
        answer = await stranger.api.get("/alive")
        assert (answer.status_code, answer.content) == (204, b"")
        # No write that succeeds meanwhile ends it.
        failing = property(lambda _: "the disk is full", lambda *_: None)
        monkeypatch.setattr(Store, "failing", failing, raising=False)
        answer = await stranger.api.get("/alive")
        assert answer.status_code == 503
        assert "disk" not in answer.text


async def test_a_body_is_not_read_without_a_sign_in(served: Served) -> None:
    port = served.settings.server.port
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    head = f"POST /api/imports HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 1000000\r\n\r\n"
    writer.write(head.encode())
    async with asyncio.timeout(SECONDS):
        assert b" 401 " in await reader.readline()
    writer.close()


async def test_a_code_signs_a_browser_in_with_an_http_only_cookie(served: Served) -> None:
    code = await new_code(served, "operator")
    async with browser(served, None, "bench laptop") as visitor:
        assert (await visitor.api.get("/access/me")).json()["pairing_open"]
        answer = await visitor.pair(code)
        identity: dict[str, object] = {"device": 1, "name": "bench laptop", "role": "operator"}
        identity |= {"kind": "browser", "limited": False, "session": None}
        assert (answer.status_code, answer.json()["identity"]) == (200, identity)
        name, _, rest = answer.headers["set-cookie"].partition("=")
        assert name == f"mucat_{served.settings.server.port}"
        output = {part.strip().lower() for part in rest.split(";")[1:]}
        assert {"httponly", "samesite=strict", "path=/"} <= output
        assert not {part for part in output if part.startswith("domain")}
        assert (await visitor.api.get("/robot")).status_code == 503
        async with visitor.connect() as socket:
            you = (await next_text(socket, "hello"))["you"]
            assert (you["name"], you["role"]) == ("bench laptop", "operator")
        again = await visitor.pair(code)
        assert (again.status_code, "not valid" in again.json()["detail"]) == (403, True)


async def test_only_hashes_are_stored(settings: Settings, served: Served) -> None:
    async with browser(served, "operator") as visitor:
        token = (await served.api.post("/access/tokens", json={"name": "script"})).json()["token"]
        secrets = [*visitor.api.cookies.values(), token, settings.data.token.read_text().strip()]
        secrets.append(visitor.api.headers["x-mucat"])
        listed = (await visitor.api.get("/access/devices")).text
    with closing(sqlite3.connect(settings.data.database)) as database:
        stored = "\n".join(database.iterdump())
    assert "script" in stored
    assert not [secret for secret in secrets if secret in stored or secret in listed]
    assert len(secrets) == 4
    assert settings.data.token.stat().st_mode & 0o777 == 0o600


async def test_pairings_survive_a_restart_and_the_shell_token_does_not(settings: Settings) -> None:
    async with serve(settings) as served, browser(served, "viewer") as visitor:
        cookies, page_secret = dict(visitor.api.cookies), visitor.api.headers["x-mucat"]
        token = settings.data.token.read_text()
        made = (await served.api.post("/access/tokens", json={"name": "script"})).json()["token"]
    async with serve(settings) as served, browser(served, None) as visitor:
        (secret,) = cookies.values()
        visitor.api.cookies.set(f"mucat_{served.settings.server.port}", secret)
        assert (await visitor.api.get("/access/me")).json()["identity"] is None
        visitor.api.headers["x-mucat"] = page_secret
        assert (await visitor.api.get("/access/me")).json()["identity"]["role"] == "viewer"
        old = {"authorization": f"Bearer {token.strip()}"}
        assert (await visitor.api.get("/access/me", headers=old)).json()["identity"] is None
        program = {"authorization": f"Bearer {made}"}
        me = (await visitor.api.get("/access/me", headers=program)).json()
        assert (me["identity"]["name"], me["identity"]["kind"]) == ("script", "program")


async def test_an_invalid_token_is_refused_despite_a_valid_cookie(served: Served) -> None:
    async with browser(served, "operator") as visitor:
        (secret,) = visitor.api.cookies.values()
        for output in ("Bearer wrong", "Bearer", "Basic eDp5", f"Bearer {secret}", ""):
            answer = await visitor.api.get("/robot", headers={"authorization": output})
            assert answer.status_code == 401, output


async def test_viewers_may_read_and_stop_only(served: Served) -> None:
    async with browser(served, "viewer") as viewer:
        assert (await viewer.api.post("/robot/stop")).status_code == 204
        refused = await viewer.api.post("/robot/commands/arm")
        assert (refused.status_code, "operator" in refused.json()["detail"]) == (403, True)
        for method, path, body in (
            ("GET", "/access/devices", None),
            ("POST", "/access/codes", {}),
            ("POST", "/access/tokens", {"name": "x"}),
            ("PATCH", "/access/devices/1", {"role": "operator"}),
            ("DELETE", "/access/devices/1", None),
        ):
            answer = await viewer.api.request(method, path, json=body)
            assert answer.status_code == 403, path
        assert [name for name, _ in served.runtime.asked] == ["stop"]
        async with viewer.connect() as socket:
            await socket.send('{"op": "stop"}')
            await until(lambda: len(served.runtime.asked) == 2, "the second STOP")


async def test_a_cookie_alone_changes_nothing(served: Served) -> None:
    async with browser(served, "operator") as visitor:
        secret = visitor.api.headers["x-mucat"]
        for spoilt in ("", "page", secret[:-1], secret.swapcase()):
            answer = await visitor.api.post("/robot/commands/arm", headers={"x-mucat": spoilt})
            assert (answer.status_code, "its part of the sign-in" in answer.text) == (401, True), spoilt
        for spoilt in ("", "null"):
            answer = await visitor.api.post("/robot/commands/arm", headers={"origin": spoilt})
            assert answer.status_code == 403, spoilt
        for missing, status in (("x-mucat", 401), ("origin", 403)):
            stored = visitor.api.headers.pop(missing)
            assert (await visitor.api.post("/robot/commands/arm")).status_code == status, missing
            visitor.api.headers[missing] = stored
        spoilt_offers: list[list[str]] = [[], ["mucat"], [secret], ["mucat", "page"], ["other", secret]]
        for offered in [*spoilt_offers, ["mucat", "page", secret]]:
            with pytest.raises(InvalidStatus):
                await visitor.connect(subprotocols=offered)
        with pytest.raises(InvalidStatus):
            await visitor.connect(origin=None)
        assert served.runtime.asked == []
        # Let in; all that it lacks is control.
        assert (await visitor.api.post("/robot/commands/arm")).status_code == 423


async def test_a_thief_of_a_cookie_gets_neither_sign_in_nor_confirmation_of_its_owner(served: Served) -> None:
    async with browser(served, "operator", "owner") as owner, browser(served, None, "thief") as thief:
        thief.api.cookies.update(owner.api.cookies)
        # The owner has signed in a moment ago, and need not confirm.
        assert (await owner.api.post("/access/codes", json={})).status_code == 201
        assert (await thief.api.post("/access/codes", json={})).status_code == 401
        assert (await thief.api.get("/backup")).status_code == 401
        paired = await thief.pair(await new_code(served, "viewer"))
        identity = paired.json()["identity"]
        assert (identity["device"], identity["role"]) == (2, "viewer")
        assert (await owner.api.get("/access/me")).json()["identity"]["role"] == "operator"


async def test_a_browser_that_signed_in_before_there_were_page_secrets_signs_in_again(
    settings: Settings,
) -> None:
    async with serve(settings) as served, browser(served, "operator") as visitor:
        (cookie,) = visitor.api.cookies.values()
    with closing(sqlite3.connect(settings.data.database)) as database:
        database.execute("UPDATE device SET page_secret = NULL")
        database.commit()
    async with serve(settings) as served, browser(served, None) as visitor:
        visitor.api.cookies.set(served.get(Access).cookie, cookie)
        answer = await visitor.api.get("/robot")
        assert (answer.status_code, "Sign this browser in again" in answer.text) == (401, True)
        me = (await visitor.api.get("/access/me")).json()
        assert (me["signed_in"], me["identity"], me["ended"]) == (False, None, answer.json()["detail"])
        assert (await visitor.pair(await new_code(served, "viewer"))).json()["identity"]["device"] == 2
        assert (await visitor.api.get("/robot")).status_code == 503


async def test_revocation_closes_live_sockets_and_ends_everything(served: Served) -> None:
    async with (
        browser(served, "operator", "boss") as boss,
        browser(served, "operator", "guest") as guest,
        guest.connect() as first,
        guest.connect() as second,
        boss.connect() as own,
    ):
        await until(lambda: served.get(Hub).clients == 3, "the sockets")
        answer = await boss.api.delete(f"/access/devices/{await guest.device()}")
        assert answer.status_code == 204
        assert await closing_of(first) == (1008, "Access was revoked by an operator.")
        assert (await closing_of(second))[0] == 1008
        assert (await guest.api.get("/robot")).status_code == 401
        with pytest.raises(InvalidStatus):
            await guest.connect()
        await own.send('{"op": "ping", "id": 1}')
        assert (await next_text(own, "pong"))["id"] == 1
        assert (await boss.api.delete("/access/devices/2")).status_code == 404


async def test_a_new_role_closes_live_sockets_and_applies_at_once(served: Served) -> None:
    async with (
        browser(served, "operator", "boss") as boss,
        browser(served, "viewer", "guest") as guest,
    ):
        position = f"/access/devices/{await guest.device()}"
        for role, status in (("operator", 423), ("viewer", 403)):
            async with guest.connect() as socket:
                await next_text(socket, "hello")
                answer = await boss.api.patch(position, json={"role": role})
                assert (answer.status_code, answer.json()["role"]) == (200, role)
                assert await closing_of(socket) == (1008, f"The role is now {role}.")
            assert (await guest.api.post("/robot/commands/arm")).status_code == status
            async with guest.connect() as socket:
                assert (await next_text(socket, "hello"))["you"]["role"] == role
        renamed = await boss.api.patch(position, json={"name": "  a   tablet "})
        assert renamed.json()["name"] == "a tablet"


async def test_only_the_shell_can_remove_the_last_operator(served: Served) -> None:
    async with browser(served, "operator", "boss") as boss, browser(served, "viewer") as other:
        await served.api.post("/access/tokens", json={"name": "script", "scope": "administer"})
        own = f"/access/devices/{await boss.device()}"
        for answer in (
            await boss.api.patch(own, json={"role": "viewer"}),
            await boss.api.delete(own),
        ):
            assert (answer.status_code, "only operator" in answer.json()["detail"]) == (409, True)
        position = f"/access/devices/{await other.device()}"
        assert (await boss.api.patch(position, json={"role": "operator"})).status_code == 200
        assert (await boss.api.patch(own, json={"role": "viewer"})).status_code == 200
        assert (await other.api.delete(position)).status_code == 409
        assert (await served.api.delete(position)).status_code == 204


async def test_signing_out_removes_the_browser(served: Served) -> None:
    async with browser(served, "operator") as visitor, visitor.connect() as socket:
        await next_text(socket, "hello")
        cookies = dict(visitor.api.cookies)
        answer = await visitor.api.post("/access/sign-out")
        assert answer.status_code == 204
        assert await closing_of(socket) == (1008, "Signed out.")
        assert dict(visitor.api.cookies) == {}
        visitor.api.cookies.update(cookies)
        assert (await visitor.api.get("/robot")).status_code == 401
    assert (await served.api.post("/access/sign-out")).status_code == 409


@pytest.mark.parametrize("end", ["demoted", "revoked", "signed out"])
async def test_whoever_may_not_admit_others_any_more_leaves_no_valid_code(end: str, served: Served) -> None:
    async with browser(served, "operator") as maker, browser(served, None, "phone") as stranger:
        other = await new_code(served, "viewer")
        answer = await maker.api.post("/access/codes", json={"role": "operator"})
        code = answer.raise_for_status().json()["code"]
        device = f"/access/devices/{await maker.device()}"
        if end == "demoted":
            ended = await served.api.patch(device, json={"role": "viewer"})
        elif end == "revoked":
            ended = await served.api.delete(device)
        else:
            ended = await maker.api.post("/access/sign-out")
        ended.raise_for_status()
        assert (await stranger.pair(code)).status_code == 403
        assert served.get(Access).codes.use(other, "127.0.0.2") == "viewer"


async def test_a_paired_browser_is_not_paired_twice(served: Served) -> None:
    async with browser(served, "viewer", "tablet") as visitor:
        cookies = dict(visitor.api.cookies)
        for role, then in (("viewer", "viewer"), ("operator", "operator"), ("viewer", "operator")):
            answer = await visitor.pair(await new_code(served, "viewer" if role == "viewer" else "operator"))
            assert answer.json()["identity"]["role"] == then
            assert ("set-cookie" in answer.headers, answer.json()["page_secret"]) == (False, None)
        assert dict(visitor.api.cookies) == cookies
    assert len((await served.api.get("/access/devices")).json()) == 1


async def test_a_wrong_code_makes_wait_and_many_are_reported_once(served: Served) -> None:
    clock = SimulatedClock(1000.0)
    served.get(Access).codes = PairingCodes(clock)
    code = await new_code(served, "operator")
    async with browser(served, None) as stranger, served.connect() as socket:
        for _ in range(5):
            assert (await stranger.pair("AAAAA-AAAAA")).status_code == 403
            answer = await stranger.pair(code)
            assert (answer.status_code, answer.headers["retry-after"]) == (429, "1")
            assert "Try again in" in answer.json()["detail"]
            clock.forward(1.0)
        report = await notices(socket, 1)
        assert report[0]["severity"] == "caution"
        assert report[0]["text"] == "Somebody at 127.0.0.1 tries pairing codes."
        # Others are not refused, and the next notice is a different one.
        (await served.api.post("/access/tokens", json={"name": "script"})).raise_for_status()
        assert "script" in (await notices(socket, 1))[0]["text"]
        assert (await stranger.pair(code)).status_code == 200


async def test_events_of_sign_in_are_reported_without_secrets(served: Served) -> None:
    async with served.connect() as socket, browser(served, "viewer", "tablet") as visitor:
        token = (await served.api.post("/access/tokens", json={"name": "script"})).json()["token"]
        secrets = [token, *visitor.api.cookies.values()]
        await served.api.patch("/access/devices/1", json={"role": "operator"})
        await served.api.delete("/access/devices/2")
        await visitor.api.post("/access/sign-out")
        report = await notices(socket, 5)
        assert [event["text"] for event in report] == [
            "“tablet” was paired as viewer.",
            "“the shell of this computer” made a token for “script”, with the scope read.",
            "“the shell of this computer” made “tablet” an operator.",
            "“the shell of this computer” revoked the access of “script”.",
            "“tablet” signed out.",
        ]
        assert not [secret for secret in secrets if secret in json.dumps(report)]


async def notices(socket: ClientConnection, count: int) -> list[dict[str, Any]]:
    """Return the next notices about access."""
    results: list[dict[str, Any]] = []
    async with asyncio.timeout(SECONDS):
        while len(results) < count:
            message = await socket.recv()
            if isinstance(message, bytes):
                for block in read_blocks(message):
                    if block.topic.name == "notice":
                        events = json.loads(block.payload)
                        results += [event for event in events if event["kind"] == "access"]
    return results


UNSEEN = ["\u3164", "a\u2800b", "op\ufe0f", "op\U000e0100", "op\u034f", "\u0301", "a \u0301b", "\ufdfa" * 40]


@pytest.mark.parametrize("name", ["", "   ", "a\nb\x00", "x" * 41, "\x1b[31mred", "a\u202eb", *UNSEEN])
async def test_names_are_short_and_printable(name: str, served: Served) -> None:
    code = await new_code(served, "operator")
    async with browser(served, None, name) as visitor:
        answer = await visitor.pair(code)
        assert (answer.status_code, "name" in answer.json()["detail"]) == (422, True)
        visitor.name = "fine"
        assert (await visitor.pair(code)).status_code == 200


async def test_the_last_visit_is_stored_once_an_hour(settings: Settings, served: Served) -> None:
    now = [1e9]
    devices = Devices(served.get(Store), lambda: now[0])
    device, _ = await devices.add_browser("tablet", "viewer")

    async def stored() -> float:
        await devices.close()
        with closing(sqlite3.connect(settings.data.database)) as database:
            seen: float = database.execute("SELECT seen FROM device").fetchone()[0]
            return seen

    for passed, remaining in ((3599.0, 0.0), (1.0, 3600.0), (3599.0, 3600.0), (-7199.0, 0.0)):
        now[0] += passed
        devices.see(device)
        assert await stored() == 1e9 + remaining
        assert devices.get(device.id).seen == now[0]
