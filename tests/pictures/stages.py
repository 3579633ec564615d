"""The stages of the manual's pictures: servers with recordings, with a robot that swims, and a lab."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from server.platform.settings import DataFolder, make_folders
from tests.browser.site import Site
from tests.pages.dive_site import DiveSite
from tests.pages.lab_site import SWIMMING, LabSite, presence
from tests.pictures.manual import Stage
from tests.pictures.recordings import compute_sweep, find_sessions, fit_craft, record_all
from tests.stack import Stack

RECORDED = "recorded"
NAMES = {
    "pool": "Three controllers in the pool",
    "hover": "Hover in a current",
    "figure": "The thesis's Figure 14",
}
"""Words of addresses, and the sessions whose numbers they stand for."""
ROBOTS = {"turtle-1": SWIMMING, "turtle-2": presence(battery=8.1)}


def record_past(scratch: Path) -> None:
    """Fill the folder of recordings in `scratch`."""
    record_all(scratch / RECORDED, scratch / "documents")
    with DiveSite(scratch / RECORDED) as site:
        compute_sweep(site.api)


@contextmanager
def open_stage(stage: Stage, scratch: Path) -> Iterator[Site]:
    """The server of this stage, in a folder of `scratch`, where another one has the recordings."""
    match stage:
        case "desk":
            with DiveSite(scratch / RECORDED) as site:
                fit_craft(site.api)
                yield site
        case "robot":
            with Stack(scratch / "robot") as stack:
                yield stack
        case "lab":
            data = DataFolder(scratch / "lab")
            make_folders(data)
            source, copy = (
                sqlite3.connect(folder.database) for folder in (DataFolder(scratch / RECORDED), data)
            )
            with closing(source), closing(copy):
                source.backup(copy)
            with LabSite(scratch, ROBOTS, ("turtle-3",)) as lab:
                yield lab


def name_numbers(site: Site) -> dict[str, int]:
    """Return the numbers for which words stand in addresses."""
    sessions = find_sessions(site.api)
    numbers = {word: sessions[name][-1] for word, name in NAMES.items() if name in sessions}
    for word, path in (("run", "/comm-tests/runs"), ("sweep", "/sweeps")):
        answer = site.api.get(path)
        if answer.is_success and (documents := answer.json()):
            numbers[word] = documents[0]["id"]
    return numbers
