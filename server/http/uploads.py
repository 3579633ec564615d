"""Files that arrive as the body of a request, piece by piece."""

import asyncio
from collections.abc import AsyncIterable, AsyncIterator
from pathlib import Path

from starlette.requests import ClientDisconnect

from robot_runtime.durable_files import make_folder
from server.platform.disk_space import FileWriteError, explain_write_error, require_free
from server.platform.errors import InvalidError

PIECE_BYTES = 1 << 20
UPLOAD_SECONDS = 30.0
UPLOAD_RATE = 10_000
"""bytes/s after the first `UPLOAD_SECONDS`; a slower upload, or one that hangs, is ended."""


class InvalidUploadError(InvalidError):
    """The upload came too slowly, was cut off, or is too large"""


async def save_upload(pieces: AsyncIterable[bytes], path: Path, size_max: float = float("inf")) -> None:
    """Write an upload of `size_max` bytes at most to a file; where anything fails, the file is removed.

    Raise InvalidUploadError, and FileWriteError where the disk has no room, or fails.
    """
    try:
        await _save(_at_rate(pieces), path, size_max)
    except BaseException as problem:
        await asyncio.to_thread(path.unlink, missing_ok=True)
        if isinstance(problem, OSError):
            raise FileWriteError(explain_write_error(problem, path)) from problem
        raise


async def _save(pieces: AsyncIterable[bytes], path: Path, size_max: float) -> None:
    make_folder(path.parent)
    with path.open("wb") as file:
        waiting = bytearray()
        async for piece in pieces:
            waiting += piece
            if file.tell() + len(waiting) > size_max:
                raise InvalidUploadError(f"The file is too large: {size_max / 1e6:.0f} MB are accepted.")
            if len(waiting) >= PIECE_BYTES:
                await asyncio.to_thread(file.write, bytes(waiting))
                waiting.clear()
                require_free(path.parent, file.tell())
        await asyncio.to_thread(file.write, bytes(waiting))


async def _at_rate(pieces: AsyncIterable[bytes]) -> AsyncIterator[bytes]:
    """Yield the pieces of an upload. Raise InvalidUploadError where they come too slowly, or end early."""
    clock = asyncio.get_running_loop()
    started, received = clock.time(), 0
    arriving = aiter(pieces)
    while True:
        try:
            async with asyncio.timeout_at(started + UPLOAD_SECONDS + received / UPLOAD_RATE):
                piece = await anext(arriving)
        except StopAsyncIteration:
            return
        except TimeoutError as problem:
            raise InvalidUploadError(
                f"The upload was ended: {received} bytes had come. Send it again."
            ) from problem
        except ClientDisconnect as problem:
            raise InvalidUploadError(
                f"The upload was cut off after {received} bytes. Send it again."
            ) from problem
        received += len(piece)
        yield piece
