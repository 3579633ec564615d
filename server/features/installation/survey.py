"""`python -I -m server.features.installation.survey`: the facts about a version and its data for an update.

It runs in the environment of each version, as the user of the data, and prints one line of JSON.
"""

import hashlib
import json
import os
import sqlite3
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from server import VERSION
from server.platform.last_configuration import read_usable_settings
from server.platform.running_server import ask
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.terminal import echo

ROBOT_SECONDS = 30.0
"""A small computer on which an update has just been built; without an answer there is no update."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The findings; `problem` reports a missing server.

    `armed` is None where the server could not say it. `running` is the version of the running server.
    `reads` is False for a database of a newer version; then `copy` is its newest copy that this version can
    read, empty without one. `firmware` is the SHA-256 of this version's firmware for a real board, or empty.
    """

    version: str = VERSION
    running: str = ""
    problem: str = ""
    armed: bool | None = None
    recording: bool = False
    reads: bool = True
    copy: str = ""
    firmware: str = ""


def survey(settings: Settings) -> Survey:
    """Examine this version, its data, and the server that runs on them."""
    reads, copy = _look_at_database(settings.data)
    running, problem, armed, recording = "", "", None, False
    try:
        # Alone: a damaged database does not hide an armed robot. A lab has none.
        armed = (
            not settings.lab and ask(settings.data, "GET", "/robot", seconds=ROBOT_SECONDS)["armed"] is True
        )
    except SetupError as failure:
        problem = str(failure)
    try:
        health = ask(settings.data, "GET", "/health")
        wrong = [
            part
            for part in health["parts"]
            if part["name"] in ("database", "runtime") and part["state"] != "ok"
        ]
        problem = "; ".join(f"{fault['name']}: {fault['text']}" for fault in wrong) or problem
        running = str(health["version"])
        recording = bool(ask(settings.data, "GET", "/sessions?state=recording"))
    except SetupError as failure:
        problem = problem or str(failure)
    return Survey(
        running=running,
        problem=problem,
        armed=armed,
        recording=recording,
        reads=reads,
        copy=copy,
        firmware=_sum_firmware(settings),
    )


def _look_at_database(folder: DataFolder) -> tuple[bool, str]:
    """Return True where this version can read the database; else its newest readable copy."""
    from migrations import known_revisions
    from server.platform.schema import find_copy, read_revision

    if isinstance(location := folder.database_location, str):
        return _reads_archive(location), ""
    known = known_revisions()
    try:
        revision = read_revision(folder.database)
    except sqlite3.DatabaseError:
        readable = False
    else:
        readable = revision is None or revision in known
    return readable, "" if readable else str(find_copy(folder, known) or "")


def _reads_archive(url: str) -> bool:
    from server.platform.postgresql_schema import measure_archive

    try:
        measure_archive(url)
    except SetupError:
        return False
    return True


def _sum_firmware(settings: Settings) -> str:
    from robot_runtime.simulation.boards.firmware import firmware_path

    if settings.emulated_board:
        return ""
    path = firmware_path(settings.build, settings.link.baud, ".hex", hil=settings.in_the_loop)
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "none"


def main() -> None:
    """Print the survey. Exit with status 1 and the reason where the configuration is not valid."""
    try:
        settings = read_usable_settings(Path(os.environ["MUCAT_CONFIG"]), None, None, None, os.environ)
    except SetupError as problem:
        sys.exit(str(problem))
    echo(json.dumps(asdict(survey(settings))))


if __name__ == "__main__":
    main()
