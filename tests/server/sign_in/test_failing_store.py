"""Roles and revocations while the database cannot be written, or has not answered yet."""

import asyncio

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.errors import RefusedError
from server.http.sign_in.access import Access
from server.http.sign_in.identity import SHELL
from server.platform.settings import Settings
from server.platform.store import Store, StoreError


def begin(settings: Settings, store: Store) -> Access:
    access = Access(settings, store, SimulatedClock(), lambda *_: None, lambda *_: None, "token")
    access.open()
    return access


def test_a_demotion_that_could_not_be_stored_can_be_repeated(
    settings: Settings, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def refuse(*_: object) -> None:
        raise StoreError("the disk is full")

    async def scenario() -> None:
        access = begin(settings, store)
        tablet, _ = await access.devices.add_browser("tablet", "operator")
        with monkeypatch.context() as full_disk:
            full_disk.setattr(store, "write", refuse)
            with pytest.raises(StoreError):
                await access.set_role(tablet.id, "viewer", SHELL)
        assert access.devices.get(tablet.id).role == "viewer"
        await access.set_role(tablet.id, "viewer", SHELL)
        assert begin(settings, store).devices.get(tablet.id).role == "viewer"

    asyncio.run(scenario())


def test_two_operators_cannot_revoke_each_other(settings: Settings, store: Store) -> None:
    async def scenario() -> None:
        access = begin(settings, store)
        one, _ = await access.devices.add_browser("tablet", "operator")
        other, _ = await access.devices.add_browser("laptop", "operator")
        done, refused = await asyncio.gather(
            access.revoke(one.id, other.identity),
            access.revoke(other.id, one.identity),
            return_exceptions=True,
        )
        assert done is None
        assert isinstance(refused, RefusedError)
        assert access.devices.operators == [other]

    asyncio.run(scenario())
