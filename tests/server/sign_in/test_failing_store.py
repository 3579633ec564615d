"""Roles and revocations while the database cannot be written, or has not answered yet."""

import asyncio

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.durable_files import PART
from robot_runtime.errors import RefusedError
from server.http.sign_in.access import Access
from server.http.sign_in.identity import SHELL
from server.platform.settings import Settings
from server.platform.store import Store, StoreError


def begin(settings: Settings, store: Store, token: str = "token") -> Access:
    access = Access(settings, store, SimulatedClock(), lambda *_: None, lambda *_: None, token)
    access.open()
    return access


async def test_a_demotion_that_could_not_be_stored_can_be_repeated(
    settings: Settings, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def refuse(*_: object) -> None:
        raise StoreError("the disk is full")

    access = begin(settings, store)
    tablet, _ = await access.devices.add_browser("tablet", "operator")
    with monkeypatch.context() as full_disk:
        full_disk.setattr(store, "write", refuse)
        with pytest.raises(StoreError):
            await access.set_role(tablet.id, "viewer", SHELL)
    assert access.devices.get(tablet.id).role == "viewer"
    await access.set_role(tablet.id, "viewer", SHELL)
    assert begin(settings, store).devices.get(tablet.id).role == "viewer"


def test_a_server_that_starts_on_a_full_disk_can_be_used_from_the_shell(
    settings: Settings, store: Store
) -> None:
    begin(settings, store, "the token of the server before")
    file = settings.data.token
    # Nothing more can be written beside it.
    file.with_name(file.name + PART).mkdir()
    access = begin(settings, store, "the token of the server now...")
    assert file.read_text() == "the token of the server now...\n"
    assert file.stat().st_mode & 0o777 == 0o600
    assert access.identify_token(file.read_text().strip()) == SHELL


def test_a_server_without_a_token_file_starts_all_the_same(settings: Settings, store: Store) -> None:
    settings.data.token.with_name(settings.data.token.name + PART).mkdir()
    begin(settings, store)
    assert not settings.data.token.exists()


async def test_two_operators_cannot_revoke_each_other(settings: Settings, store: Store) -> None:
    access = begin(settings, store)
    device, _ = await access.devices.add_browser("tablet", "operator")
    other, _ = await access.devices.add_browser("laptop", "operator")
    done, refused = await asyncio.gather(
        access.revoke(device.id, other.identity),
        access.revoke(other.id, device.identity),
        return_exceptions=True,
    )
    assert done is None
    assert isinstance(refused, RefusedError)
    assert access.devices.operators == [other]
