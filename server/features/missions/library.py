"""The missions that ship with the program, and those of the data folder with their versions."""

import json
import logging
import threading
from pathlib import Path
from shutil import rmtree

from pydantic import JsonValue

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import MissionLimits
from robot_runtime.contract.text_input import TextError, load_text
from robot_runtime.contract.toml_text import BYTES_MAX, TomlError, read_toml
from robot_runtime.durable_files import make_folder, write_whole
from robot_runtime.errors import RefusedError
from robot_runtime.missions.document import NAME, MissionDocument, called_by, read_mission
from robot_runtime.missions.library import SHIPPED, shipped_missions
from server.features.missions.schemas import MissionText, MissionVersion, summarize_mission
from server.platform.disk_space import FileWriteError, explain_write_error
from server.platform.edited_meanwhile import ChangedMeanwhileError, mark_text
from server.platform.errors import NotFoundError
from server.platform.settings import Settings

log = logging.getLogger(__name__)

MISSIONS_MAX = 200
VERSIONS_MAX = 50
"""Of one mission; the oldest go."""
AUTHORS = "authors.json"
"""File beside the versions, with the author of each by its number."""
DELETED = ".deleted"
"""End of the name of a folder that is being removed."""
_STORING = threading.Lock()
"""Held while a version is numbered and written: each request has a library of its own, and a thread."""


class UnknownMissionError(NotFoundError):
    """The library has no such mission"""


class MissionLibrary:
    """The missions of one data folder, and those that ship with the program.

    A mission of one's own is a folder with a file for each version, the newest with the highest number, and
    one with their authors.
    """

    def __init__(self, own: Path, limits: MissionLimits) -> None:
        self._own = own
        self._limits = limits

    def texts(self) -> dict[str, str]:
        """Return the newest text of every mission by name; unreadable files are left out."""
        texts = dict(shipped_missions())
        for folder in sorted(self._own.iterdir()) if self._own.is_dir() else ():
            if NAME.fullmatch(folder.name) and folder.name not in SHIPPED:
                versions = _versions(folder)
                text = _read(versions[-1]) if versions else None
                if text is not None:
                    texts[folder.name] = text
        return texts

    def read(self, text: str) -> MissionDocument:
        """Return the mission of this text, with what it calls. Raise ConfigError with all problems."""
        return read_mission(text, self.texts(), self._limits)

    def called_by(self, text: str) -> dict[str, str]:
        """Return the texts of the missions that this one calls."""
        return called_by(text, self.texts())

    def describe(self) -> list[MissionText]:
        """Return the shipped missions, then the user's own by name."""
        texts = self.texts()
        return [self._describe(name, texts) for name in texts]

    def versions(self, name: str) -> list[MissionVersion]:
        """Return the versions of the user's own mission, the newest first. Raise UnknownMissionError."""
        versions = _versions(self._own / name) if NAME.fullmatch(name) else []
        if not versions:
            raise UnknownMissionError(f"The library has no own mission {name!r}.")
        authors = _read_authors(self._own / name)
        return [
            MissionVersion(
                version=int(path.stem),
                made=path.stat().st_mtime,
                author=authors.get(path.stem, ""),
                text=text,
            )
            for path in reversed(versions)
            if (text := _read(path)) is not None
        ]

    def keep(self, text: str, author: str = "", base: str | None = None) -> MissionDocument:
        """Store a mission under its own name, as a new version where it differs from the newest.

        `base` is the mark (`mark_text`) of the version that the editing began from, "" for a new mission;
        None replaces any. Raise ConfigError if it is not valid, RefusedError if it may not be written,
        ChangedMeanwhileError, FileWriteError.
        """
        mission = self.read(text)
        if mission.name in SHIPPED:
            raise RefusedError(f"{mission.name} ships with the program. Choose another name.")
        with _STORING:
            self._store(mission.name, text, author, base)
        return mission

    def _store(self, name: str, text: str, author: str, base: str | None) -> None:
        folder = self._own / name
        versions = _versions(folder)
        newest, authors = (_read(versions[-1]) or "") if versions else "", _read_authors(folder)
        if newest == text:
            return
        if base is not None and base != mark_text(newest):
            last = authors.get(versions[-1].stem, "") if versions else ""
            raise ChangedMeanwhileError(f"The mission {name}", last, gone=not versions)
        if not versions and len(self.texts()) >= MISSIONS_MAX:
            raise RefusedError(
                f"The library has {MISSIONS_MAX} missions already. Remove one from {self._own}."
            )
        path = folder / f"{int(versions[-1].stem) + 1 if versions else 1}.toml"
        remaining = [*versions, path][-VERSIONS_MAX:]
        authors = {file.stem: authors[file.stem] for file in remaining if file.stem in authors} | {
            path.stem: author
        }
        try:
            make_folder(self._own)
            make_folder(folder)
            write_whole(folder / AUTHORS, json.dumps(authors, ensure_ascii=False).encode())
            write_whole(path, text.encode())
            for old in versions[: len(versions) + 1 - len(remaining)]:
                old.unlink(missing_ok=True)
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, path)) from problem

    def delete(self, name: str) -> None:
        """Delete the user's own mission with its versions. Raise UnknownMissionError, RefusedError."""
        if name in SHIPPED:
            raise RefusedError(f"{name} ships with the program and stays.")
        with _STORING:
            self.versions(name)
            # In one step; no mission has such a name.
            away = self._own / f"{name}{DELETED}"
            try:
                if away.exists():
                    rmtree(away)
                (self._own / name).rename(away)
                rmtree(away)
            except OSError as problem:
                raise RefusedError(f"{self._own / name} cannot be deleted: {problem.strerror}.") from problem

    def _describe(self, name: str, texts: dict[str, str]) -> MissionText:
        """Return a mission; the title of an invalid one is its name."""
        try:
            summary = summarize_mission(read_mission(texts[name], texts, self._limits))
        except ConfigError:
            summary = None
        versions = 0 if name in SHIPPED else len(_versions(self._own / name))
        title = summary.title if summary else name
        shipped = name in SHIPPED
        return MissionText(
            name=name,
            title=title,
            text=texts[name],
            mark=mark_text(texts[name]),
            shipped=shipped,
            versions=versions,
            summary=summary,
        )


