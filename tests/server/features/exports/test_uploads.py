"""Uploads of archives that hang, creep or break off hold up nobody else."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from starlette.requests import ClientDisconnect

from robot_runtime.errors import RefusedError
from server.features.exports.imports import UPLOADS_MAX, Imports
from server.http import uploads
from server.http.uploads import InvalidUploadError
from server.platform.settings import Settings
from server.platform.store import Store
from tests.released import ARCHIVE, RELEASED


async def hang() -> AsyncIterator[bytes]:
    yield b"PK"
    await asyncio.Event().wait()


async def linger() -> AsyncIterator[bytes]:
    """Hang for a second, which comes after a limit of none however slow the computer is."""
    yield b"PK"
    await asyncio.sleep(1)


async def send() -> AsyncIterator[bytes]:
    yield (RELEASED / "0.2.0" / ARCHIVE).read_bytes()


async def break_off() -> AsyncIterator[bytes]:
    yield b"PK"
    raise ClientDisconnect


def left_over(settings: Settings) -> list[Path]:
    return list(settings.data.imports.glob("*"))


async def test_an_upload_that_hangs_does_not_hold_up_others(settings: Settings, store: Store) -> None:
    arrivals = Imports(settings.data, store)
    hanging = [asyncio.create_task(arrivals.receive(hang(), None)) for _ in range(UPLOADS_MAX - 1)]
    await asyncio.sleep(0)
    assert await arrivals.receive(send(), None) == 1
    hanging.append(asyncio.create_task(arrivals.receive(hang(), None)))
    await asyncio.sleep(0)
    with pytest.raises(RefusedError, match=f"{UPLOADS_MAX} archives are being uploaded"):
        await arrivals.receive(send(), None)
    for task in hanging:
        task.cancel()
    await asyncio.gather(*hanging, return_exceptions=True)
    assert left_over(settings) == []


def test_an_upload_that_hangs_is_ended(
    settings: Settings, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(uploads, "UPLOAD_SECONDS", 0.0)
    with pytest.raises(InvalidUploadError, match="was ended: 2 bytes had come"):
        asyncio.run(Imports(settings.data, store).receive(linger(), None))
    assert left_over(settings) == []


def test_an_upload_that_breaks_off_is_an_error_in_words(settings: Settings, store: Store) -> None:
    with pytest.raises(InvalidUploadError, match="was cut off after 2 bytes"):
        asyncio.run(Imports(settings.data, store).receive(break_off(), None))
    assert left_over(settings) == []
