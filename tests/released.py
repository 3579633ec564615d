"""Records the session of a release: `make released-session` writes it to tests/data, named by the version.

It is a scenario in simulated time, as an archive and in its data folder, with what this version itself reads
in it: the SHA-256 of every exported table, and the figures of a comparison. test_released_sessions.py holds
later versions to it.
"""

import hashlib
import json
import tarfile
import zipfile
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from server import VERSION
from server.analysis.comparer import Comparer
from server.analysis.schemas import ComparisonQuery
from server.cli import main
from server.platform.settings import DataFolder
from server.platform.store import Reader

RELEASED = Path(__file__).with_name("data")
ARCHIVE, EXPECTED = "session.mucat.zip", "session.json"
DATA, DATA_EXPECTED = "data.tar.gz", "data.json"
LEFT_OUT = {"run", "logs", "reserve", "server.lock"}
"""Names in a data folder that exist only while it is used, or have no content."""
SIGNALS = ["depth.depth", "control.set_point", "truth.depth"]
SCENARIO = """
name = "released"
title = "A session of a release"
duration = 15
seed = 14
[scene]
kind = "pool"
depth = 2.0
length = 4.0
width = 3.0
beacons = [[1.0, 0.0, 0.5]]
[control]
controller = "pid"
set_point = 0.3
[vision]
rate = 4
[[events]]
at = 1
do = "arm"
[[events]]
at = 4
do = "loop"
name = "heading"
on = true
set_point = 0.5
[[events]]
at = 6
do = "card"
colour = "yellow"
[[events]]
at = 8
do = "marker"
text = "Half of it"
[[events]]
at = 9
do = "fault"
sensor = "beacon_left"
kind = "stuck"
[[events]]
at = 11
do = "controller"
name = "bang_bang"
[[events]]
at = 13
do = "stop"
"""


def run(*arguments: str | Path) -> None:
    """A command of the shell. Raise RuntimeError."""
    if main([str(argument) for argument in arguments]) != 0:
        raise RuntimeError(f"mucat {arguments[0]} has failed")


def hash_tables(data: Path, session: int) -> dict[str, str]:
    """Return the SHA-256 of the exported tables and pictures of a session, by file."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "session.zip"
        run("export", str(session), "--format", "csv", "-o", path, "--data", data)
        with zipfile.ZipFile(path) as archive:
            return {
                name: hashlib.sha256(archive.read(name)).hexdigest()
                for name in archive.namelist()
                if name != "session.json"
            }


def compare(data: Path, session: int) -> dict[str, Any]:
    """Return the figures of a session, and the number of points of each line."""
    query = ComparisonQuery(sessions=[session], signals=SIGNALS, points=20)
    with closing(Reader(DataFolder(data).database)) as store:
        answer = json.loads(Comparer(store).compare(query).model_dump_json())
    (item,) = answer["sessions"]
    return {
        "figures": {name: figure["value"] for name, figure in item["figures"].items()},
        "lines": item["series"],
    }


def pack(data: Path, archive: Path) -> None:
    """Write the content of a data folder to an archive."""
    with tarfile.open(archive, "w:gz") as packed:
        for path in sorted(data.iterdir()):
            if path.name not in LEFT_OUT:
                packed.add(path, path.name)


def record(folder: Path) -> None:
    """Write the archive of a new session, its data folder, and what is read in it, to this folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as name:
        data = Path(name) / "data"
        scenario = Path(name) / "released.toml"
        scenario.write_text(SCENARIO)
        run("scenario", "run", scenario, "--data", data)
        run("export", "1", "--format", "archive", "-o", folder / ARCHIVE, "--data", data)
        pack(data, folder / DATA)
        tables = hash_tables(data, 1)
        expected = {"tables": tables, "comparison": compare(data, 1)}
    (folder / EXPECTED).write_text(json.dumps(expected, indent=1) + "\n")
    (folder / DATA_EXPECTED).write_text(json.dumps(tables, indent=1) + "\n")


if __name__ == "__main__":
    record(RELEASED / VERSION)
