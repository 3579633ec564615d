"""The scripts of your own panels, in a folder of the data folder."""

import os
import re
from collections.abc import Sequence
from pathlib import Path

from robot_runtime.contract.text_input import TextError, load_text
from server.platform.errors import NotFoundError
from server.platform.schema_base import Schema

SCRIPT_BYTES_MAX = 200_000
PANELS_SHOWN = 200
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _-]{0,39}")


class UnknownPanelError(NotFoundError):
    """There is no such panel, or it cannot be read"""


class OwnPanel(Schema):
    """A panel, named by its file; `problem` is the reason why it cannot be shown."""

    name: str
    problem: str = ""


class OwnPanelScript(Schema):
    """A panel's file: an ES module."""

    name: str
    script: str


def list_panels(folder: Path) -> Sequence[OwnPanel]:
    """Return the `*.js` of the folder by name, at most `PANELS_SHOWN`; none if there is no such folder."""
    files = sorted(folder.glob("*.js"))[:PANELS_SHOWN]
    return [OwnPanel(name=_readable(file.stem), problem=_problem(file)) for file in files]


def read_panel(folder: Path, name: str) -> OwnPanelScript:
    """Return the panel of this name. Raise UnknownPanelError, with the reason."""
    # Found in the folder's list, so that no requested name becomes a path.
    for file in folder.glob("*.js"):
        if file.stem != name:
            continue
        if problem := _problem(file):
            raise UnknownPanelError(problem)
        return OwnPanelScript(name=name, script=load_text(file))
    raise UnknownPanelError(f"There is no panel “{name}” in {folder}. GET /api/panels lists the panels.")


def _problem(file: Path) -> str:
    if not NAME.fullmatch(file.stem):
        allowed = "up to 40 letters without accents, digits, spaces, - and _"
        return f"{_readable(file.name)} needs another name: {allowed}."
    try:
        if file.stat().st_size > SCRIPT_BYTES_MAX:
            return f"{file.name} has more than {SCRIPT_BYTES_MAX // 1000} kB."
        load_text(file)
    except TextError as problem:
        return f"{file.name} {problem}."
    except OSError as problem:
        return f"{file.name} cannot be read: {problem.strerror}."
    return ""


def _readable(name: str) -> str:
    """Return a file's name without bytes that are not UTF-8 and cannot be sent."""
    return os.fsencode(name).decode(errors="replace")
