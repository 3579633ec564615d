"""The database of a server's first start, made once and copied."""

import atexit
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from server.features.comm_tests.runs import CommTestStore
from server.features.comm_tests.shipped import import_samples
from server.platform.schema import prepare
from server.platform.settings import DataFolder, make_folders
from server.platform.store import Store

_made: dict[str, Path] = {}


def place_empty(data: DataFolder) -> None:
    """Give a new data folder its tables."""
    if "empty" not in _made:
        folder = _new_folder()
        prepare(folder)
        _made["empty"] = folder.database
    _copy(_made["empty"], data)


@contextmanager
def new_store(data: DataFolder) -> Iterator[Store]:
    """The store of a data folder that no server serves, closed at the end; an older database is upgraded."""
    if data.database.exists():
        prepare(data)
    else:
        place_empty(data)
    with closing(Store(data.database)) as store:
        yield store


async def place_with_samples(data: DataFolder) -> None:
    """Give a new data folder its tables, and the shipped communication tests."""
    if "samples" not in _made:
        folder = _new_folder()
        prepare(folder)
        store = Store(folder.database)
        await import_samples(CommTestStore(store))
        store.close()
        _made["samples"] = folder.database
    _copy(_made["samples"], data)


def _copy(database: Path, data: DataFolder) -> None:
    if not data.database.exists():
        shutil.copyfile(database, data.database)


def _new_folder() -> DataFolder:
    path = tempfile.mkdtemp(prefix="mucat-")
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    folder = DataFolder(Path(path))
    make_folders(folder)
    return folder
