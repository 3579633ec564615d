"""A lab's archive, in both databases: the ingest of an hour, and questions to ten thousand sessions."""

import asyncio
import tempfile
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

from sqlalchemy import insert

from bench import session_list
from bench.hour import copy_hours
from server.features.comparison.figure_query import FigureQuery, study_figure
from server.features.exports.archive import write_archive
from server.features.exports.imports import Imports
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.library.listing import Listing, SessionSelection
from server.platform.models import SessionFiguresRow
from server.platform.schema import prepare
from server.platform.settings import DataFolder, make_folders
from server.platform.store import Reader, Store
from server.recording.session import find_row
from tests.server.postgres import new_archive

_SESSIONS = 10_000
_ASKED = 3
"""Times that a question is asked, of which the median counts."""
_SEGMENTS = 3


def measure() -> dict[str, float]:
    """Measure s of the ingest of an hour, and of questions to the archive."""
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as name:
        hour = _archive_of_an_hour(Path(name))
        for database, url in (("sqlite", ""), ("postgresql", new_archive())):
            folder = DataFolder(Path(name) / database)
            make_folders(folder)
            folder.lab.write_text(url)
            prepare(folder)
            with closing(Store(folder.database_location)) as store:
                began = time.perf_counter()
                asyncio.run(Imports(folder, store).take_merged(hour))
                figures[f"archive.ingest_{database}_s"] = time.perf_counter() - began
        for database, url in (("sqlite", ""), ("postgresql", new_archive())):
            folder = DataFolder(Path(name) / f"many_{database}")
            make_folders(folder)
            folder.lab.write_text(url)
            session_list.fill(folder.path, _SESSIONS)
            with closing(Store(folder.database_location)) as store:
                asyncio.run(store.execute(insert(SessionFiguresRow), _figures()))
                figures |= {
                    f"archive.{question}_{database}_s": _median(store, ask)
                    for question, ask in _QUESTIONS.items()
                }
    return figures


def _archive_of_an_hour(folder: Path) -> Path:
    (session,) = copy_hours(folder / "hour")
    path = folder / "hour.mucat"
    with closing(Reader(DataFolder(folder / "hour").database)) as store, path.open("wb") as file:
        options = ExportOptions(format="archive")
        write_archive(store, ExportSelection(store, find_row(store, session), options), file)
    return path


def _list(store: Reader) -> object:
    return Listing(store).page(SessionSelection(search="pid yellow", tag=["pool"]), limit=100)


def _compare(store: Reader) -> object:
    return study_figure(store, FigureQuery(figure="rmse", of="segment", by="gains"))


_QUESTIONS: dict[str, Callable[[Reader], object]] = {"query": _list, "comparison": _compare}


def _median(store: Reader, ask: Callable[[Reader], object]) -> float:
    lasted: list[float] = []
    for _ in range(_ASKED):
        began = time.perf_counter()
        ask(store)
        lasted.append(time.perf_counter() - began)
    return sorted(lasted)[_ASKED // 2]


def _figures() -> list[dict[str, Any]]:
    """Return figures of each session and its segments, which differ as those of dives do."""
    return [
        {
            "session_id": session,
            "segment": segment,
            "controller": ("Bang-bang", "PID", "Predictive")[session % 3],
            "gains": f"kd 2, ki 0.4, kp {1 + session % 12}",
            "craft": f"craft {session % 4}",
            "rmse": 0.01 + (session * 7919 + segment) % 997 / 10_000,
            "duration": 60.0,
            "deepest": 0.5 + session % 17 / 10,
        }
        for session in range(1, _SESSIONS + 1)
        for segment in range(_SEGMENTS + 1)
    ]
