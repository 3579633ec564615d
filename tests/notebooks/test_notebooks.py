"""Every notebook of the help runs from its first cell to its last, and its page is the present one."""

import re

import pytest

from tests.notebooks.performance import perform
from tests.notebooks.runner import FOLDER, NAMES, RunCell, page_of


@pytest.fixture(scope="module")
def performed() -> dict[str, list[RunCell]]:
    """All of them, after one another on one server."""
    return perform(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs_and_its_page_is_of_it(performed: dict[str, list[RunCell]], name: str) -> None:
    text, figures = page_of(name, performed[name])
    assert all(len(svg) > 1000 for svg in figures.values())
    # Numbers may differ in their last digits on another processor.
    assert _without_outputs(text) == _without_outputs((FOLDER / f"{name}.md").read_text(encoding="utf-8"))


def test_the_figures_that_the_notebooks_show_are_sound(performed: dict[str, list[RunCell]]) -> None:
    texts = {name: "\n".join(cell.text for cell in cells) for name, cells in performed.items()}
    assert _number(texts["dive"], "root mean square of the error, mm") < 90
    # The hull that weighs more is the slower one; the harder gain the quicker one.
    assert _number(texts["crafts"], "heavier by half") > _number(texts["crafts"], "as shipped")
    assert _number(texts["tune"], "hard") < _number(texts["tune"], "soft")


def _without_outputs(page: str) -> str:
    return re.sub(r"```text\n.*?```\n", "", page, flags=re.DOTALL)


def _number(text: str, row: str) -> float:
    """Return the first number after the beginning of a row."""
    match = re.search(rf"{re.escape(row)}\s+([0-9.]+)", text)
    assert match is not None, text
    return float(match[1])
