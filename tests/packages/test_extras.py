"""The extras of the packages are the same wherever they are named."""

import re
import tomllib

from packages import constraints, release
from robot_runtime.places import PACKAGES
from server.features.installation.environments import EXTRAS
from tests.documents.blocks import DOCS

DECLARED = tomllib.loads((PACKAGES / "pyproject.toml").read_text())["project"]["optional-dependencies"]
CHOSEN = DECLARED.keys() - {"emulator"}
"""The extras that a person adds; the emulator's wheel is named beside that of mucat."""
LEFT_OUT = {"scene", "lab", "gym"}
"""The extras that no release brings."""


def test_every_extra_is_documented_tested_and_kept_by_an_update() -> None:
    text = (DOCS / "run/packages.md").read_text("utf-8")
    table = text.partition("| extra | for |")[2].partition("\n\n")[0]
    assert set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == CHOSEN
    assert set(constraints.EXTRAS) == CHOSEN
    assert set(release.EXTRAS) == CHOSEN - LEFT_OUT
    assert len(EXTRAS) == len(CHOSEN)
    assert dict(EXTRAS) == {name: DECLARED[name][0].partition("[")[0] for name in CHOSEN}, "by the first one"


def test_every_extra_that_is_named_to_a_person_is_one() -> None:
    pages = [*DOCS.rglob("*.md"), PACKAGES / "README.md"]
    modules = [
        file for room in ("server", "robot_runtime", "mucat") for file in (PACKAGES / room).rglob("*.py")
    ]
    named = {
        extra
        for file in (*pages, *modules)
        for text in re.findall(r"mucat(?:-\S*\.whl)?\)?\"?\[([a-z0-9,]+)\]", file.read_text("utf-8"))
        for extra in text.split(",")
    }
    assert {"pi", "scene"} <= named <= DECLARED.keys()
