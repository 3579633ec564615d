"""Sizes of the recordings and free space of the disk."""

import shutil
from pathlib import Path

from pydantic import Field
from sqlmodel import col, func, select

from robot_runtime.contract.topics import FILM
from server.library.config import read_rules
from server.platform.disk_space import free_bytes
from server.platform.models import Chunk, SessionRow
from server.platform.schema_base import Schema
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import HIDDEN, REMOVING

GIGABYTE = 1_000_000_000


class Storage(Schema):
    """Use of the disk that holds the data folder, and the rules of retention."""

    database: int = Field(description="bytes of the database's files")
    reusable: int = Field(description="of these, bytes that are free for reuse")
    exports: int = Field(description="bytes of the exported files")
    backups: int = Field(description="bytes of the copies in the folder `backups`, unfinished ones included")
    free: int = Field(description="free bytes of this disk")
    total: int = Field(description="bytes of this disk")
    sessions: int = Field(description="number of sessions, without the bin")
    sessions_bytes: int
    film_bytes: int = Field(description="bytes of the films of all sessions, those in the bin included")
    bin: int = Field(description="number of sessions in the bin")
    bin_bytes: int
    removing: int = Field(description="number of sessions that are being removed for good")
    removing_bytes: int = Field(description="bytes of these that are still to be removed")
    undo_days: float = Field(description="days in the bin before a session is removed")
    keep_days: float = Field(description="days after which a session is moved to the bin; 0: never")
    keep_free: float = Field(description="GB to keep free by removing the oldest sessions; 0: no such rule")


def measure(store: Store, settings: Settings) -> Storage:
    """Measure the disk and the database. Raise StoreError."""
    folder, rules = settings.data, read_rules(settings)
    space = store.measure()
    binned = col(SessionRow.deleted).is_not(None)
    query = select(binned, func.count(), func.coalesce(func.sum(SessionRow.bytes), 0))
    with store.read() as database:
        rows = database.exec(query.where(col(SessionRow.state).not_in(HIDDEN)).group_by(binned))
        totals = {bool(deleted): (count, total) for deleted, count, total in rows}
        going = select(func.count(), func.coalesce(func.sum(SessionRow.bytes), 0))
        removing, removing_bytes = database.exec(going.where(SessionRow.state == REMOVING)).one()
        # By session: the index of chunks begins with it.
        film = (col(Chunk.session_id) == col(SessionRow.id)) & (col(Chunk.topic) == FILM.name)
        films = select(func.coalesce(func.sum(func.length(Chunk.data)), 0)).select_from(SessionRow)
        film_bytes = database.exec(films.join(Chunk, film)).one()
    disk = shutil.disk_usage(folder.path)
    sessions, sessions_bytes = totals.get(False, (0, 0))
    in_bin, bin_bytes = totals.get(True, (0, 0))
    return Storage(
        database=space.size,
        reusable=space.reusable,
        exports=sum(_bytes(path) for path in folder.exports.glob("*")),
        backups=sum(_bytes(path) for path in folder.backups.rglob("*")),
        free=disk.free,
        total=disk.total,
        sessions=sessions,
        sessions_bytes=sessions_bytes,
        film_bytes=film_bytes,
        bin=in_bin,
        bin_bytes=bin_bytes,
        removing=removing,
        removing_bytes=removing_bytes,
        undo_days=rules.undo_days,
        keep_days=rules.keep_days,
        keep_free=rules.keep_free,
    )


def free_for_recordings(store: Store, settings: Settings) -> int:
    """Return the bytes that recordings may take before older ones make room; below 0 these lack already.

    Raise StoreError.
    """
    reserved = int(read_rules(settings).keep_free * GIGABYTE)
    return free_bytes(settings.data.path) + store.measure().reusable - reserved


def _bytes(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
