"""Dangerous acts of a browser need a sign-in or a confirmation of the last ten minutes."""

import json

import httpx
import pytest

from robot_runtime.clock import SimulatedClock
from server.http.sign_in.access import Access
from server.http.sign_in.confirmation import CONFIRMED_SECONDS, Confirmations, UnconfirmedError
from server.http.sign_in.identity import SHELL, Identity
from server.http.sign_in.pairing_codes import PairingCodes, WrongCodeError
from server.platform.audit_file import read_entries
from server.platform.settings import Settings
from tests.server.serving import Served
from tests.server.sign_in.browsers import Browser, browser, new_code
from tests.server.waiting import until

NEAR = "127.0.0.1"
TABLET = Identity(1, "tablet", "operator", "browser")


def confirmations(served: Served) -> SimulatedClock:
    """Return the clock of a server whose browsers have all yet to confirm."""
    clock = SimulatedClock(1000.0)
    served.get(Access).confirmations = Confirmations(clock)
    served.get(Access).codes = PairingCodes(clock)
    return clock


async def confirm(visitor: Browser, code: str) -> httpx.Response:
    return await visitor.api.post("/access/confirm", json={"code": code})


def test_a_confirmation_holds_for_ten_minutes_and_only_for_its_browser() -> None:
    clock = SimulatedClock(1000.0)
    confirmed = Confirmations(clock)
    confirmed.confirm(TABLET.device)
    clock.forward(CONFIRMED_SECONDS - 0.1)
    confirmed.require(TABLET)
    with pytest.raises(UnconfirmedError):
        confirmed.require(Identity(2, "phone", "operator", "browser"))
    clock.forward(0.1)
    with pytest.raises(UnconfirmedError):
        confirmed.require(TABLET)
    confirmed.confirm(TABLET.device)
    confirmed.require(TABLET)


def test_programs_and_the_shell_need_no_confirmation() -> None:
    confirmed = Confirmations(SimulatedClock(1000.0))
    confirmed.require(Identity(3, "script", "operator", "program"))
    confirmed.require(SHELL)


def test_an_operator_s_code_of_somebody_else_confirms_once() -> None:
    codes = PairingCodes(SimulatedClock(1000.0))
    code = codes.make("operator", 2)
    codes.confirm(f" {code.lower()}", 1, NEAR)
    with pytest.raises(WrongCodeError):
        codes.confirm(code, 1, NEAR)


@pytest.mark.parametrize(("role", "maker"), [("viewer", 0), ("operator", 1)], ids=["viewer", "own"])
def test_a_code_that_does_not_confirm_counts_as_wrong_and_still_signs_in(role: str, maker: int) -> None:
    clock = SimulatedClock(1000.0)
    codes = PairingCodes(clock)
    code = codes.make("viewer" if role == "viewer" else "operator", maker)
    with pytest.raises(WrongCodeError, match="does not confirm"):
        codes.confirm(code, 1, NEAR)
    clock.forward(1.0)
    assert codes.use(code, NEAR) == role


ACTS: tuple[tuple[str, str, dict[str, str] | None], ...] = (
    ("POST", "/access/codes", {}),
    ("POST", "/access/tokens", {"name": "first script"}),
    ("PATCH", "/access/devices/1", {"name": "mine"}),
    ("DELETE", "/access/devices/999", None),
    ("GET", "/backup", None),
)


async def test_ten_minutes_after_its_sign_in_a_browser_must_confirm_dangerous_acts(served: Served) -> None:
    clock = confirmations(served)
    async with browser(served, "operator") as visitor:

        async def act() -> list[int]:
            answers = [await visitor.api.request(method, path, json=body) for method, path, body in ACTS]
            asked = [answer.json().get("kind") for answer in answers if answer.status_code == 403]
            assert asked == ["confirmation"] * len(asked)
            return [answer.status_code for answer in answers]

        assert await act() == [201, 201, 200, 404, 200]
        clock.forward(CONFIRMED_SECONDS)
        assert await act() == [403] * len(ACTS)
        assert (await visitor.api.get("/access/devices")).status_code == 200
        assert (await confirm(visitor, await new_code(served, "operator"))).status_code == 204
        (await served.api.patch("/access/devices/2", json={"name": "second script"})).raise_for_status()
        assert await act() == [201, 201, 200, 404, 200]


async def test_a_viewer_who_becomes_an_operator_by_a_code_is_not_asked(served: Served) -> None:
    clock = confirmations(served)
    async with browser(served, "viewer") as visitor:
        clock.forward(CONFIRMED_SECONDS)
        (await visitor.pair(await new_code(served, "operator"))).raise_for_status()
        assert (await visitor.api.post("/access/codes", json={})).status_code == 201


async def test_wrong_codes_of_a_confirmation_wait_as_those_of_a_sign_in(served: Served) -> None:
    clock = confirmations(served)
    async with browser(served, "operator") as visitor:
        own = (await visitor.api.post("/access/codes", json={"role": "operator"})).json()["code"]
        clock.forward(CONFIRMED_SECONDS - 1.0)
        right = await new_code(served, "operator")
        assert (await confirm(visitor, own)).status_code == 403
        assert (await confirm(visitor, right)).status_code == 429
        clock.forward(1.0)
        assert (await visitor.api.post("/access/codes", json={})).status_code == 403
        assert (await confirm(visitor, right)).status_code == 204
        assert (await visitor.api.post("/access/codes", json={})).status_code == 201


async def test_the_audit_log_has_confirmations_and_refusals_without_codes(
    settings: Settings, served: Served
) -> None:
    clock = confirmations(served)
    async with browser(served, "operator") as visitor:
        clock.forward(CONFIRMED_SECONDS)
        await visitor.api.post("/access/tokens", json={"name": "script"})
        code = await new_code(served, "operator")
        await confirm(visitor, code)

        def written() -> list[tuple[str, str, str]]:
            entries = read_entries(settings.data.audit)
            return [(entry.action, entry.about, entry.outcome) for entry in entries if entry.device]

        expected = {
            (
                "Make a token for a program",
                'not confirmed: POST /api/access/tokens {"name": "script"}',
                "refused",
            ),
            (
                "Confirm the user of this browser, with a new operator's code",
                "POST /api/access/confirm",
                "done",
            ),
        }
        await until(lambda: expected <= set(written()), "the entries")
        assert code not in json.dumps(written())
