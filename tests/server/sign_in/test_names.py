"""Names that look alike: numbered at the sign-in, refused where somebody chooses one."""

import asyncio
from unicodedata import normalize

import pytest
from sqlmodel import select

from server.http.sign_in import devices as devices_module
from server.http.sign_in.devices import Devices
from server.http.sign_in.names import LOOK_ALIKES, NAME_LENGTH_MAX, clean_name, find_alike, number_name
from server.platform.models import DeviceRow
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.serving import Served, play
from tests.server.sign_in.browsers import browser, new_code

CYRILLIC_OP = "\u043e\u0440"
ALIKE = [
    ("op", "op"),
    ("op", "OP"),
    ("op", CYRILLIC_OP),
    ("op", "\u03bfp"),
    ("op", "0p"),
    ("Ina", "lna"),
    ("ina", "Ina"),
    ("tablet 1", "tablet l"),
    ("tablet", "tab|et"),
    ("modem", "modern"),
    ("Anne-Marie", "Anne\u2013Marie"),
    ("PC", "\u0420\u0421"),
    ("p\u00e8re", "\u0440\u0435\u0300re"),
]


@pytest.mark.parametrize(("one", "other"), ALIKE)
def test_names_that_look_alike_are_found_from_either_side(one: str, other: str) -> None:
    one, other = clean_name(one), clean_name(other)
    assert find_alike(one, ["somebody", other]) == other
    assert find_alike(other, ["somebody", one]) == one


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("op", "pop"),
        ("Alia", "Aila"),
        ("op", "op 2"),
        ("per\u00e9", "pere"),
        ("\u0418\u0432\u0430", "\u0415\u0432\u0430"),
    ],
)
def test_names_of_different_looks_do_not_hinder_each_other(one: str, other: str) -> None:
    assert find_alike(one, [other]) is None
    assert number_name(one, [other]) == one


def test_a_taken_name_gets_the_first_number_that_is_free_and_never_grows_too_long() -> None:
    assert number_name("op", ["op", "OP 2", "\u043ep 3"]) == "op 4"
    long = "x" * NAME_LENGTH_MAX
    numbered = number_name(long, [long, f"{long[:-2]} 2"])
    assert (numbered, len(numbered)) == (f"{long[:-2]} 3", NAME_LENGTH_MAX)


def test_every_look_alike_survives_the_clean_up_and_stands_once() -> None:
    characters = "".join(LOOK_ALIKES.values())
    assert len(set(characters)) == len(characters)
    assert not [one for one in characters if normalize("NFKC", one) != one or one.isascii()]


def test_nobody_signs_in_under_a_name_that_looks_like_another_s(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        given = ["op", "op", CYRILLIC_OP, "The shell of this computer"]
        codes = [await new_code(served, "viewer") for _ in given]

        async def sign_in(name: str, code: str) -> str:
            async with browser(served, None, name) as one:
                answer = (await one.pair(code)).raise_for_status()
                return str(answer.json()["identity"]["name"])

        # All at once: none of them is stored when the next one comes.
        names = await asyncio.gather(*map(sign_in, given, codes))
        assert sorted(name.replace(CYRILLIC_OP, "op") for name in names[:3]) == ["op", "op 2", "op 3"]
        assert names[3] == "The shell of this computer 2"

    play(settings, scenario)


def test_a_chosen_name_that_looks_like_another_s_is_refused_with_that(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        async with browser(served, "operator", "op") as one, browser(served, "viewer", "guest"):
            token = await one.api.post("/access/tokens", json={"name": CYRILLIC_OP})
            assert (token.status_code, "“op”" in token.json()["detail"]) == (409, True)
            renamed = await one.api.patch("/access/devices/2", json={"name": "0P"})
            assert (renamed.status_code, "“op”" in renamed.json()["detail"]) == (409, True)
            own = await one.api.patch("/access/devices/1", json={"name": CYRILLIC_OP})
            assert (own.status_code, own.json()["name"]) == (200, CYRILLIC_OP)
            assert len((await one.api.get("/access/devices")).json()) == 2

    play(settings, scenario)


def test_no_browser_gets_the_name_of_a_removed_one(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    async def scenario() -> None:
        devices = Devices(store)
        one, secrets = await devices.add_browser("Chrome on Linux", "viewer")
        other, _ = await devices.add_browser("Chrome on Linux", "viewer")
        await devices.remove(one.id)
        await devices.remove(other.id)
        assert devices.find(secrets.cookie, "browser") is None
        third, _ = await devices.add_browser("Chrome on Linux", "viewer")
        # As a server that is started again knows them.
        again = Devices(store)
        again.load()
        assert [device.id for device in again.all()] == [third.id]
        assert again.find(secrets.cookie, "browser") is None
        fourth, _ = await again.add_browser("Chrome on Linux", "viewer")
        assert [third.name, fourth.name] == ["Chrome on Linux 3", "Chrome on Linux 4"]
        # A person may choose a name that is free again.
        await again.rename(fourth.id, "Chrome on Linux")
        monkeypatch.setattr(devices_module, "FORMER_MAX", 1)
        await again.remove(fourth.id)
        with store.read() as database:
            assert database.exec(select(DeviceRow.kind)).all() == ["browser", "removed"]

    asyncio.run(scenario())