def _versions(folder: Path) -> list[Path]:
    """Return the files of a mission's versions, the oldest first."""
    # Whether the folder is there is not asked first: it may be deleted meanwhile.
    try:
        files = [*folder.iterdir()]
    except (FileNotFoundError, NotADirectoryError):
        return []
    return sorted(
        (file for file in files if file.suffix == ".toml" and file.stem.isdigit()),
        key=lambda file: int(file.stem),
    )


def _read_authors(folder: Path) -> dict[str, str]:
    """Return the authors by the versions' numbers; older versions of the program stored none."""
    try:
        return {str(key): str(name) for key, name in json.loads((folder / AUTHORS).read_bytes()).items()}
    except (OSError, ValueError, AttributeError):
        return {}


def _read(path: Path) -> str | None:
    try:
        if path.stat().st_size <= BYTES_MAX:
            return load_text(path)
    except OSError as problem:
        log.warning("the mission %s cannot be read: %s", path, problem)
    except TextError as problem:
        log.warning("the mission %s cannot be read: it %s", path, problem)
    return None


def read_table(text: str) -> dict[str, JsonValue] | None:
    """Return a mission's TOML as a table for the page's editor; None where TOML or JSON cannot express it."""
    try:
        table: dict[str, JsonValue] = read_toml(text)
        json.dumps(table, allow_nan=False)
    except (TomlError, TypeError, ValueError):
        return None
    return table


def open_library(settings: Settings) -> MissionLibrary:
    """Return the library of this server's missions."""
    return MissionLibrary(settings.data.missions, settings.mission_limits)
