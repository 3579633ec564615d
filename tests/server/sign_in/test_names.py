"""Names that are the same: numbered at the sign-in, refused where somebody chooses one."""

import asyncio

import pytest
from sqlmodel import select

from server.http.sign_in import devices as devices_module
from server.http.sign_in.devices import Devices
from server.http.sign_in.names import NAME_LENGTH_MAX, clean_name, find_same, number_name
from server.platform.models import DeviceRow
from server.platform.store import Store
from tests.server.serving import Served
from tests.server.sign_in.browsers import browser, new_code

WIDE_OP = "\uff4f\uff50"
SAME = [("op", "op"), ("op", "OP"), ("op", WIDE_OP), ("stra\u00dfe", "STRASSE"), ("p\u00e8re", "pe\u0300re")]


@pytest.mark.parametrize(("name", "other"), SAME)
def test_names_that_are_the_same_are_found_from_either_side(name: str, other: str) -> None:
    name, other = clean_name(name), clean_name(other)
    assert find_same(name, ["somebody", other]) == other
    assert find_same(other, ["somebody", name]) == name


@pytest.mark.parametrize(
    ("name", "other"), [("op", "pop"), ("Alia", "Aila"), ("op", "op 2"), ("per\u00e9", "pere")]
)
def test_different_names_do_not_hinder_each_other(name: str, other: str) -> None:
    assert find_same(name, [other]) is None
    assert number_name(name, [other]) == name


def test_a_taken_name_gets_the_first_number_that_is_free_and_never_grows_too_long() -> None:
    assert number_name("op", ["op", "OP 2", "\uff4fp 3"]) == "op 4"
    long = "x" * NAME_LENGTH_MAX
    numbered = number_name(long, [long, f"{long[:-2]} 2"])
    assert (numbered, len(numbered)) == (f"{long[:-2]} 3", NAME_LENGTH_MAX)


async def test_nobody_signs_in_under_the_name_of_another(served: Served) -> None:
    given = ["op", "op", WIDE_OP, "The shell of this computer"]
    codes = [await new_code(served, "viewer") for _ in given]

    async def sign_in(name: str, code: str) -> str:
        async with browser(served, None, name) as visitor:
            answer = (await visitor.pair(code)).raise_for_status()
            return str(answer.json()["identity"]["name"])

    # All at once: none of them is stored when the next one comes.
    names = await asyncio.gather(*map(sign_in, given, codes))
    assert sorted(names[:3]) == ["op", "op 2", "op 3"]
    assert names[3] == "The shell of this computer 2"


async def test_a_chosen_name_that_another_has_is_refused_with_that(served: Served) -> None:
    async with browser(served, "operator", "op") as visitor, browser(served, "viewer", "guest"):
        token = await visitor.api.post("/access/tokens", json={"name": WIDE_OP})
        assert (token.status_code, "“op”" in token.json()["detail"]) == (409, True)
        renamed = await visitor.api.patch("/access/devices/2", json={"name": "OP"})
        assert (renamed.status_code, "“op”" in renamed.json()["detail"]) == (409, True)
        own = await visitor.api.patch("/access/devices/1", json={"name": "Op"})
        assert (own.status_code, own.json()["name"]) == (200, "Op")
        assert len((await visitor.api.get("/access/devices")).json()) == 2


async def test_no_browser_gets_the_name_of_a_removed_one(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    devices = Devices(store)
    item, secrets = await devices.add_browser("Chrome on Linux", "viewer")
    other, _ = await devices.add_browser("Chrome on Linux", "viewer")
    await devices.remove(item.id)
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
