"""Statements of the manual that follow from the code are those of the code."""

import json
import re

import pytest

from robot_runtime.contract.missions import WET_DEPTH
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.link.link_driver import PERIOD
from robot_runtime.missions.leaves.waiting import WET_FOR
from robot_runtime.missions.library import SHIPPED
from tests.documents.blocks import DOCS

ROOT = DOCS.parent


def text_of(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", ["README.md", "docs/run/install.md", "setup.sh"])
def test_the_version_of_node_is_that_of_the_page(page: str) -> None:
    needed = json.loads(text_of("frontend/package.json"))["engines"]["node"].removeprefix(">=")
    assert re.findall(r"Node (\d[\d.]*\d)", text_of(page)) == [needed] * text_of(page).count("Node 2")


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/develop/overview.md"])
def test_every_recipe_is_listed(page: str) -> None:
    there = {file.name for file in (DOCS / "develop").glob("add-a-*.md")}
    assert set(re.findall(r"add-a-[\w-]+\.md", text_of(page))) == there


@pytest.mark.parametrize("page", ["docs/develop/overview.md", "docs/reference/zenoh.md"])
def test_the_rate_of_blocks_is_that_of_the_link(page: str) -> None:
    assert f"{round(1 / PERIOD)} times a second" in text_of(page)


def test_the_dive_without_wifi_names_every_fault_and_the_immersion() -> None:
    text = text_of("docs/use/dive-without-wifi.md")
    assert [name for name in ROBOT_FAULTS if f"`{name}`" not in text] == []
    assert f"{WET_DEPTH * 100:g} cm under water for {WET_FOR:g} s" in text


def test_the_manual_lists_the_shipped_missions() -> None:
    listed = re.findall(r"^\| `(\w+)` \| ", text_of("docs/use/missions.md"), re.MULTILINE)
    assert [name for name in listed if name in SHIPPED] == list(SHIPPED)
